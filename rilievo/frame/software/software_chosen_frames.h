// How are frames drawn without OpenGL that a chooser of its own chooses?
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/software/software_frames.h"

namespace rilievo {

// Draws what a FrameChooser chooses.
class SoftwareChosenFrames final : public SoftwareFrames {
 public:
  // Makes a chooser for the scene as it is placed at time 0.
  using MakeChooser = std::function<Result<std::unique_ptr<FrameChooser>>(const PlacedScene&)>;
  // As SoftwareFrames. Fails where the chooser cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<SoftwareChosenFrames>> create(
      const Scene& scene, int samples, bool outlines, const MakeChooser& make_chooser,
      const Deformations* deformations = nullptr);

  Result<> draw(const Camera& camera, double time) override;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

  [[nodiscard]] const FrameChooser& chooser() const { return *chooser_; }

 private:
  using SoftwareFrames::SoftwareFrames;
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  [[nodiscard]] bool shows_blended(std::uint32_t object) const override;

  std::unique_ptr<FrameChooser> chooser_;
};

}  // namespace rilievo
