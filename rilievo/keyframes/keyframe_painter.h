// Who warps keyframes, and draws the frame: processors, or OpenGL.
//
// KeyframeFrames decides which keyframes a frame is warped from, which objects are drawn as
// polygons, and which pixels rays fill. A painter does the work on pixels, in this order:
//
//   begin() -> place() -> warp() -> draw() -> draw_objects()
//
// software/software_painter.h draws into memory, gl/opengl_painter.h into the bound framebuffer.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/render/placed_scene.h"

namespace rilievo {

class KeyframeTiles;
class SkyTiles;
class SoftwareTarget;

// What is drawn beside the polygons that were placed.
struct KeyframeContent {
  // What was warped, and what rays found in its holes: KeyframeTiles::place() was called. Null:
  // the frame is polygons.
  KeyframeTiles* warped = nullptr;
  const SkyTiles* sky = nullptr;                // the scene's, placed
  std::span<const std::uint32_t> blended = {};  // objects with blended parts
};

// Draws frames of one scene. Spans that it gets must live until the frame is drawn.
class KeyframePainter {
 public:
  virtual ~KeyframePainter() = default;

  // Begins a frame. `placed` is at `time` (seconds).
  virtual void begin(const Camera& camera, const PlacedScene& placed, double time) = 0;
  // These objects are drawn as polygons, and no others: their opaque and masked parts.
  virtual Result<> place(std::span<const std::uint32_t> polygons) = 0;
  // As warp_keyframes(), without what the polygons cover. `nearest`: 1 / eye_z of the nearest thing
  // that is not polygons.
  virtual Result<> warp(std::span<const WarpedKeyframe> keyframes, float nearest, bool leaves_sky,
                        WarpedFrame& out) = 0;
  // Draws the frame.
  virtual Result<> draw(const KeyframeContent& content) = 0;
  // Draws its identifiers, into a ProbeTarget if it draws with OpenGL. Of what was warped
  // KeyframeTiles::place_objects() was called; null: all is polygons.
  virtual Result<> draw_objects(KeyframeTiles* warped) = 0;

  // Waits until the frame is drawn, so that its time can be taken.
  virtual void finish() {}
  // Do polygons take about what the rasteriser takes as a source of keyframes?
  [[nodiscard]] virtual bool draws_as_source() const { return true; }
  // Allocates what frames with polygons need, for a frame that was begun. `polygons`: any object.
  virtual void take_memory(std::span<const std::uint32_t> polygons) = 0;
  // The share of the last frame's pixels that show polygons in front of what was warped.
  [[nodiscard]] virtual double polygon_share(const WarpedFrame& warped) const = 0;
  // The target of those that draw into memory; null: the bound framebuffer.
  [[nodiscard]] virtual const SoftwareTarget* target() const { return nullptr; }
};

}  // namespace rilievo
