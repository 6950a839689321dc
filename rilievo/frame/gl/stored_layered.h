// Draws a layered impostor that was baked earlier, or elsewhere, without the scene it shows.
#pragma once

#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"

namespace rilievo {

class StoredLayered : public FrameSource {
 public:
  [[nodiscard]] static Result<StoredLayered> create(LayeredImpostor impostor,
                                                    const LayeredOptions& options = {});

  // No sky: what the impostor leaves open stays as it is. `time` changes nothing.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] FrameFigures figures() const override;

 private:
  StoredLayered(LayeredPictures pictures, LayeredDrawer drawer)
      : pictures_(std::move(pictures)), drawer_(std::move(drawer)) {}

  LayeredOptions options_;
  LayeredPictures pictures_;
  LayeredDrawer drawer_;
  LayeredInstance instance_;
  Camera camera_;
};

}  // namespace rilievo
