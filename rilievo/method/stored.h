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

// Chooses all instances of some drawables.
class StoredChooser final : public FrameChooser {
 public:
  // `factory`, if the drawable has one, is kept with it.
  StoredChooser(PictureSet content, const StoredOptions& options,
                std::unique_ptr<DrawableFactory> factory = nullptr)
      : options_(options) {
    add(std::move(content), std::move(factory));
  }

  // Draws this as well, with one z-buffer for all. Before frames are made of the chooser.
  void add(PictureSet content, std::unique_ptr<DrawableFactory> factory) {
    std::vector<ErrorModel> errors;
    for (const Instance& instance : content.instances)
      errors.push_back(content.drawable->error_model(instance.item));
    stored_.push_back({std::move(factory), std::move(content), std::move(errors)});
  }

  void add_sets(FrameContent& content) override {
    for (const Stored& stored : stored_) content.sets.push_back({stored.set.drawable.get(), {}});
  }
  Result<> choose(const Camera& camera, const PlacedScene&, FrameContent& content,
                  FrameStats& stats) override {
    camera_ = camera;
    content.outlines = options_.outlines;
    content.sky = options_.sky;
    stats.picture_bytes = 0;
    for (std::size_t i = 0; i < stored_.size(); ++i) {
      content.sets[i].instances = stored_[i].set.instances;
      stats.picture_bytes += stored_[i].set.drawable->bytes();
    }
    return Done{};
  }
  // Bounds come after drawing: environment nodes have loaded what their bound needs.
  void drawn(const FrameWork*, FrameStats& stats) override {
    stats.bound_px = 0;
    for (const Stored& stored : stored_)
      for (std::size_t i = 0; i < stored.errors.size(); ++i)
        widen_bounds(stored.errors[i], stored.set.instances[i], camera_, stats);
  }

 private:
  struct Stored {
    std::unique_ptr<DrawableFactory> factory;  // outlives the drawable
    PictureSet set;
    std::vector<ErrorModel> errors;  // of the instances
  };
  std::vector<Stored> stored_;
  StoredOptions options_;
  Camera camera_;  // of the last frame
};

}  // namespace rilievo
