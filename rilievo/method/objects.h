// Frames from representations that were baked once, one for each heavy object.
//
// Objects can share one (representation/bake_objects.h). Drawn as polygons: light objects,
// objects beyond the memory limit, blended parts, objects that deform as they move, and objects too
// near to the eye.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/representation/bake_objects.h"

namespace rilievo {

// The objects to bake, and when to draw them so.
struct ObjectFramesOptions {
  ObjectDrawablesOptions objects;
  double max_texel_px = 4;  // objects with larger texels on the screen are drawn as polygons
  bool outlines = false;
};

// Chooses frames of baked objects.
class ObjectChooser final : public FrameChooser {
 public:
  // Bakes the scene as it is placed; `source` shows the same. Fails where a bake fails.
  [[nodiscard]] static Result<std::unique_ptr<ObjectChooser>> create(
      const PlacedScene& placed, CaptureSource& source, const Kind& kind,
      std::unique_ptr<DrawableFactory> factory, const ObjectFramesOptions& options);

  void add_sets(FrameContent& content) override;
  // The first frame counts the time of the bake as its own.
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;

 private:
  ObjectChooser() = default;
  [[nodiscard]] std::optional<Instance> instance_of(std::uint32_t object, const Camera& camera,
                                                    const PlacedScene& placed) const;

  struct Baked {
    ObjectDrawable object;
    ErrorModel error;
  };
  std::unique_ptr<DrawableFactory> factory_;
  std::vector<Baked> baked_;
  std::vector<int> baked_of_;  // by object; -1: none
  std::vector<std::uint32_t> visible_;
  double max_texel_px_ = 4;
  bool outlines_ = false;
  std::size_t bytes_ = 0;
  int captures_ = 0;       // not reported yet ...
  double capture_ms_ = 0;  // ... nor how long they took
};

}  // namespace rilievo
