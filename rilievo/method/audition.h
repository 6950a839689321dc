// How good is a method's frame, before anyone sees it?
//
// It is compared with rays, and so is what is shown meanwhile: pictures of the cache, as a rule.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/keyframes/software/sampled_loss.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo {

// How much less like the truth frames are than direct drawing, as rays measure it.
class FrameLoss {
 public:
  explicit FrameLoss(RayScene rays) : own_(std::move(rays)), rays_(&*own_), loss_(*rays_) {}
  // `rays` must outlive the object.
  explicit FrameLoss(const RayScene* rays) : rays_(rays), loss_(*rays_) {}
  FrameLoss(const FrameLoss&) = delete;
  FrameLoss& operator=(const FrameLoss&) = delete;

  // Looks at some pixels of a frame of `objects`, `times` as many as SampledLoss does.
  void add(const Camera& camera, std::span<const std::uint32_t> objects, const Rgba8Image& color,
           int times);
  void forget() { loss_.forget(); }
  // dB; none: too little was seen.
  [[nodiscard]] std::optional<double> db() const;
  [[nodiscard]] const RayScene& rays() const { return *rays_; }

 private:
  std::optional<RayScene> own_;
  const RayScene* rays_;
  SampledLoss loss_;
};

// A frame that was shown.
struct ShownFrame {
  Rgba8Image color;
  Camera camera, before;  // before: of the frame before
  double time = 0;
  std::vector<std::uint32_t> in_view;  // objects
  bool by_cache = false;
};

// Leaves out what moves: rays have it where it began. The pixels in which it may be seen count as
// direct drawing's of what is left. `placed`, of the scene of the rays, is of the frame's moment.
void leave_out_moving(const PlacedScene& placed, ShownFrame& shown);

// What was found.
struct Audition {
  std::optional<double> loss_db, cache_loss_db;  // none: not known
  double processor_ms = 0;                       // of a frame, on this thread alone; 0: not known
};

// So many times the pixels of SampledLoss are looked at in one frame; and so many times as many, at
// most, where these show too little but the sky. A few hundred pixels hold most of the error: of
// half as many the loss goes to and fro by half a dB.
inline constexpr int kAuditionLosses = 32, kMostAuditions = 2;

// The loss of a frame that is shown, in these colours, and of no other. None: it shows too little.
[[nodiscard]] std::optional<double> audition_loss(const ShownFrame& shown, const Rgba8Image& color,
                                                  FrameLoss& loss);

// Draws the frame before the one that is shown, so that the one that is timed is not the first to
// touch the memory. Were it the same one, keyframes would take the eye to stand. Fails as draw()
// does.
[[nodiscard]] Result<> begin_audition(const ShownFrame& shown, FrameSource& frames);
// Draws the frame that is shown, on this thread alone, and says what that takes. Fails as draw()
// does.
[[nodiscard]] Result<double> time_audition(const ShownFrame& shown, FrameSource& frames);

// What drawing that frame by rays takes, as a sixteenth of its pixels says.
[[nodiscard]] Audition audition_rays(const ShownFrame& shown, int samples, RayVisibility& rays);

// The loss of what the cache shows, and nothing left of it in `loss`. None: it shows something
// else.
[[nodiscard]] std::optional<double> cache_loss(const ShownFrame& shown, FrameLoss* loss);

}  // namespace rilievo
