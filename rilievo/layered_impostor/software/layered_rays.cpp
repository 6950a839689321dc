#include "rilievo/layered_impostor/software/layered_rays.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

LayeredRays::LayeredRays(LayeredImpostor& impostor)
    : bounds_(impostor.bounds), several_objects_(shown_objects(impostor.pictures).several) {
  pictures_.resize(impostor.pictures.size());
  parallel_for(std::size_t(0), pictures_.size(), [&](std::size_t i) {
    DepthImage& from = impostor.pictures[i];
    Picture& picture = pictures_[i];
    picture.camera = from.camera;
    picture.complete = impostor.complete[i], picture.sees_through = impostor.sees_through[i];
    picture.color = encoded_colors(from.color);
    if (several_objects_) picture.object = std::move(from.object);
    picture.surface = make_march_surface(impostor.surfaces[i]);
    from.color = {}, from.depth = {}, from.object = {};
    impostor.surfaces[i].texels = {};
  });
}

std::size_t LayeredRays::bytes() const {
  std::size_t bytes = 0;
  for (const Picture& picture : pictures_)
    bytes += picture.color.texels().size() * kColorBytes + picture.surface.bytes() +
             4 * picture.object.texels().size();
  return bytes;
}

SeenLayered LayeredRays::seen_at(const PlacedLayered& placed, const MarchedView& view,
                                 const MarchRays& rays, std::size_t ray,
                                 const glm::dvec3& along) const {
  const Picture& picture = pictures_[view.view];
  glm::vec3 hit;  // u, v, q
  for (int k = 0; k < 3; ++k)
    hit[k] = rays.from[k][ray] + rays.t[ray] * (rays.to[k][ray] - rays.from[k][ray]);
  const glm::dvec3 from_eye = glm::dvec3(hit.x, hit.y, 1) / double(hit.z) - view.eye;
  const double t = glm::dot(from_eye, along) / glm::dot(along, along);
  SeenLayered seen;
  seen.inverse_z = float(1 / (t * placed.scale));
  const glm::ivec2 texel(rays.x[ray], rays.y[ray]);
  seen.object = several_objects_ ? picture.object(texel.x, texel.y) : placed.object;

  // Between the texels that are linked to the one that was hit.
  const std::size_t i =
      std::size_t(texel.y) * std::size_t(picture.surface.width) + std::size_t(texel.x);
  const SampleWeights weights =
      sample_weights({.links = std::uint8_t(picture.surface.texels[i].links)},
                     glm::dvec2(hit) - (glm::dvec2(texel) + 0.5));
  seen.color =
      interpolate(weights, texel,
                  [&](const glm::ivec2& at) { return glm::vec4(picture.color(at.x, at.y)); }) /
      255.0f;
  return seen;
}

// What a pixel shows, as view after view is marched through.
struct LayeredRays::Look {
  PixelRay ray;
  SeenLayered certain, doubtful, skin;
  int inside = 0;
  bool sees_through = false;
  float surface = 0, nothing = 0, heaviest = 0;
  glm::vec4 blended{0.0f};
  std::array<std::uint8_t, ServingViews::kMaxCount> order;  // of placed views

  // Nothing, whatever the views show that are left, of this weight.
  [[nodiscard]] bool is_empty(float rest) const { return nothing > surface + rest; }
  [[nodiscard]] SeenLayered shown(bool several_views) const {
    if (is_empty(0) || (surface == 0 && sees_through)) return {};
    if (surface == 0)
      return doubtful.inverse_z == kSeesNothing && inside > 0 && several_views ? skin : doubtful;
    SeenLayered out = certain;
    out.color = blended / (surface + nothing);
    return out;
  }
};

// Of the views without weight, those first that look along the ray.
void LayeredRays::find_order(const PlacedLayered& placed, Look& look) const {
  std::array<double, ServingViews::kMaxCount> along;
  for (int k = placed.weighted; k < placed.count; ++k) {
    const std::size_t view = placed.views[std::size_t(k)].view;
    const double of_view = looks_along(pictures_[view].camera, look.ray);
    int to = k;
    for (; to > placed.weighted && along[std::size_t(to - 1)] < of_view; --to)
      along[std::size_t(to)] = along[std::size_t(to - 1)],
      look.order[std::size_t(to)] = look.order[std::size_t(to - 1)];
    along[std::size_t(to)] = of_view, look.order[std::size_t(to)] = std::uint8_t(k);
  }
}

// The rules are those of warp_surfaces().
void LayeredRays::look(const PlacedLayered& placed, const std::array<Gaze, kCount>& gazes,
                       std::uint32_t wanted, SeenLayered (&shown)[kCount],
                       bool first_decides) const {
  std::array<Look, kCount> looks;
  const auto raster = [&](std::size_t i) { return glm::dvec3(gazes[i].at, 1); };
  const auto for_bits = [](std::uint32_t bits, const auto& visit) {
    for (; bits; bits &= bits - 1) visit(std::size_t(std::countr_zero(bits)));
  };
  std::uint32_t looking = wanted;
  for_bits(wanted, [&](std::size_t i) {
    looks[i].ray = {placed.camera.position(), placed.ray_from_raster * raster(i),
                    std::max(placed.camera.z_near, gazes[i].begin),
                    std::min(placed.camera.z_far, gazes[i].end)};
    if (!bounds_.keep(looks[i].ray)) looking &= ~(1u << i);
  });
  const std::uint32_t in_bounds = looking;
  MarchRays rays;
  std::array<glm::dvec3, kCount> along;
  // Those rays whose bit is set look the view up.
  const auto ask = [&](const MarchedView& view, std::uint32_t asking) {
    const Picture& picture = pictures_[view.view];
    rays.wanted = 0;
    for_bits(asking, [&](std::size_t i) {
      along[i] = view.per_raster * raster(i);
      const std::optional<DisparitySegment> segment =
          disparity_segment_between(picture.camera, view.eye + looks[i].ray.begin * along[i],
                                    view.eye + looks[i].ray.end * along[i]);
      if (!segment) return;
      rays.wanted |= 1u << i;
      for (int a = 0; a < 3; ++a)
        rays.from[a][i] = float(segment->from[a]), rays.to[a][i] = float(segment->to[a]);
    });
    march_rays(picture.surface, rays);
    const float weight = view.weight > 0 ? view.weight : 1.0f;
    for_bits(asking, [&](std::size_t i) {
      Look& look = looks[i];
      const bool behind = rays.passed_behind >> i & 1;
      if (rays.hit >> i & 1) {
        const SeenLayered seen = seen_at(placed, view, rays, i, along[i]);
        if (seen.inverse_z > look.doubtful.inverse_z) look.doubtful = seen;
        if (behind) return;
        look.surface += weight;
        look.blended += weight * seen.color;
        if (weight > look.heaviest) look.heaviest = weight, look.certain = seen;
      } else if (!behind) {
        if (picture.complete) look.nothing += weight;
        look.sees_through |= picture.sees_through;
        if (look.is_empty(view.rest)) looking &= ~(1u << i);
      } else {
        const bool outline = rays.passed_outline >> i & 1;
        look.inside += outline ? -1 : 1;
        if (!outline && look.skin.inverse_z == kSeesNothing)
          look.skin = seen_at(placed, view, rays, i, along[i]);
      }
    });
  };
  const auto leave_decided = [&] {
    for_bits(looking, [&](std::size_t i) {
      if (looks[i].surface + looks[i].nothing > 0) looking &= ~(1u << i);
    });
  };
  for (int k = 0; k < placed.weighted && looking; ++k) {
    if (first_decides) leave_decided();
    ask(placed.views[std::size_t(k)], looking);
  }
  leave_decided();
  if (looking && placed.weighted < placed.asked)
    for_bits(looking, [&](std::size_t i) { find_order(placed, looks[i]); });
  for (int k = placed.weighted; k < placed.asked && looking; ++k) {
    // Rays whose turn has come to the same view march together.
    for (std::uint32_t rest = looking; rest;) {
      const std::uint8_t turn = looks[std::size_t(std::countr_zero(rest))].order[std::size_t(k)];
      std::uint32_t asking = 0;
      for_bits(rest, [&](std::size_t i) {
        if (looks[i].order[std::size_t(k)] == turn) asking |= 1u << i;
      });
      ask(placed.views[turn], asking);
      rest &= ~asking;
    }
    leave_decided();
  }
  for_bits(wanted, [&](std::size_t i) {
    shown[i] = in_bounds >> i & 1 ? looks[i].shown(placed.count > 1) : SeenLayered{};
  });
}

}  // namespace rilievo
