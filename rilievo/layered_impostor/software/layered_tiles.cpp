#include "rilievo/layered_impostor/software/layered_tiles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/layered_impostor/software/impostor_tiles.h"
#include "rilievo/layered_impostor/software/layered_rays.h"
#include "rilievo/layered_impostor/software/pixel_centers.h"
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

class LayeredTiles final : public ImpostorTiles {
 public:
  LayeredTiles(LayeredImpostor impostor, const LayeredOptions& options);

  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_tile(FrameTile& tile) const override;

 private:
  [[nodiscard]] bool place(const Camera& frame, const Instance& instance, PlacedLayered& out) const;
  void place_views(const glm::dvec3& eye, PlacedLayered& out) const;
  static constexpr int kRow = FrameTile::kBlock;
  static void draw_block(const PixelCenters& centers, const SampledPixels& pixels, FrameTile& tile,
                         int block);
  void draw_samples(const PlacedLayered& placed, const PixelCenters& centers, SampledPixels& pixels,
                    FrameTile& tile) const;
  static void write(const SeenLayered& seen, FrameTile& tile, int block, int pixel);
  static void write_sample(const SeenLayered& seen, FrameTile& tile, int block, int pixel,
                           int sample);

  LayeredRays rays_;
  std::vector<PlacedLayered> placed_;  // front to back; kept, so that drawing does not allocate
};

LayeredTiles::LayeredTiles(LayeredImpostor impostor, const LayeredOptions& options)
    : ImpostorTiles(std::move(impostor), options), rays_(impostor_) {
  bytes_ = rays_.bytes();
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
  out.count = serving.count, out.weighted = serving.weighted, out.asked = serving.asked;
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

// All samples of a pixel show what its centre shows. Along silhouettes each sample shows what its
// own ray meets in the best view, if that covers so much of its texel: elsewhere, what is behind
// the edge of a texel may be another part of the object, which its picture does not show.
void LayeredTiles::draw_block(const PixelCenters& centers, const SampledPixels& pixels,
                              FrameTile& tile, int block) {
  const int x0 = block % FrameTile::kBlocks * kRow, y0 = block / FrameTile::kBlocks * kRow;
  for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
    const int x = x0 + i % kRow, y = y0 + i / kRow;
    if (centers.shown().has(x, y) && !pixels.has(x, y))
      write(centers.seen(block, i), tile, block, i);
  }
}

void LayeredTiles::draw_samples(const PlacedLayered& placed, const PixelCenters& centers,
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
    rays_.look(placed, gazes, (1u << count) - 1, shown, true);
    for (int of = 0; 4 * of < count; ++of) {
      const SampledPixels::Pixel& at = *pixel[of];
      if (!centers.shown().has(at.x, at.y)) {
        unsigned some = 0;
        for (int s = 0; s < 4; ++s)
          some |= unsigned(shown[4 * of + s].inverse_z != kSeesNothing) << s;
        pixels.add_beside(at, some, centers.asked(), centers.shown());
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
  static thread_local PixelCenters centers;
  static thread_local SampledPixels pixels;
  for (const PlacedLayered& placed : placed_) {
    if (placed.x0 >= tile.x + FrameTile::kSize || placed.x1 <= tile.x ||
        placed.y0 >= tile.y + FrameTile::kSize || placed.y1 <= tile.y)
      continue;
    centers.look(rays_, placed, tile);
    pixels.clear();
    if (tile.samples == 4) {
      centers.look_beside(rays_, placed, tile);
      const TileBits along = silhouette_pixels(centers.asked(), centers.shown());
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
