// Who captures a scene's pictures for an atlas of nailboards?
//
// Either OpenGL, into the atlas's own textures, so that pictures never leave the GPU; or, where
// OpenGL runs on the CPU, the library's own rasteriser, which hands its pictures to the atlas.
// Needs a current OpenGL context.
#pragma once

#include <memory>
#include <span>

#include "rilievo/capture/capture_by.h"
#include "rilievo/capture/placed_raster.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/nailboard/gl/nailboard_set.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Will the rasteriser capture?
[[nodiscard]] bool rasterizes(CaptureBy by, int samples);

// A set of nailboards, and what captures them.
class NailboardCapture {
 public:
  // Allocates the atlas, whose capture_bytes are decided here. `renderer` must outlive the object.
  // Fails if the driver cannot, or the budget does not suffice.
  [[nodiscard]] static Result<NailboardCapture> create(SceneRenderer& renderer, CaptureBy by,
                                                       AtlasOptions options, DepthMode mode);

  [[nodiscard]] NailboardSet& set() { return *set_; }
  [[nodiscard]] const NailboardSet& set() const { return *set_; }
  [[nodiscard]] NailboardAtlas& atlas() { return set_->atlas(); }
  // What captures; null: OpenGL does.
  [[nodiscard]] PlacedRaster* rasterizer() { return rasterizer_.get(); }

  // Captures `objects` (opaque parts) as the renderer has placed them into the slot, whose size is
  // the camera's. Changes the bound framebuffer and viewport.
  void capture(const Camera& camera, std::span<const std::uint32_t> objects, const AtlasSlot& slot);
  // The gap table of the picture that was captured last, of these objects. Changes the bound
  // framebuffer and viewport.
  [[nodiscard]] GapTable gaps(const Camera& camera, std::span<const std::uint32_t> objects);

 private:
  NailboardCapture(SceneRenderer& renderer, int samples, std::unique_ptr<PlacedRaster> rasterizer,
                   std::unique_ptr<NailboardSet> set)
      : renderer_(&renderer),
        samples_(samples),
        rasterizer_(std::move(rasterizer)),
        set_(std::move(set)) {}

  SceneRenderer* renderer_;
  int samples_;
  std::unique_ptr<PlacedRaster> rasterizer_;  // null: OpenGL captures
  std::unique_ptr<NailboardSet> set_;
};

}  // namespace rilievo
