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

// Where a ray is at `t` of its segment: eye_z, as `along` is long.
double LayeredRays::eye_z_at(const MarchedView& view, const MarchRays& rays, std::size_t ray,
                             const glm::dvec3& along, float t) {
  glm::vec3 at;  // u, v, q
  for (int k = 0; k < 3; ++k) at[k] = rays.from[k][ray] + t * (rays.to[k][ray] - rays.from[k][ray]);
  const glm::dvec3 from_eye = glm::dvec3(at.x, at.y, 1) / double(at.z) - view.eye;
  return glm::dot(from_eye, along) / glm::dot(along, along);
}

SeenLayered LayeredRays::seen_at(const PlacedLayered& placed, const MarchedView& view,
                                 const MarchRays& rays, std::size_t ray,
                                 const glm::dvec3& along) const {
  const Picture& picture = pictures_[view.view];
  SeenLayered seen;
  seen.inverse_z = float(1 / (eye_z_at(view, rays, ray, along, rays.t[ray]) * placed.scale));
  glm::vec2 hit;
  for (int k = 0; k < 2; ++k)
    hit[k] = rays.from[k][ray] + rays.t[ray] * (rays.to[k][ray] - rays.from[k][ray]);
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
  SeenLayered certain, doubtful, skin, beyond;
  int inside = 0;
  bool sees_through = false;
  float surface = 0, nothing = 0, heaviest = 0;
  double free_to = 0, beyond_from = 1e300;
  double along = -1e300;  // of the views with weight that are certain, the greatest
  glm::vec4 blended{0.0f};
  std::array<std::uint8_t, ServingViews::kMaxCount> order;  // of placed views
  std::array<double, ServingViews::kMaxCount> order_along;

  // But for rounding, where the last view has all that lacked.
  [[nodiscard]] bool is_decided() const { return surface + nothing >= 0.999f * kSureWeight; }
  // Nothing, whatever the views show that are left, of this weight.
  [[nodiscard]] bool is_empty(float rest) const {
    return nothing >= kSureWeight && nothing > surface + rest;
  }
  void add_surface(const SeenLayered& seen, float weight) {
    surface += weight;
    blended += weight * seen.color;
    if (weight > heaviest) heaviest = weight, certain = seen;
  }
  // What one view says of the ray after its last edge, if another sees as far.
  void join() {
    if (is_decided() || beyond_from > free_to) return;
    const float weight = kSureWeight - surface - nothing;
    if (beyond.inverse_z == kSeesNothing)
      nothing += weight;
    else
      add_surface(beyond, weight);
  }
  [[nodiscard]] SeenLayered shown(bool several_views) const {
    if (nothing > surface || (surface == 0 && sees_through)) return {};
    if (surface == 0)
      return doubtful.inverse_z == kSeesNothing && inside > 0 && several_views ? skin : doubtful;
    SeenLayered out = certain;
    out.color = blended / (surface + nothing);
    return out;
  }
};

// Of the views without weight, those first that look along the ray.
void LayeredRays::find_order(const PlacedLayered& placed, Look& look) const {
  for (int k = placed.weighted; k < placed.count; ++k) {
    const std::size_t view = placed.views[std::size_t(k)].view;
    const double of_view = looks_along(pictures_[view].camera, look.ray);
    int to = k;
    for (; to > placed.weighted && look.order_along[std::size_t(to - 1)] < of_view; --to)
      look.order_along[std::size_t(to)] = look.order_along[std::size_t(to - 1)],
      look.order[std::size_t(to)] = look.order[std::size_t(to - 1)];
    look.order_along[std::size_t(to)] = of_view, look.order[std::size_t(to)] = std::uint8_t(k);
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
    for_bits(asking, [&](std::size_t i) {
      Look& look = looks[i];
      const float weight =
          view.weight > 0 ? view.weight : kSureWeight - look.surface - look.nothing;
      const bool behind = rays.passed_behind >> i & 1, hit = rays.hit >> i & 1;
      SeenLayered seen;
      if (hit) {
        seen = seen_at(placed, view, rays, i, along[i]);
        if (seen.inverse_z > look.doubtful.inverse_z) look.doubtful = seen;
      }
      if (behind) {
        look.free_to =
            std::max(look.free_to, eye_z_at(view, rays, i, along[i], rays.behind_from[i]));
        const double from =
            rays.behind_to[i] < 1 ? eye_z_at(view, rays, i, along[i], rays.behind_to[i]) : 1e300;
        if (from < look.beyond_from && (hit || picture.complete))
          look.beyond_from = from, look.beyond = seen;
        if (hit) return;
        const bool outline = rays.passed_outline >> i & 1;
        look.inside += outline ? -1 : 1;
        if (!outline && look.skin.inverse_z == kSeesNothing)
          look.skin = seen_at(placed, view, rays, i, along[i]);
        return;
      }
      if (hit)
        look.add_surface(seen, weight);
      else if (picture.complete)
        look.nothing += weight;
      if (!hit) look.sees_through |= picture.sees_through;
      if (view.weight > 0 && (hit || picture.complete) && !look.is_decided())
        look.along = std::max(look.along, looks_along(picture.camera, look.ray));
      if (look.is_empty(view.rest)) looking &= ~(1u << i);
    });
  };
  const auto leave_decided = [&] {
    for_bits(looking, [&](std::size_t i) {
      if (looks[i].is_decided()) looking &= ~(1u << i);
    });
  };
  const auto join = [&] {
    for_bits(looking, [&](std::size_t i) { looks[i].join(); });
    leave_decided();
  };
  for (int k = 0; k < placed.weighted && looking; ++k) {
    if (first_decides) leave_decided();
    ask(placed.views[std::size_t(k)], looking);
  }
  leave_decided();
  join();
  if (looking && placed.weighted < placed.asked)
    for_bits(looking, [&](std::size_t i) { find_order(placed, looks[i]); });
  for (int k = placed.weighted; k < placed.asked && looking; ++k) {
    for_bits(looking, [&](std::size_t i) {
      if (looks[i].order_along[std::size_t(k)] < looks[i].along) looking &= ~(1u << i);
    });
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
    join();
  }
  for_bits(wanted, [&](std::size_t i) {
    shown[i] = in_bounds >> i & 1 ? looks[i].shown(placed.count > 1) : SeenLayered{};
  });
}

}  // namespace rilievo
