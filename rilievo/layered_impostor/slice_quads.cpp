#include "rilievo/layered_impostor/slice_quads.h"

#include <algorithm>
#include <cmath>

#include "rilievo/layered_impostor/slice_rects.h"

namespace rilievo {
namespace {

// What of a rectangle is drawn: half a texel more to each side than there is to see. Two that share
// an edge, but not its ends, would leave cracks; where they overlap they show the same texels.
glm::vec4 quad_of(const TexelRect& rect, const TexelRect& within) {
  return {std::max(float(rect.x0) - 0.5f, float(within.x0)),
          std::max(float(rect.y0) - 0.5f, float(within.y0)),
          std::min(float(rect.x1) + 0.5f, float(within.x1)),
          std::min(float(rect.y1) + 0.5f, float(within.y1))};
}

}  // namespace

SliceScale slice_scale(const LayeredImpostor& impostor, int view) {
  const std::vector<Slice>& slices = impostor.slices[std::size_t(view)];
  if (slices.empty()) return {};
  const float nearest = slices.front().front, farthest = slices.back().back;
  return {nearest, 1.0f / (farthest - nearest)};
}

Image<glm::u16vec2> slice_codes(const LayeredImpostor& impostor, int view) {
  const Image<SurfaceTexel>& texels = impostor.surfaces[std::size_t(view)].texels;
  const SliceScale scale = slice_scale(impostor, view);
  Image<glm::u16vec2> codes(texels.width(), texels.height(), glm::u16vec2(65535, 0));
  for (std::size_t i = 0; i < texels.texels().size(); ++i) {
    if (texels.texels()[i].q == 0) continue;
    const DepthInterval d = sliced_interval(texels.texels()[i], impostor.slicing);
    const auto code = [](float value) { return std::clamp(value, 0.0f, 1.0f) * 65535.0f; };
    codes.texels()[i] = {std::uint16_t(std::floor(code(scale(d.front)))),
                         std::uint16_t(std::ceil(code(scale(d.back))))};
  }
  return codes;
}

int views_at_hand(std::size_t views, int max_views) {
  const int asked = std::clamp(max_views, 1, kMaxViewsAsked);
  return int(std::min(views, std::size_t(asked > 1 ? asked + kSpareViews : 1)));
}

ServingViews views_for_eye(const LayeredImpostor& impostor, const glm::dvec3& eye,
                           const LayeredOptions& options) {
  ServingViews serving;
  const glm::dvec3 towards = eye - glm::dvec3(impostor.bounds.center());
  const int at_hand = views_at_hand(impostor.views.directions.size(), options.max_views);
  serving.count =
      nearest_views(impostor.views, towards, std::span(serving.views).first(std::size_t(at_hand)));
  serving.asked = std::min(serving.count, std::max(options.max_views, 1));
  const std::span<const int> views(serving.views, std::size_t(serving.asked));
  handover_weights(impostor.views, towards, options.handover * mean_spacing(impostor.views), views,
                   serving.weights);
  while (serving.weighted < serving.asked && serving.weights[serving.weighted] > 0)
    ++serving.weighted;
  return serving;
}

SliceChooser::SliceChooser(const LayeredImpostor& impostor) {
  for (std::size_t v = 0; v < impostor.surfaces.size(); ++v)
    rects_.push_back(slice_rects(impostor, int(v)));
}

void SliceChooser::choose(const LayeredImpostor& impostor, const glm::dvec3& eye,
                          const LayeredOptions& options) {
  slices_.clear();
  quads_.clear();
  const ServingViews serving = views_for_eye(impostor, eye, options);
  float from = 0;
  for (int i = 0; i < serving.weighted; ++i) {
    // This view's share of the pixels, and the slices that fill its holes there.
    const float to = i + 1 == serving.weighted ? 1.0f : from + serving.weights[i];
    std::size_t next = slices_.size();
    slices_of_view(impostor, serving.views[i], eye, options.max_views > 1, slices_);
    for (; next < slices_.size(); ++next) {
      const SliceDraw& draw = slices_[next];
      for (const TexelRect& rect : rects_[std::size_t(draw.view)][std::size_t(draw.slice)]) {
        const glm::vec4 texels = quad_of(rect, draw.rect);
        if (texels.x < texels.z && texels.y < texels.w)
          quads_.push_back({draw.view, draw.slice, texels, from, to});
      }
    }
    from = to;
  }
}

}  // namespace rilievo
