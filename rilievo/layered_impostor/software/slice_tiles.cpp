#include "rilievo/layered_impostor/software/slice_tiles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/layered_impostor/software/impostor_tiles.h"
#include "rilievo/layered_impostor/software/placed_camera.h"
#include "rilievo/layered_impostor/software/slice_blocks.h"

namespace rilievo {
namespace {

// The least code that is not less than a scaled depth.
int first_code(float scaled) {
  int code = int(std::clamp(std::floor(scaled * 65535.0f), 0.0f, 65536.0f));
  while (code > 0 && float(code - 1) / 65535.0f >= scaled) --code;
  while (code < 65536 && float(code) / 65535.0f < scaled) ++code;
  return code;
}

class SliceTiles final : public ImpostorTiles {
 public:
  SliceTiles(LayeredImpostor impostor, const LayeredOptions& options);

  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override;
  void draw_tile(FrameTile& tile) const override;

 private:
  void place(const PlacedCamera& frame, std::uint32_t object, const SliceQuad& quad);

  SliceChooser chooser_;
  std::vector<SlicedPicture> pictures_;
  std::vector<PlacedSlice> placed_;  // kept, so that drawing does not allocate
};

SliceTiles::SliceTiles(LayeredImpostor impostor, const LayeredOptions& options)
    : ImpostorTiles(std::move(impostor), options), chooser_(impostor_) {
  pictures_.resize(impostor_.pictures.size());
  parallel_for(std::size_t(0), pictures_.size(), [&](std::size_t i) {
    DepthImage& picture = impostor_.pictures[i];
    SlicedPicture& kept = pictures_[i];
    const Image<glm::u8vec4> encoded = encoded_colors(picture.color);
    kept.color = Image<std::uint32_t>(encoded.width(), encoded.height());
    std::transform(
        encoded.texels().begin(), encoded.texels().end(), kept.color.texels().begin(),
        [](const glm::u8vec4& texel) { return opaque_content(glm::vec4(texel) / 255.0f); });
    const Image<glm::u16vec2> codes = slice_codes(impostor_, int(i));
    kept.codes = Image<std::uint32_t>(codes.width(), codes.height());
    std::transform(codes.texels().begin(), codes.texels().end(), kept.codes.texels().begin(),
                   [](const glm::u16vec2& code) { return code.x | std::uint32_t(code.y) << 16; });
    if (objects_.several) kept.object = std::move(picture.object);
    picture.color = {}, picture.depth = {}, picture.object = {};
    impostor_.surfaces[i].texels = {};
  });
  for (const SlicedPicture& picture : pictures_)
    bytes_ += picture.color.texels().size() * (kColorBytes + kIntervalBytes) +
              4 * picture.object.texels().size();
}

void SliceTiles::place(const PlacedCamera& frame, std::uint32_t object, const SliceQuad& quad) {
  const Camera& from = frame.camera;
  const Camera& camera = impostor_.pictures[std::size_t(quad.view)].camera;
  const Slice& slice = impostor_.slices[std::size_t(quad.view)][std::size_t(quad.slice)];
  const double s = double(slice.eye_z);
  const auto& [l, r, b, t] = camera.window;

  PlacedSlice placed;
  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30;
  int before = 0;
  for (int i = 0; i < 4; ++i) {
    const double u = double(quad.texels[i & 1 ? 2 : 0]) / camera.width,
                 v = double(quad.texels[i & 2 ? 3 : 1]) / camera.height;
    const glm::dvec3 corner(camera.world_from_eye *
                            glm::dvec4(s * (l + u * (r - l)), s * (t - v * (t - b)), -s, 1));
    if (glm::dot(corner - from.position(), from.forward()) < from.z_near) {
      ++before;
      continue;
    }
    const glm::dvec3 raster = raster_from_world(from, corner);
    x0 = std::min(x0, raster.x), x1 = std::max(x1, raster.x);
    y0 = std::min(y0, raster.y), y1 = std::max(y1, raster.y);
  }
  if (before == 4) return;
  if (before > 0) x0 = y0 = 0, x1 = from.width, y1 = from.height;
  const auto limited = [](double value, int most) {
    return int(std::clamp(value, 0.0, double(most)));
  };
  placed.x0 = limited(std::floor(x0), from.width), placed.x1 = limited(std::ceil(x1), from.width);
  placed.y0 = limited(std::floor(y0), from.height), placed.y1 = limited(std::ceil(y1), from.height);
  if (placed.x0 >= placed.x1 || placed.y0 >= placed.y1) return;

  const glm::dmat4 picture_from_world = eye_from_world(camera);
  const glm::dmat3 turn(picture_from_world);
  const glm::dvec3 o(picture_from_world * glm::dvec4(from.position(), 1));
  const auto along = [&](double x, double y) {
    return turn * (world_from_raster(from, {x, y}, 1.0) - from.position());
  };
  const glm::dvec3 d0 = along(0, 0), per_x = along(1, 0) - d0, per_y = along(0, 1) - d0;
  if (s + o.z == 0) return;  // the eye is in its plane
  const auto row = [&](int axis) { return glm::dvec3(per_x[axis], per_y[axis], d0[axis]); };
  placed.w = -row(2) / (s + o.z);
  placed.u = ((o.x * placed.w + row(0)) / s - l * placed.w) * (camera.width / (r - l));
  placed.v = (t * placed.w - (o.y * placed.w + row(1)) / s) * (camera.height / (t - b));
  const SliceScale scale = slice_scale(impostor_, quad.view);
  placed.front = first_code(scale(slice.front));
  placed.back = first_code(scale(slice.back));
  placed.inverse_scale = 1 / frame.scale;
  placed.most_w = 1 / from.z_near;
  placed.picture = &pictures_[std::size_t(quad.view)];
  placed.texels = quad.texels;
  placed.from = quad.from, placed.to = quad.to;
  placed.object = object;
  placed_.push_back(placed);
}

void SliceTiles::draw(const Camera& frame, std::span<const Instance> instances, Output) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  placed_.clear();
  for (const Instance& instance : instances) {
    const std::optional<PlacedCamera> placed = place_camera(frame, instance);
    if (!placed) continue;
    chooser_.choose(impostor_, placed->camera.position(), options_);
    for (const SliceQuad& quad : chooser_.quads())
      place(*placed, object_of(instance, objects_.only), quad);
  }
}

void SliceTiles::draw_tile(FrameTile& tile) const {
  for (const PlacedSlice& placed : placed_) draw_slice(placed, tile);
}

}  // namespace

std::unique_ptr<Drawable> make_slice_tiles(LayeredImpostor impostor,
                                           const LayeredOptions& options) {
  return std::make_unique<SliceTiles>(std::move(impostor), options);
}

}  // namespace rilievo
