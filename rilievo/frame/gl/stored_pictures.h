// Draws pictures with depth that were captured earlier, or elsewhere, without the scene they show.
#pragma once

#include <span>
#include <vector>

#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/nailboard/gl/picture_atlas.h"

namespace rilievo {

struct StoredPicturesOptions {
  DepthMode mode = DepthMode::exact;
  int delta_bits = 8;
  bool outlines = false;
};

class StoredPictures : public FrameSource {
 public:
  // Takes perspective pictures of at most 1024 texels a side; the error names the one that is not.
  [[nodiscard]] static Result<StoredPictures> create(std::span<const DepthImage> pictures,
                                                     const StoredPicturesOptions& options = {});

  // No sky: what the pictures leave open stays as it is. `time` changes nothing.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] FrameFigures figures() const override;

 private:
  StoredPictures(PictureAtlas atlas, NailboardDrawer drawer)
      : atlas_(std::move(atlas)), drawer_(std::move(drawer)) {}

  StoredPicturesOptions options_;
  PictureAtlas atlas_;
  NailboardDrawer drawer_;
  std::vector<NailboardInstance> instances_;
  Camera camera_;
};

}  // namespace rilievo
