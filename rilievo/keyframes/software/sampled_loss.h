// How much farther from the truth are frames than direct drawing, as some of their pixels tell?
//
// Of a few pixels of a frame rays find 16 samples, which stand for the truth, and the 4 samples
// that direct drawing takes. With the squared differences of a frame's bytes and of direct
// drawing's
//
//   loss = 10 log10( sum (shown - true)^2 / max(sum (direct - true)^2, 3 n) )   dB
//
// which is PSNR of direct drawing less that of the frames; direct drawing's counts as 48.1 dB at
// most, a mean difference of one step of a byte, which is not seen. Holes are filled as direct
// drawing would; samples that show nothing show the sky. Most of the pixels are of the rectangle
// that the objects are seen in, since the others are right, and most of these are of edges, where
// frames are off: one is as likely to be looked at as its neighbours differ, and counts by the area
// that it stands for. So the loss of one frame is off by half as much as with any pixels (along
// three walks 0.3 to 0.7 dB after 16 looks; a standard deviation). Frames are forgotten after some
// others.
// The same pixels of the same frames in every run.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/box_view.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"
#include "rilievo/render/rays/cast_pixels.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The loss of the last frames.
class SampledLoss {
 public:
  // Pixels of a frame; and those after which the loss is known.
  static constexpr int kPixels = 192, kEnough = 900;
  // ... and how many of these must show surfaces.
  static constexpr int kEnoughSurfaces = 200;
  // Of the sums, when a frame is added: a third is left after ten. More where little is surfaces.
  static constexpr double kRemembered = 0.9;
  // A mean difference of one step of each of three bytes, squared: it is not seen.
  static constexpr double kUnseen = 3;

  // `rays`, of the scene, must outlive the object.
  explicit SampledLoss(const RayScene& rays);

  // A frame was warped, of `objects` and nothing else: looks at kPixels of it, so many times.
  // `shown`: its colours by rows, as WarpedFrame's; what is covered, and plain sky, counts as
  // direct drawing. `remembered`: the share of the sums that is kept, at most.
  void add(const Camera& camera, std::span<const std::uint32_t> objects,
           std::span<const std::uint32_t> shown, int looks = 1, double remembered = kRemembered);
  void forget() { shown_ = direct_ = counted_ = surfaces_ = 0; }

  [[nodiscard]] bool known() const { return counted_ >= kEnough && surfaces_ >= kEnoughSurfaces; }
  // dB; negative: they are nearer than direct drawing, or than what is seen.
  [[nodiscard]] double loss_db() const { return loss_db(shown_, direct_, counted_); }
  // The same of `counted` pixels, from the sums of squares by which what is shown and direct
  // drawing are off the truth, over three bytes.
  [[nodiscard]] static double loss_db(double shown, double direct, double counted);

 private:
  struct Chosen {
    FramePixel pixel;
    double weight = 0, likely = 0;  // what it stands for; how much it is likely to be off
  };

  void keep(double remembered, int looks);
  void look(const Camera& camera, std::span<const std::uint32_t> objects, const RasterRect& rect,
            std::span<const std::uint32_t> shown);
  // The pixels that objects may be seen in, and some around them.
  [[nodiscard]] RasterRect find_rect(const Camera& camera,
                                     std::span<const std::uint32_t> objects) const;
  void choose_pixels(const Camera& camera, const RasterRect& rect,
                     std::span<const std::uint32_t> shown);
  void cast(const Camera& camera, std::span<const FramePixel> pixels,
            std::span<const std::uint32_t> objects, std::vector<glm::ivec4>& sums);

  Sky sky_;
  std::vector<Box> bounds_;  // by object
  PixelCaster caster_;
  SeenTriangles seen_;
  std::uint32_t random_ = 1;
  double shown_ = 0, direct_ = 0, counted_ = 0, surfaces_ = 0;
  std::vector<Chosen> candidates_, chosen_;
  std::vector<FramePixel> pixels_, parts_;
  std::vector<double> weights_;  // of pixels_: what they stand for, in means of all
  std::vector<glm::ivec4> direct_sums_, true_sums_;  // of bytes; the number of samples
};

}  // namespace rilievo
