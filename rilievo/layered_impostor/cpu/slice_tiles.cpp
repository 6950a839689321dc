// The ray of a pixel (x, y) of the frame, in the picture's eye space, is o + t d with t the frame's
// eye_z and d affine in x and y. It crosses the slice, at z = -S, where
//
//   w := 1 / t = -d.z / (S + o.z)
//
// and there the texel (u, v) of the picture's window (l, r, b, t) and size W x H is
//
//   u w = ((o.x w + d.x) / S - l w) W / (r - l)
//   v w = (t w - (o.y w + d.y) / S) H / (t - b)
//
// All three are affine in x and y.
#include "rilievo/layered_impostor/cpu/slice_tiles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/cpu/impostor_tiles.h"
#include "rilievo/layered_impostor/cpu/placed_camera.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

struct SlicedPicture {
  Image<std::uint32_t> color;  // as tiles hold it, opaque
  Image<glm::u16vec2> codes;
  Image<std::uint32_t> object;  // empty if all show one
};

// A quad in a frame. Values that are affine in the pixel have the factors of x, y and 1.
struct PlacedSlice {
  glm::dvec3 u{0.0}, v{0.0}, w{0.0};
  double inverse_scale = 1;
  double most_w = 0;  // at the near plane
  const SlicedPicture* picture = nullptr;
  glm::vec4 texels{0.0f};
  int front = 0, back = 0;  // it shows codes with front <= second and first < back
  float from = 0, to = 1;
  std::uint32_t object = kNoObject;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels
};

std::uint32_t opaque_content(const glm::u8vec4& premultiplied) {
  const glm::vec4 color = glm::vec4(premultiplied) / 255.0f;
  std::uint32_t content = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    content |=
        std::uint32_t(std::clamp(color[c] / std::max(color.a, 1e-3f), 0.0f, 1.0f) * 255.0f + 0.5f)
        << (8 * c);
  return content;
}

// The least code that is not less than a scaled depth.
int first_code(float scaled) {
  int code = int(std::clamp(std::floor(scaled * 65535.0f), 0.0f, 65536.0f));
  while (code > 0 && float(code - 1) / 65535.0f >= scaled) --code;
  while (code < 65536 && float(code) / 65535.0f < scaled) ++code;
  return code;
}

// In [0, 1): shader::kPixelHash. Rows count from the bottom there.
float pixel_hash(int x, int row) {
  const auto fract = [](float a) { return a - std::floor(a); };
  return fract(52.9829189f * fract(float(x) * 0.06711056f + float(row) * 0.00583715f));
}

// The least 1 / eye_z of a block's samples.
float find_farthest(FrameTile& tile, int block) {
  if (!tile.changed[block]) return tile.farthest[block];
  float least = tile.first[block].inverse_z[0];
  for (int s = 0; s < tile.planes(block); ++s)
    for (const float z : tile.plane(block, s).inverse_z) least = std::min(least, z);
  tile.changed[block] = false;
  return tile.farthest[block] = least;
}

double at(const glm::dvec3& affine, double x, double y) {
  return affine.x * x + affine.y * y + affine.z;
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
    std::transform(encoded.texels().begin(), encoded.texels().end(), kept.color.texels().begin(),
                   opaque_content);
    kept.codes = slice_codes(impostor_, int(i));
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

// How far a place lies within the quad's edges, all of them times w, and beyond the near plane;
// >= 0: it does.
double within(const PlacedSlice& placed, double x, double y) {
  const double w = at(placed.w, x, y), u = at(placed.u, x, y), v = at(placed.v, x, y);
  return std::min({w, placed.most_w - w, u - double(placed.texels.x) * w,
                   double(placed.texels.z) * w - u, v - double(placed.texels.y) * w,
                   double(placed.texels.w) * w - v});
}

// The texel at a pixel's centre as the quad shows it; none if it does not. Beyond the quad's edge
// as well: a fragment has the centre's texel even if only other samples lie on the quad.
std::optional<glm::ivec2> shown_texel(const PlacedSlice& placed, const FrameTile& tile, int x,
                                      int y) {
  const double w = at(placed.w, x + 0.5, y + 0.5);
  const glm::dvec2 place(at(placed.u, x + 0.5, y + 0.5) / w, at(placed.v, x + 0.5, y + 0.5) / w);
  const Image<glm::u16vec2>& codes = placed.picture->codes;
  if (!(place.x > -1 && place.x < codes.width() && place.y > -1 && place.y < codes.height()))
    return std::nullopt;
  const glm::ivec2 texel(place);
  const glm::u16vec2 code = codes(texel.x, texel.y);
  if (int(code.y) < placed.front || int(code.x) >= placed.back) return std::nullopt;
  if (placed.from > 0 || placed.to < 1) {
    const float hash = pixel_hash(x, tile.height - 1 - y);
    if (hash < placed.from || hash >= placed.to) return std::nullopt;
  }
  return texel;
}

// Writes a pixel's samples that lie on the quad, of which `covered` has the bits, and are not
// hidden.
void write_pixel(const PlacedSlice& placed, FrameTile& tile, int block, int pixel, int x, int y,
                 unsigned covered, std::uint32_t content) {
  const int planes = tile.planes(block);
  for (int s = 0; s < planes; ++s) {
    if (planes > 1 && !(covered >> s & 1)) continue;
    const double w = planes == 1 ? at(placed.w, x + 0.5, y + 0.5)
                                 : at(placed.w, x + double(FrameTile::kSampleX[s]),
                                      y + double(FrameTile::kSampleY[s]));
    const auto inverse_z = float(w * placed.inverse_scale);
    FrameTile::Plane& plane = tile.plane(block, s);
    if (!(inverse_z > plane.inverse_z[pixel])) continue;
    plane.inverse_z[pixel] = inverse_z;
    plane.content[pixel] = content;
    tile.changed[block] = true;
  }
}

// Draws what a block shows of a quad.
void draw_block(const PlacedSlice& placed, FrameTile& tile, int block) {
  constexpr int kBlock = FrameTile::kBlock;
  const int left = tile.x + block % FrameTile::kBlocks * kBlock,
            top = tile.y + block / FrameTile::kBlocks * kBlock;
  const int x0 = std::max(left, placed.x0), x1 = std::min(left + kBlock, placed.x1),
            y0 = std::max(top, placed.y0), y1 = std::min(top + kBlock, placed.y1);
  if (x0 >= x1 || y0 >= y1) return;
  const double most = std::max(
      {at(placed.w, x0, y0), at(placed.w, x1, y0), at(placed.w, x0, y1), at(placed.w, x1, y1)});
  if (float(most * placed.inverse_scale) <= find_farthest(tile, block)) return;
  // Its edges are straight: what holds at the corners holds between them.
  const bool inside = std::min({within(placed, x0, y0), within(placed, x1, y0),
                                within(placed, x0, y1), within(placed, x1, y1)}) >= 0;
  const unsigned all = (1u << tile.samples) - 1;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      unsigned covered = inside ? all : 0;
      for (int s = 0; !inside && s < tile.samples; ++s) {
        const double sx = tile.samples == 1 ? 0.5 : double(FrameTile::kSampleX[s]),
                     sy = tile.samples == 1 ? 0.5 : double(FrameTile::kSampleY[s]);
        covered |= unsigned(within(placed, x + sx, y + sy) >= 0) << s;
      }
      if (covered == 0) continue;
      const std::optional<glm::ivec2> texel = shown_texel(placed, tile, x, y);
      if (!texel) continue;
      if (covered != all) tile.expand(block);
      const std::uint32_t content =
          tile.of == TileContent::color    ? placed.picture->color(texel->x, texel->y)
          : placed.picture->object.empty() ? placed.object
                                           : placed.picture->object(texel->x, texel->y);
      write_pixel(placed, tile, block, (y - top) * kBlock + x - left, x, y, covered, content);
    }
}

void SliceTiles::draw_tile(FrameTile& tile) const {
  constexpr int kBlock = FrameTile::kBlock;
  for (const PlacedSlice& placed : placed_) {
    const int from_x = std::max(placed.x0 - tile.x, 0) / kBlock,
              from_y = std::max(placed.y0 - tile.y, 0) / kBlock,
              to_x = std::min(placed.x1 - tile.x, FrameTile::kSize),
              to_y = std::min(placed.y1 - tile.y, FrameTile::kSize);
    for (int y = from_y; y * kBlock < to_y; ++y)
      for (int x = from_x; x * kBlock < to_x; ++x)
        draw_block(placed, tile, y * FrameTile::kBlocks + x);
  }
}

}  // namespace

std::unique_ptr<Drawable> make_slice_tiles(LayeredImpostor impostor,
                                           const LayeredOptions& options) {
  return std::make_unique<SliceTiles>(std::move(impostor), options);
}

}  // namespace rilievo
