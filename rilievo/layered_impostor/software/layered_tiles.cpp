#include "rilievo/layered_impostor/software/layered_tiles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/layered_impostor/software/impostor_tiles.h"
#include "rilievo/layered_impostor/software/march_rays.h"
#include "rilievo/layered_impostor/software/placed_camera.h"
#include "rilievo/layered_impostor/software/placed_layered.h"
#include "rilievo/layered_impostor/software/sampled_pixels.h"
#include "rilievo/layered_impostor/software/silhouette_pixels.h"
#include "rilievo/layered_impostor/software/slice_tiles.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

// Samples along silhouettes are looked for so far before and behind what their neighbours show, as
// a share of the impostor's radius. Five times as far takes a fern a fifth longer, with no better
// picture.
constexpr double kMarginShare = 0.02;

struct LayeredPicture {
  Image<glm::u8vec4> color;
  Image<std::uint32_t> object;  // empty if all show one
  MarchSurface surface;
};

class LayeredTiles final : public ImpostorTiles {
 public:
  LayeredTiles(LayeredImpostor impostor, const LayeredOptions& options);

  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_tile(FrameTile& tile) const override;

 private:
  [[nodiscard]] bool place(const Camera& frame, const Instance& instance, PlacedLayered& out) const;
  void place_views(const glm::dvec3& eye, PlacedLayered& out) const;
  static constexpr int kRow = FrameTile::kBlock;
  static_assert(kRow == MarchRays::kCount);
  // What the pixels of a tile show at their centres.
  struct Centers;
  void look_at_centers(const PlacedLayered& placed, const FrameTile& tile, int block,
                       Centers& centers) const;
  void look_beside(const PlacedLayered& placed, const FrameTile& tile, Centers& centers) const;
  static void draw_block(const Centers& centers, const SampledPixels& pixels, FrameTile& tile,
                         int block);
  void draw_samples(const PlacedLayered& placed, const Centers& centers, SampledPixels& pixels,
                    FrameTile& tile) const;
  struct Look;
  // A raster position, and some distances along its ray.
  struct Gaze {
    glm::dvec2 at{0.0};
    double begin = 0, end = 1e300;
  };
  // What those show whose bit is set. `first_decides`: of the views that know it the best one alone
  // is asked.
  void look(const PlacedLayered& placed, const std::array<Gaze, kRow>& gazes, std::uint32_t wanted,
            SeenLayered (&shown)[kRow], bool first_decides = false) const;
  // Where a ray ended; `along` is its direction as the view's picture has it.
  [[nodiscard]] SeenLayered seen_at(const PlacedLayered& placed, const MarchedView& view,
                                    const MarchRays& rays, std::size_t ray,
                                    const glm::dvec3& along) const;
  static void write(const SeenLayered& seen, FrameTile& tile, int block, int pixel);
  static void write_sample(const SeenLayered& seen, FrameTile& tile, int block, int pixel,
                           int sample);

  RayBounds bounds_;
  std::vector<LayeredPicture> pictures_;
  std::vector<PlacedLayered> placed_;  // front to back; kept, so that drawing does not allocate
};

LayeredTiles::LayeredTiles(LayeredImpostor impostor, const LayeredOptions& options)
    : ImpostorTiles(std::move(impostor), options), bounds_(impostor_.bounds) {
  pictures_.resize(impostor_.pictures.size());
  parallel_for(std::size_t(0), pictures_.size(), [&](std::size_t i) {
    DepthImage& picture = impostor_.pictures[i];
    pictures_[i].color = encoded_colors(picture.color);
    if (objects_.several) pictures_[i].object = std::move(picture.object);
    pictures_[i].surface = make_march_surface(impostor_.surfaces[i]);
    picture.color = {}, picture.depth = {}, picture.object = {};
    impostor_.surfaces[i].texels = {};
  });
  for (const LayeredPicture& picture : pictures_)
    bytes_ += picture.color.texels().size() * kColorBytes + picture.surface.bytes() +
              4 * picture.object.texels().size();
}

bool LayeredTiles::place(const Camera& frame, const Instance& instance, PlacedLayered& out) const {
  const std::optional<PlacedCamera> moved = place_camera(frame, instance);
  if (!moved) return false;
  out.camera = moved->camera, out.scale = moved->scale;
  out.object = object_of(instance, objects_.only);

  const glm::dvec3 eye = out.camera.position(), center(impostor_.bounds.center());
  out.distance = glm::length(eye - center) * out.scale;
  const auto ray_at = [&](double x, double y) {
    return world_from_raster(out.camera, {x, y}, 1.0) - eye;
  };
  const glm::dvec3 corner_ray = ray_at(0, 0);
  out.ray_from_raster = {ray_at(1, 0) - corner_ray, ray_at(0, 1) - corner_ray, corner_ray};
  place_views(eye, out);
  out.margin = kMarginShare * double(impostor_.bounds.radius());

  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30, nearest = 1e300;
  const double slack = 1e-4 * double(impostor_.bounds.radius());
  for (const glm::dvec3 corner : impostor_.bounds.corners()) {
    const double eye_z = glm::dot(corner - eye, out.camera.forward()) - slack;
    nearest = std::min(nearest, eye_z);
    if (eye_z < out.camera.z_near) continue;
    const glm::dvec3 at = raster_from_world(out.camera, corner);
    x0 = std::min(x0, at.x), x1 = std::max(x1, at.x);
    y0 = std::min(y0, at.y), y1 = std::max(y1, at.y);
  }
  if (x0 > x1) return false;  // behind the eye
  if (nearest < out.camera.z_near) {
    x0 = y0 = 0, x1 = frame.width, y1 = frame.height;
    nearest = out.camera.z_near;
  }
  const auto limited = [](double v, int most) { return int(std::clamp(v, 0.0, double(most))); };
  out.x0 = limited(std::floor(x0 - 0.5), frame.width);
  out.x1 = limited(std::ceil(x1 + 0.5), frame.width);
  out.y0 = limited(std::floor(y0 - 0.5), frame.height);
  out.y1 = limited(std::ceil(y1 + 0.5), frame.height);
  out.nearest = float(1.0001 / (nearest * out.scale));
  return out.x0 < out.x1 && out.y0 < out.y1;
}

void LayeredTiles::place_views(const glm::dvec3& eye, PlacedLayered& out) const {
  const ServingViews serving = views_for_eye(impostor_, eye, options_);
  out.count = serving.count;
  float rest = 0;
  for (int i = serving.count; i-- > 0;) {
    MarchedView& marched = out.views[std::size_t(i)];
    marched.view = std::size_t(serving.views[i]);
    marched.weight = serving.weights[i], marched.rest = rest;
    rest += serving.weights[i];
    const Camera& camera = impostor_.pictures[marched.view].camera;
    const auto& [l, r, b, t] = camera.window;
    const double per_u = camera.width / (r - l), per_v = camera.height / (t - b);
    // Columns: what x, y and z of the picture's eye space add to (u w, v w, w).
    const glm::dmat3 raster_from_eye{per_u, 0, 0, 0, -per_v, 0, l * per_u, -t * per_v, -1};
    const glm::dmat4 from_world = eye_from_world(camera);
    marched.eye = raster_from_eye * glm::dvec3(from_world * glm::dvec4(eye, 1));
    marched.per_raster = raster_from_eye * glm::dmat3(from_world) * out.ray_from_raster;
  }
}

void LayeredTiles::draw(const Camera& frame, std::span<const Instance> instances, Output) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  placed_.clear();
  PlacedLayered placed;
  for (const Instance& instance : instances)
    if (place(frame, instance, placed)) placed_.push_back(placed);
  std::stable_sort(
      placed_.begin(), placed_.end(),
      [](const PlacedLayered& a, const PlacedLayered& b) { return a.distance < b.distance; });
}

SeenLayered LayeredTiles::seen_at(const PlacedLayered& placed, const MarchedView& view,
                                  const MarchRays& rays, std::size_t ray,
                                  const glm::dvec3& along) const {
  const LayeredPicture& picture = pictures_[view.view];
  glm::vec3 hit;  // u, v, q
  for (int k = 0; k < 3; ++k)
    hit[k] = rays.from[k][ray] + rays.t[ray] * (rays.to[k][ray] - rays.from[k][ray]);
  const glm::dvec3 from_eye = glm::dvec3(hit.x, hit.y, 1) / double(hit.z) - view.eye;
  const double t = glm::dot(from_eye, along) / glm::dot(along, along);
  SeenLayered seen;
  seen.inverse_z = float(1 / (t * placed.scale));
  const glm::ivec2 texel(rays.x[ray], rays.y[ray]);
  seen.object = objects_.several ? picture.object(texel.x, texel.y) : placed.object;

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
struct LayeredTiles::Look {
  PixelRay ray;
  SeenLayered certain, doubtful, skin;
  int inside = 0;
  bool sees_through = false;
  float surface = 0, nothing = 0, heaviest = 0;
  glm::vec4 blended{0.0f};

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

// The rules are those of warp_surfaces().
void LayeredTiles::look(const PlacedLayered& placed, const std::array<Gaze, kRow>& gazes,
                        std::uint32_t wanted, SeenLayered (&shown)[kRow],
                        bool first_decides) const {
  std::array<Look, kRow> looks;
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
  std::array<glm::dvec3, kRow> along;
  for (int k = 0; k < placed.count && looking; ++k) {
    const MarchedView& view = placed.views[std::size_t(k)];
    const Camera& camera = impostor_.pictures[view.view].camera;
    if (view.weight == 0 || first_decides)
      for_bits(looking, [&](std::size_t i) {
        if (looks[i].surface + looks[i].nothing > 0) looking &= ~(1u << i);
      });
    rays.wanted = 0;
    for_bits(looking, [&](std::size_t i) {
      along[i] = view.per_raster * raster(i);
      const std::optional<DisparitySegment> segment = disparity_segment_between(
          camera, view.eye + looks[i].ray.begin * along[i], view.eye + looks[i].ray.end * along[i]);
      if (!segment) return;
      rays.wanted |= 1u << i;
      for (int a = 0; a < 3; ++a)
        rays.from[a][i] = float(segment->from[a]), rays.to[a][i] = float(segment->to[a]);
    });
    march_rays(pictures_[view.view].surface, rays);
    const float weight = view.weight > 0 ? view.weight : 1.0f;
    for_bits(looking, [&](std::size_t i) {
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
        if (impostor_.complete[view.view]) look.nothing += weight;
        look.sees_through |= impostor_.sees_through[view.view];
        if (look.is_empty(view.rest)) looking &= ~(1u << i);
      } else {
        const bool outline = rays.passed_outline >> i & 1;
        look.inside += outline ? -1 : 1;
        if (!outline && look.skin.inverse_z == kSeesNothing)
          look.skin = seen_at(placed, view, rays, i, along[i]);
      }
    });
  }
  for_bits(wanted, [&](std::size_t i) {
    shown[i] = in_bounds >> i & 1 ? looks[i].shown(placed.count > 1) : SeenLayered{};
  });
}

struct LayeredTiles::Centers {
  TileBits asked, shown;
  SeenLayered seen[FrameTile::kBlockCount][FrameTile::kBlockPixels];  // where asked for
  // What the pixels beside the tile show: above, below, left, right.
  float beside[4][FrameTile::kSize];

  [[nodiscard]] float inverse_z(int x, int y) const {
    if (y < 0 || y > 63) return beside[y < 0 ? 0 : 1][x];
    if (x < 0 || x > 63) return beside[x < 0 ? 2 : 3][y];
    return seen[y / kRow * FrameTile::kBlocks + x / kRow][y % kRow * kRow + x % kRow].inverse_z;
  }
  // Where along its rays a pixel of a silhouette shows something, as it and its neighbours do.
  [[nodiscard]] std::pair<double, double> stretch(const PlacedLayered& placed, int x, int y) const {
    float farthest = 1e30f, nearest = 0;
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u)
        if (shown.has(u, v)) {
          const float z = inverse_z(u, v);
          farthest = std::min(farthest, z), nearest = std::max(nearest, z);
        }
    return {1 / (double(nearest) * placed.scale) - placed.margin,
            1 / (double(farthest) * placed.scale) + placed.margin};
  }
};

// The pixels beside the tile, next to those asked for: a silhouette may pass along its border. What
// is nearer there is in another tile, and is not looked for.
void LayeredTiles::look_beside(const PlacedLayered& placed, const FrameTile& tile,
                               Centers& centers) const {
  constexpr int kLast = FrameTile::kSize - 1;
  for (int side = 0; side < 4; ++side)
    for (int begin = 0; begin < FrameTile::kSize; begin += kRow) {
      // Of the k-th: itself if `out` is 1, and its neighbour in the tile if that is 0.
      const auto place = [&](int k, int out) {
        const int across = side % 2 == 0 ? -out : kLast + out;
        return side < 2 ? glm::ivec2(begin + k, across) : glm::ivec2(across, begin + k);
      };
      std::uint32_t wanted = 0;
      std::array<Gaze, kRow> gazes;
      for (int k = 0; k < kRow; ++k) {
        const glm::ivec2 within = place(k, 0);
        const int x = tile.x + place(k, 1).x, y = tile.y + place(k, 1).y;
        gazes[std::size_t(k)].at = {x + 0.5, y + 0.5};
        if (centers.asked.has(within.x, within.y) && x >= placed.x0 && x < placed.x1 &&
            y >= placed.y0 && y < placed.y1)
          wanted |= 1u << k;
      }
      if (!wanted) continue;
      SeenLayered shown[kRow];
      look(placed, gazes, wanted, shown);
      for (int k = 0; k < kRow; ++k) {
        if (!(wanted >> k & 1)) continue;
        const glm::ivec2 at = place(k, 1);
        centers.beside[side][begin + k] = shown[k].inverse_z;
        centers.asked.set(at.x, at.y);
        if (shown[k].inverse_z != kSeesNothing) centers.shown.set(at.x, at.y);
      }
    }
}

void LayeredTiles::look_at_centers(const PlacedLayered& placed, const FrameTile& tile, int block,
                                   Centers& centers) const {
  const int x0 = block % FrameTile::kBlocks * kRow, y0 = block / FrameTile::kBlocks * kRow;
  if (tile.x + x0 >= placed.x1 || tile.y + y0 >= placed.y1 || tile.x + x0 + kRow <= placed.x0 ||
      tile.y + y0 + kRow <= placed.y0)
    return;
  for (int row = 0; row < kRow; ++row) {
    const int y = tile.y + y0 + row;
    if (y < placed.y0 || y >= placed.y1) continue;
    std::uint32_t wanted = 0;
    std::array<Gaze, kRow> gazes;
    for (int k = 0; k < kRow; ++k) {
      const int x = tile.x + x0 + k, i = row * kRow + k;
      float farthest = tile.first[block].inverse_z[i];
      if (tile.expanded[block])
        for (const FrameTile::Plane& plane : tile.more[block])
          farthest = std::min(farthest, plane.inverse_z[i]);
      gazes[std::size_t(k)].at = {x + 0.5, y + 0.5};
      if (x >= placed.x0 && x < placed.x1 && placed.nearest > farthest) wanted |= 1u << k;
    }
    if (!wanted) continue;
    SeenLayered shown[kRow];
    look(placed, gazes, wanted, shown);
    for (int k = 0; k < kRow; ++k) {
      if (!(wanted >> k & 1)) continue;
      centers.seen[block][row * kRow + k] = shown[k];
      centers.asked.set(x0 + k, y0 + row);
      if (shown[k].inverse_z != kSeesNothing) centers.shown.set(x0 + k, y0 + row);
    }
  }
}

// All samples of a pixel show what its centre shows. Along silhouettes each sample shows what its
// own ray meets in the best view, if that covers so much of its texel: elsewhere, what is behind
// the edge of a texel may be another part of the object, which its picture does not show.
void LayeredTiles::draw_block(const Centers& centers, const SampledPixels& pixels, FrameTile& tile,
                              int block) {
  const int x0 = block % FrameTile::kBlocks * kRow, y0 = block / FrameTile::kBlocks * kRow;
  for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
    const int x = x0 + i % kRow, y = y0 + i / kRow;
    if (centers.shown.has(x, y) && !pixels.has(x, y)) write(centers.seen[block][i], tile, block, i);
  }
}

void LayeredTiles::draw_samples(const PlacedLayered& placed, const Centers& centers,
                                SampledPixels& pixels, FrameTile& tile) const {
  const SampledPixels::Pixel* pixel[2];
  while ((pixel[0] = pixels.next()) != nullptr) {
    // The samples of two pixels march together.
    pixel[1] = pixels.next();
    std::array<Gaze, kRow> gazes;
    const int count = pixel[1] ? 8 : 4;
    for (int k = 0; k < count; ++k) {
      const SampledPixels::Pixel& of = *pixel[k / 4];
      gazes[std::size_t(k)] = {
          glm::dvec2(tile.x + of.x, tile.y + of.y) +
              glm::dvec2(double(FrameTile::kSampleX[k % 4]), double(FrameTile::kSampleY[k % 4])),
          of.begin, of.end};
    }
    SeenLayered shown[kRow];
    look(placed, gazes, (1u << count) - 1, shown, true);
    for (int of = 0; 4 * of < count; ++of) {
      const SampledPixels::Pixel& at = *pixel[of];
      if (!centers.shown.has(at.x, at.y)) {
        unsigned some = 0;
        for (int s = 0; s < 4; ++s)
          some |= unsigned(shown[4 * of + s].inverse_z != kSeesNothing) << s;
        pixels.add_beside(at, some, centers.asked, centers.shown);
      }
      const TilePixel in_tile(tile, tile.x + at.x, tile.y + at.y);
      for (int s = 0; s < 4; ++s)
        write_sample(shown[4 * of + s], tile, in_tile.block, in_tile.pixel, s);
    }
  }
}

void LayeredTiles::write_sample(const SeenLayered& seen, FrameTile& tile, int block, int pixel,
                                int sample) {
  const FrameTile::Plane& before = tile.plane(block, tile.expanded[block] ? sample : 0);
  if (!covers_sample(seen.color.a, sample) || !(seen.inverse_z > before.inverse_z[pixel])) return;
  tile.expand(block);
  tile.changed[block] = true;
  FrameTile::Plane& plane = tile.plane(block, sample);
  plane.inverse_z[pixel] = seen.inverse_z;
  plane.content[pixel] = opaque_content(seen.color);
}

void LayeredTiles::write(const SeenLayered& seen, FrameTile& tile, int block, int pixel) {
  const std::uint32_t content =
      tile.of == TileContent::color ? opaque_content(seen.color) : seen.object;
  for (int s = 0; s < tile.planes(block); ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    if (!(seen.inverse_z > plane.inverse_z[pixel])) continue;
    plane.inverse_z[pixel] = seen.inverse_z;
    plane.content[pixel] = content;
    tile.changed[block] = true;
  }
}

void LayeredTiles::draw_tile(FrameTile& tile) const {
  static thread_local Centers centers;
  static thread_local SampledPixels pixels;
  for (const PlacedLayered& placed : placed_) {
    if (placed.x0 >= tile.x + FrameTile::kSize || placed.x1 <= tile.x ||
        placed.y0 >= tile.y + FrameTile::kSize || placed.y1 <= tile.y)
      continue;
    centers.asked = centers.shown = {};
    for (int block = 0; block < FrameTile::kBlockCount; ++block)
      look_at_centers(placed, tile, block, centers);
    pixels.clear();
    if (tile.samples == 4) {
      look_beside(placed, tile, centers);
      const TileBits along = silhouette_pixels(centers.asked, centers.shown);
      for (int y = 0; y < FrameTile::kSize; ++y)
        for (std::uint64_t row = along.row[std::size_t(y)]; row; row &= row - 1) {
          const int x = std::countr_zero(row);
          const auto [begin, end] = centers.stretch(placed, x, y);
          pixels.add({x, y, begin, end});
        }
    }
    for (int block = 0; block < FrameTile::kBlockCount; ++block)
      draw_block(centers, pixels, tile, block);
    draw_samples(placed, centers, pixels, tile);
  }
}

class LayeredTilesFactory final : public DrawableFactory {
 public:
  [[nodiscard]] std::size_t expected_bytes(const OptionValues& bake,
                                           const OptionValues& draw) const override {
    const BakeOptions options = layered_bake_options(bake);
    const int views = int(make_view_set(options.views).directions.size());
    return layered_texture_bytes(views, options.camera.size, options.camera.size,
                                 layered_draw_options(draw).method);
  }
  void spare(OptionValues& bake, const OptionValues& draw) const override {
    if (layered_draw_options(draw).method != LayeredMethod::slices)
      (void)bake.set("no-fills", "on");
  }
  [[nodiscard]] Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) override {
    auto& layered = dynamic_cast<LayeredRepresentation&>(*representation);
    return {make_layered_tiles(std::move(layered.impostor), layered_draw_options(draw))};
  }
};

}  // namespace

std::unique_ptr<Drawable> make_layered_tiles(LayeredImpostor impostor,
                                             const LayeredOptions& options) {
  if (options.method == LayeredMethod::slices)
    return make_slice_tiles(std::move(impostor), options);
  return std::make_unique<LayeredTiles>(std::move(impostor), options);
}

Result<std::unique_ptr<DrawableFactory>> make_layered_tiles_factory() {
  return {std::make_unique<LayeredTilesFactory>()};
}

}  // namespace rilievo
