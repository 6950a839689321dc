// A stored representation, drawn without the scene that it shows.
#pragma once

#include <memory>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/kind/kind.h"
#include "rilievo/nailboard/picture_set.h"

namespace rilievo {

// How stored content is drawn.
struct StoredOptions {
  bool outlines = false;
  bool sky = true;  // draw the sky of the backend's scene, which can be empty
};

// Chooses instances of one drawable.
class StoredChooser final : public FrameChooser {
 public:
  // `factory`, if the drawable has one, is kept with it.
  StoredChooser(PictureSet content, const StoredOptions& options,
                std::unique_ptr<DrawableFactory> factory = nullptr)
      : factory_(std::move(factory)), stored_(std::move(content)), options_(options) {}

  void add_sets(FrameContent& content) override {
    content.sets.push_back({stored_.drawable.get(), {}});
  }
  Result<> choose(const Camera&, const PlacedScene&, FrameContent& content,
                  FrameStats& stats) override {
    content.outlines = options_.outlines;
    content.sky = options_.sky;
    content.sets[0].instances = stored_.instances;
    stats.picture_bytes = stored_.drawable->bytes();
    return Done{};
  }

 private:
  std::unique_ptr<DrawableFactory> factory_;
  PictureSet stored_;
  StoredOptions options_;
};

}  // namespace rilievo
