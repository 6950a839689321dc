// Which quads are drawn of an impostor's slices for an eye, and which texels does each show? (S2.3)
//
// The same for every drawer of slices. The views that serve the eye share the pixels by cross-fade
// ranges; each comes with the slices of its neighbours that fill its holes. A texel has the
// interval of the depths at which slices show it, in 16 bits a side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {

// The scale of a view's codes: eye_z to [0, 1] within the view's slices.
struct SliceScale {
  float nearest = 0, per_metre = 0;
  [[nodiscard]] float operator()(float eye_z) const { return (eye_z - nearest) * per_metre; }
};
[[nodiscard]] SliceScale slice_scale(const LayeredImpostor& impostor, int view);

// A step of the codes, of the range of a view's slices: a texel can be on slices that are so much
// beside its interval.
inline constexpr double kIntervalStep = 1.0 / 65535;

// The interval of each texel of a view, scaled by slice_scale() * 65535 and rounded outwards; first
// > second: the texel shows nothing. Requires the texels of its surface.
[[nodiscard]] Image<glm::u16vec2> slice_codes(const LayeredImpostor& impostor, int view);

// A rectangle of a slice in the picture.
struct SliceQuad {
  int view = 0, slice = 0;
  glm::vec4 texels{0.0f};  // x0, y0, x1, y1
  float from = 0, to = 1;  // of the cross-fade range
};

// The views that serve an eye. A pixel of the surfaces looks up those with weight, and of the
// others those that look along its own ray (looks_along()), `asked` in all.
struct ServingViews {
  static constexpr std::size_t kMaxCount = kMaxViewsAsked + kSpareViews;
  int views[kMaxCount] = {};      // nearest first
  float weights[kMaxCount] = {};  // those of views without weight follow, 0
  int count = 0, weighted = 0;    // all of them, and those with weight
  int asked = 0;
};
[[nodiscard]] ServingViews views_for_eye(const LayeredImpostor& impostor, const glm::dvec3& eye,
                                         const LayeredOptions& options);

// Chooses the quads for an eye. Kept, it does not allocate.
class SliceChooser {
 public:
  // Requires the texels of the impostor's surfaces.
  explicit SliceChooser(const LayeredImpostor& impostor);

  // `eye` in the space of the impostor, whose texels are not needed any more.
  void choose(const LayeredImpostor& impostor, const glm::dvec3& eye,
              const LayeredOptions& options);
  // Those of a view follow each other, in the order of slices_of_view().
  [[nodiscard]] std::span<const SliceQuad> quads() const { return quads_; }
  [[nodiscard]] std::size_t slices() const { return slices_.size(); }

 private:
  std::vector<std::vector<std::vector<TexelRect>>> rects_;  // by view and slice
  std::vector<SliceDraw> slices_;
  std::vector<SliceQuad> quads_;
};

}  // namespace rilievo
