// Where a nailboard is in the frame. Let a point of its polygon, relative to the frame's eye, be
//
//   P(u, v) = c + u a + v b,      u, v: texels from the picture's upper left corner
//
// and R the linear map of a point to (x W, y W, W): pixels, and W = eye_z in the frame. Then
//
//   (x W, y W, W) = M (u, v, 1),  M = (R a, R b, R c)
//   (u, v, 1) / W = M^-1 (x, y, 1)                                                          (1)
//
// so that the last row of M^-1 gives 1 / W of the polygon, which is affine over the screen, and one
// division the texel. The depth of what the texel shows is that of
// nailboard/gl/nailboard_shaders.cpp with 1 instead of clip_z: with q affine in Delta and e = W of
// the capturing eye,
//
//   1 / eye_z = q / (q e + W - e)                                                            (2)
//
// Linear depth: on the line of sight through P, the point on the capturing camera's plane of eye_z
// z is s P with s = (z + A.E) / A.P, where A is the camera's -z and E its eye; A.P = plane_z + A.E
// is the same for all of the polygon. So 1 / eye_z of the two ends is (plane_z + A.E) / (z + A.E) /
// W, and eq. (4) of [Schaufler 1997], window_z affine in Delta between them, is 1 / eye_z affine in
// it.
#include "rilievo/nailboard/software/nailboard_composer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// (x W, y W, W) of a point or a direction in the camera's eye space.
glm::dvec3 raster_times_w(const Camera& frame, const glm::dvec3& eye_space) {
  const auto& [left, right, bottom, top] = frame.window;
  const double w = -eye_space.z;
  return {(eye_space.x - left * w) / (right - left) * frame.width,
          (top * w - eye_space.y) / (top - bottom) * frame.height, w};
}

void place_one(const Camera& frame, const glm::dmat4& eye_from_world, DepthMode mode,
               const SoftwareNailboardInstance& in, PlacedNailboard& out, double& distance) {
  const PictureGeometry& geometry = in.geometry;
  const Camera& capture = geometry.capture;
  RILIEVO_EXPECTS_EQ(in.picture->width(), capture.width);
  RILIEVO_EXPECTS_EQ(in.picture->height(), capture.height);
  out.picture = in.picture;
  out.x1 = 0;  // not in view
  // Relative to the frame's eye before anything is rounded.
  const glm::dmat4& motion = in.world_now_from_capture;
  const glm::dmat3 turn(eye_from_world);
  const auto point = [&](const glm::dvec3& p) {
    return turn * (glm::dvec3(motion * glm::dvec4(p, 1)) - frame.position());
  };
  const double w = capture.width, h = capture.height, plane = geometry.plane_z;
  const glm::dvec3 c = point(world_from_raster(capture, {0, 0}, plane));
  const glm::dvec3 a = (point(world_from_raster(capture, {w, 0}, plane)) - c) / w;
  const glm::dvec3 b = (point(world_from_raster(capture, {0, h}, plane)) - c) / h;
  const glm::dvec3 eye = point(capture.position());
  const glm::dvec3 axis = turn * (glm::dmat3(motion) * capture.forward());
  const glm::dvec3 middle = eye + plane * axis;
  distance = glm::dot(middle, middle);

  const glm::dmat3 m(raster_times_w(frame, a), raster_times_w(frame, b), raster_times_w(frame, c));
  out.texel_from_raster = glm::inverse(m);
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(glm::dot(out.texel_from_raster[k], glm::dvec3(1)))) return;  // edge-on

  // The rectangle; the whole frame if the polygon reaches behind the near plane.
  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30, near_w = 1e300, far_w = -1e300;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 corner = m * glm::dvec3((i & 1) * w, (i >> 1) * h, 1);
    near_w = std::min(near_w, corner.z), far_w = std::max(far_w, corner.z);
    x0 = std::min(x0, corner.x / corner.z), x1 = std::max(x1, corner.x / corner.z);
    y0 = std::min(y0, corner.y / corner.z), y1 = std::max(y1, corner.y / corner.z);
  }
  if (far_w <= frame.z_near || near_w >= frame.z_far) return;
  if (near_w < frame.z_near) {
    x0 = y0 = 0, x1 = frame.width, y1 = frame.height;
    near_w = frame.z_near;
  }
  const double limit_x = frame.width, limit_y = frame.height;
  x0 = std::clamp(std::floor(x0), 0.0, limit_x), x1 = std::clamp(std::ceil(x1), 0.0, limit_x);
  y0 = std::clamp(std::floor(y0), 0.0, limit_y), y1 = std::clamp(std::ceil(y1), 0.0, limit_y);
  if (x0 >= x1 || y0 >= y1) return;

  const double steps = in.picture->steps(), code = in.picture->nearest();
  if (code > steps) return;  // empty
  const double z_near = capture.z_near, z_far = capture.z_far;
  double first = 1, last = 1;  // q at Delta 0 and 1: flat
  out.exact = mode == DepthMode::exact;
  out.eye_z = float(-eye.z);
  if (mode == DepthMode::exact) {
    first = plane / z_near, last = plane / z_far;
  } else if (mode == DepthMode::linear) {
    const double e = glm::dot(axis, eye);
    first = (plane + e) / (z_near + e), last = (plane + e) / (z_far + e);
  }
  out.q_first = float(first), out.q_per_code = float((last - first) / steps);
  // Largest where the polygon is nearest, if (2) decreases with W and increases with q.
  const double q = first + (last - first) / steps * code;
  const double below = out.exact ? q * -eye.z + near_w + eye.z : near_w;
  const bool bounded = q > 0 && below > 0 && (!out.exact || near_w + eye.z > 0);
  out.nearest = bounded ? float(q / below * 1.0001) : std::numeric_limits<float>::infinity();
  out.inverse_near = float(1 / frame.z_near);
  out.share_from = in.share_from, out.share_to = in.share_to;
  out.object = in.object;
  out.x0 = int(x0), out.y0 = int(y0), out.x1 = int(x1), out.y1 = int(y1);
}

}  // namespace

void place_outlines(const Camera& frame, std::span<const SoftwareNailboardInstance> instances,
                    LineTiles& lines) {
  lines.begin(frame);
  for (const SoftwareNailboardInstance& one : instances) {
    const Camera& capture = one.geometry.capture;
    const double w = capture.width, h = capture.height;
    glm::dvec3 corners[4];
    const glm::dvec2 at[] = {{0, 0}, {w, 0}, {w, h}, {0, h}};
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 p = world_from_raster(capture, at[k], one.geometry.plane_z);
      corners[k] = glm::dvec3(one.world_now_from_capture * glm::dvec4(p, 1));
    }
    lines.add_loop(corners);
  }
}

void NailboardComposer::place(const Camera& frame, DepthMode mode,
                              std::span<const SoftwareNailboardInstance> instances) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  const glm::dmat4 eye_from = eye_from_world(frame);
  placed_.resize(instances.size());
  order_.resize(instances.size());
  constexpr std::size_t kPiece = 64;
  parallel_for(std::size_t(0), (instances.size() + kPiece - 1) / kPiece, [&](std::size_t piece) {
    const std::size_t end = std::min(instances.size(), (piece + 1) * kPiece);
    for (std::size_t i = piece * kPiece; i < end; ++i) {
      order_[i].index = std::uint32_t(i);
      place_one(frame, eye_from, mode, instances[i], placed_[i], order_[i].distance);
      placed_[i].nearest_coverage = rounding_ == SampleRounding::nearest;
    }
  });
  std::erase_if(order_, [&](const Key& key) { return placed_[key.index].x1 == 0; });
  std::sort(order_.begin(), order_.end(), [](const Key& a, const Key& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  });

  // A list for each tile: counted, then filled.
  constexpr int kSize = FrameTile::kSize;
  tiles_across_ = (frame.width + kSize - 1) / kSize;
  tiles_down_ = (frame.height + kSize - 1) / kSize;
  const auto each_tile = [&](const PlacedNailboard& p, const auto& visit) {
    for (int y = p.y0 / kSize; y <= (p.y1 - 1) / kSize; ++y)
      for (int x = p.x0 / kSize; x <= (p.x1 - 1) / kSize; ++x)
        visit(std::size_t(y) * std::size_t(tiles_across_) + std::size_t(x));
  };
  // Entry t + 2 counts tile t; summed up, entry t + 1 is where it begins, and filled, where it
  // ends.
  first_.assign(std::size_t(tiles_across_) * std::size_t(tiles_down_) + 2, 0);
  placed_pixels_ = 0;
  for (const Key& key : order_) {
    const PlacedNailboard& p = placed_[key.index];
    each_tile(p, [&](std::size_t tile) { ++first_[tile + 2]; });
    placed_pixels_ += std::uint64_t(p.x1 - p.x0) * std::uint64_t(p.y1 - p.y0);
  }
  for (std::size_t t = 2; t < first_.size(); ++t) first_[t] += first_[t - 1];
  listed_.resize(first_.back());
  drawn_blocks_.assign(listed_.size(), 0);
  for (const Key& key : order_)
    each_tile(placed_[key.index],
              [&](std::size_t tile) { listed_[first_[tile + 1]++] = key.index; });
}

void NailboardComposer::draw_tile(FrameTile& tile) const {
  const int x = tile.x / FrameTile::kSize, y = tile.y / FrameTile::kSize;
  if (x >= tiles_across_ || y >= tiles_down_) return;
  const std::size_t t = std::size_t(y) * std::size_t(tiles_across_) + std::size_t(x);
  const std::size_t first = first_[t], count = first_[t + 1] - first;
  compose_tile(placed_, std::span(listed_).subspan(first, count),
               std::span(drawn_blocks_).subspan(first, count), tile);
}

void NailboardComposer::find_seen_shares(std::vector<float>& shares) const {
  shares.assign(placed_.size(), 0.0f);
  for (std::size_t i = 0; i < listed_.size(); ++i) shares[listed_[i]] += float(drawn_blocks_[i]);
  const auto blocks_of = [](int from, int to) {
    return (to - 1) / FrameTile::kBlock - from / FrameTile::kBlock + 1;
  };
  for (std::size_t i = 0; i < placed_.size(); ++i)
    if (const PlacedNailboard& p = placed_[i]; shares[i] > 0)
      shares[i] /= float(blocks_of(p.x0, p.x1) * blocks_of(p.y0, p.y1));
}

}  // namespace rilievo
