// Decides what each object of a frame is drawn from; a backend's frames draw it.
//
// frame/gl/opengl_frames.h draws what is chosen with OpenGL, frame/software/software_frames.h
// without: they own the order of a frame, and a chooser knows neither. Each file of method/ has
// one; the cache (cache/scene_cache.h) is one, too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_content.h"
#include "rilievo/render/object_work.h"
#include "rilievo/render/placed_scene.h"

namespace rilievo {

// The work of drawing a frame, counted.
struct FrameWork {
  std::span<const ObjectWork> polygons;  // of the objects drawn as polygons
};

// Chooses the frames of one scene.
class FrameChooser {
 public:
  virtual ~FrameChooser() = default;

  // Appends the sets of what it draws from to an empty `content`; called once, before choose().
  virtual void add_sets(FrameContent& content) = 0;
  // Fills `content`, which is cleared, and in `stats` the captures, memory and bounds. `placed` is
  // at the frame's time, and the same in all frames. May change OpenGL's bound framebuffer,
  // viewport and scissor test.
  virtual Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                          FrameStats& stats) = 0;
  // Called when the frame that was chosen last has been drawn, or has failed. Null: it has failed,
  // or the backend does not count (OpenGL). Adds to `stats` what only drawing tells.
  virtual void drawn(const FrameWork* /*work*/, FrameStats& /*stats*/) {}
  // Called before the identifiers of the last frame are drawn: captures those that are missing.
  virtual void prepare_objects() {}
  // The pictures of the frame that was chosen last, as FrameSource::read_pictures().
  [[nodiscard]] virtual std::vector<DepthImage> read_pictures(
      const FrameContent& /*content*/) const {
    return {};
  }
  // Returns whether the pictures of the object in this frame show its blended parts, too. Otherwise
  // these are drawn as polygons.
  [[nodiscard]] virtual bool shows_blended(std::uint32_t /*object*/) const { return false; }
};

}  // namespace rilievo
