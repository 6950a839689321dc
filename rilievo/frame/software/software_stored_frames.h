// How is a stored representation drawn without OpenGL, and without the scene that it shows?
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// Draws instances of one drawable.
class SoftwareStoredFrames final : public SoftwareFrames {
 public:
  // The sky is that of `sky`, which can be empty and must outlive the source. The drawable's
  // factory, if it has one, is kept with it.
  SoftwareStoredFrames(const Scene& sky, int samples, std::unique_ptr<Drawable> drawable,
                       std::vector<Instance> instances, bool outlines,
                       std::unique_ptr<DrawableFactory> factory = nullptr);

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<DrawableFactory> factory_;
  std::unique_ptr<Drawable> drawable_;
  std::vector<Instance> instances_;
};

// Pictures with depth as nailboards in memory.
struct SoftwarePictures {
  std::unique_ptr<Drawable> set;
  std::vector<Instance> instances;  // one for each picture
};
// Accepts perspective pictures of at most 16383 texels a side; the error names the first other one.
[[nodiscard]] Result<SoftwarePictures> make_software_pictures(std::span<const DepthImage> pictures,
                                                              DepthMode mode, int delta_bits);

}  // namespace rilievo
