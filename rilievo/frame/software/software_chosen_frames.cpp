#include "rilievo/frame/software/software_chosen_frames.h"

#include <utility>

namespace rilievo {

Result<std::unique_ptr<SoftwareChosenFrames>> SoftwareChosenFrames::create(
    const Scene& scene, int samples, bool outlines, const MakeChooser& make_chooser,
    const Deformations* deformations) {
  std::unique_ptr<SoftwareChosenFrames> frames(
      new SoftwareChosenFrames(scene, samples, deformations));
  Result<std::unique_ptr<FrameChooser>> chooser = make_chooser(frames->placed());
  if (!chooser) return chooser.error();
  frames->chooser_ = std::move(*chooser);
  frames->chooser_->add_sets(frames->content());
  frames->outlines_ = outlines;
  return {std::move(frames)};
}

Result<> SoftwareChosenFrames::draw(const Camera& camera, double time) {
  Result<> done = SoftwareFrames::draw(camera, time);
  chooser_->drawn();
  return done;
}

Result<> SoftwareChosenFrames::choose(const Camera& camera, FrameContent& content,
                                      FrameStats& stats) {
  return chooser_->choose(camera, placed(), content, stats);
}

std::vector<DepthImage> SoftwareChosenFrames::read_pictures() const {
  return chooser_->read_pictures(content());
}

bool SoftwareChosenFrames::shows_blended(std::uint32_t object) const {
  return chooser_->shows_blended(object);
}

}  // namespace rilievo
