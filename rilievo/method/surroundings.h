// Frames from a baked representation of what stands still, seen from within.
//
// Moving objects are drawn as polygons into the same z-buffer.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/frame/frame_chooser.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// The surroundings to bake.
struct SurroundingFramesOptions {
  OptionValues bake, draw;               // of the kind
  Box eyes = {};                         // the region of the eyes; empty: unknown
  std::vector<glm::vec3> eye_path = {};  // as BakeInput has it
  bool outlines = false;
  Progress progress;
  std::function<void(const std::string&)> note = {};  // a line for each fact of the bake
};

// Chooses frames of baked surroundings.
class SurroundingChooser final : public FrameChooser {
 public:
  // Bakes the scene as it is placed; `source` shows the same. Requires a kind that stands for
  // surroundings. Fails where a bake fails.
  [[nodiscard]] static Result<std::unique_ptr<SurroundingChooser>> create(
      const PlacedScene& placed, CaptureSource& source, const Kind& kind,
      std::unique_ptr<DrawableFactory> factory, const SurroundingFramesOptions& options);

  void add_sets(FrameContent& content) override;
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;
  // Bounds come after drawing, which has loaded what they need.
  void drawn(const FrameWork* work, FrameStats& stats) override;

 private:
  SurroundingChooser() = default;

  std::unique_ptr<DrawableFactory> factory_;
  std::unique_ptr<Drawable> drawable_;
  std::vector<bool> baked_;  // by object
  std::vector<std::uint32_t> visible_;
  ErrorModel error_;
  Camera camera_;  // of the last frame
  bool outlines_ = false;
  int captures_ = 0;  // since the last frame
  double capture_ms_ = 0;
};

}  // namespace rilievo
