// A texel (x, y) of `main` lies in the direction d = (X, Y, -1) of its eye space, affine in x and
// y. With R from its axes to the other's and w = -(R d).z, it lies at ((R d).x / w, (R d).y / w) in
// tangents of the other; what is there at a distance z lies at z / w from main's plane of the eye.
// All of it is linear in (x, y, 1) but for one division.
#include "rilievo/relief_impostor/merge_warps.h"

#include <algorithm>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/relief_impostor/merge_rows.h"

namespace rilievo {
namespace {

// A picture is alone where the other's eye is so many times as far.
constexpr double kOwnEye = 0.01;

InverseDepth inverse_depth(const PictureGeometry& geometry) {
  const double n = geometry.capture.z_near, f = geometry.capture.z_far;
  return {float(1 / n), float((1 / f - 1 / n) / delta_steps(16))};
}

// Calls body(row) for each row, on all cores or on this thread alone.
template <class Body>
void for_rows(int rows, bool parallel, const Body& body) {
  if (parallel) return parallel_for(0, rows, body);
  for (int row = 0; row < rows; ++row) body(row);
}

// With a texel that shows nothing beyond each side; its texels from row to row.
int pack(const Prewarped& warp, std::span<const std::uint16_t> flags, bool parallel,
         std::vector<WarpTexel>& texels) {
  const int width = warp.width(), height = warp.height(), pitch = warp_pitch(width + 2);
  texels.resize(std::size_t(pitch) * std::size_t(height + 2));
  for_rows(height + 2, parallel, [&, width, height, pitch](int row) {
    constexpr WarpTexel kNothing{0, kEmptyWarped};
    WarpTexel* to = texels.data() + std::size_t(row) * std::size_t(pitch);
    if (row == 0 || row > height) {
      std::fill_n(to, width + 2, kNothing);
      return;
    }
    const std::size_t from = std::size_t(row - 1) * std::size_t(width);
    to[0] = to[width + 1] = kNothing;
    pack_row(reinterpret_cast<const std::uint32_t*>(warp.color.data()) + from,
             warp.delta.data() + from, flags.data() + from, width, to + 1);
  });
  return pitch;
}

}  // namespace

std::optional<glm::dvec4> rectangle_on(const PictureGeometry& picture, const Prewarped& warp) {
  const Camera& from = warp.geometry.capture;
  const glm::dvec3 eye = from.position(), forward = picture.capture.forward();
  const double height = picture.plane_z - glm::dot(eye - picture.capture.position(), forward);
  if (!(height > 0)) return std::nullopt;
  glm::dvec4 sides(1e300, 1e300, -1e300, -1e300);
  for (int k = 0; k < 4; ++k) {
    const glm::dvec2 corner((k & 1) * from.width, (k >> 1) * from.height);
    const glm::dvec3 way = world_from_raster(from, corner, 1) - eye;
    const double towards = glm::dot(way, forward);
    if (!(towards > 0.1 * glm::length(way))) return std::nullopt;
    const glm::dvec3 at = raster_from_world(picture.capture, eye + way * (height / towards));
    sides = {std::min(sides.x, at.x), std::min(sides.y, at.y), std::max(sides.z, at.x),
             std::max(sides.w, at.y)};
  }
  return sides;
}

void merge_warps(Prewarped& main, std::span<std::uint16_t> main_flags, const Prewarped& other,
                 std::span<const std::uint16_t> other_flags, double share,
                 std::vector<WarpTexel>& texels, bool parallel) {
  RILIEVO_EXPECTS(main_flags.size() == main.color.size());
  RILIEVO_EXPECTS(other_flags.size() == other.color.size());
  const Camera &to = main.geometry.capture, &from = other.geometry.capture;
  const glm::dmat3 turn =
      glm::transpose(glm::dmat3(from.world_from_eye)) * glm::dmat3(to.world_from_eye);
  const ImageWindow &a = to.window, &b = from.window;
  // (u w, v w, w) of (x, y, 1).
  const glm::dmat3 direction(glm::dvec3((a.right - a.left) / to.width, 0, 0),
                             glm::dvec3(0, (a.bottom - a.top) / to.height, 0),
                             glm::dvec3(a.left, a.top, -1));
  const double across = from.width / (b.right - b.left), down = from.height / (b.top - b.bottom);
  const glm::dmat3 texel(glm::dvec3(across, 0, 0), glm::dvec3(0, -down, 0),
                         glm::dvec3(b.left * across, -b.top * down, -1));
  const glm::dmat3 map = texel * turn * direction;

  MergeInput input;
  for (int k = 0; k < 9; ++k) input.map[k / 3][k % 3] = float(map[k / 3][k % 3]);
  input.other_pitch = pack(other, other_flags, parallel, texels);
  input.other = texels.data();
  input.other_width = other.width(), input.other_height = other.height();
  input.other_depth = inverse_depth(other.geometry);
  input.main_depth = inverse_depth(main.geometry);
  input.share = float(share);
  const int width = main.width();
  for_rows(main.height(), parallel, [&, width](int y) {
    const std::size_t row = std::size_t(y) * std::size_t(width);
    merge_row(input, y, width, reinterpret_cast<std::uint32_t*>(main.color.data()) + row,
              main.delta.data() + row, main_flags.data() + row);
  });
}

std::optional<WarpedTexels> warp_pair(const ImpostorPicture& one, const ImpostorPicture& two,
                                      const glm::dvec3& eye, const ImpostorWarpOptions& options,
                                      WarpPairScratch& scratch, Prewarped& result) {
  const double from_one = glm::distance(one.geometry.capture.position(), eye),
               from_two = glm::distance(two.geometry.capture.position(), eye);
  const bool first = from_one <= from_two;
  const ImpostorPicture &main = first ? one : two, &other = first ? two : one;
  const double near = std::min(from_one, from_two), far = std::max(from_one, from_two);
  ImpostorWarpOptions with = options;
  bool both = near > kOwnEye * far &&
              warp_impostor(other, eye, options, scratch.other, scratch.board).has_value();
  if (both) with.room = rectangle_on(main.geometry, scratch.board);
  both = both && with.room;
  const auto counted = warp_impostor(main, eye, with, scratch.main, result);
  if (!counted) return warp_impostor(other, eye, options, scratch.other, result);
  if (!both) return counted;
  // From beyond both, the farther one only adds what the nearer one does not know.
  const bool between =
      glm::dot(one.geometry.capture.position() - eye, two.geometry.capture.position() - eye) < 0;
  merge_warps(result, scratch.main.flags, scratch.board, scratch.other.flags,
              between ? near / (near + far) : 0.0, scratch.texels, options.parallel);
  return counted;
}

}  // namespace rilievo
