// How is a stored representation drawn without the scene that it shows?
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/kind/kind.h"
#include "rilievo/nailboard/gl/nailboard_set.h"

namespace rilievo {

// Draws instances of one drawable.
class StoredFrames final : public SceneFrames {
 public:
  // The sky is that of `renderer`'s scene, which can be empty. The renderer, and the drawable's
  // factory if it has one, must outlive the source.
  StoredFrames(SceneRenderer& renderer, std::unique_ptr<Drawable> drawable,
               std::vector<Instance> instances, bool outlines, bool sky = true);

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<Drawable> drawable_;
  std::vector<Instance> instances_;
};

// Pictures with depth as nailboards.
struct StoredPictures {
  std::unique_ptr<NailboardSet> set;
  std::vector<Instance> instances;  // one for each picture
};
// Accepts perspective pictures of at most 1024 texels a side; the error names the first other one.
[[nodiscard]] Result<StoredPictures> make_stored_pictures(std::span<const DepthImage> pictures,
                                                          DepthMode mode = DepthMode::exact,
                                                          int delta_bits = 8);

}  // namespace rilievo
