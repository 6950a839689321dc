#include "rilievo/environment_nodes/cube_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kMaxSize = 4096;
// Metres. Disparities, and sums of some of them, are finite as floats: errors that are not never
// fall below what is allowed, and refinement would not end.
constexpr double kLeastEyeZ = 1e-30;

// Four disparities along a line of texels, outer ones absent (kNothing) where there is no neighbour
// on the line; is there a jump between the middle ones? `texel` is 2 / n, a texel's width at depth
// 1.
bool is_jump(float before, float a, float b, float after, float texel, const CutOptions& options) {
  if (a < 0 || b < 0) return (a < 0) != (b < 0);
  const float step = b - a, size = std::abs(step);
  if (size <= options.least_step) return false;
  const float least = std::min(a, b);
  // (z_far - z_near) / (z_near texel) = (a / b - 1) / texel.
  if (size <= options.gentle * texel * least) return false;
  const float sign = step < 0 ? -1.0f : 1.0f;
  float beside = 0;
  if (before >= 0) beside = std::max(beside, sign * (a - before));
  if (after >= 0) beside = std::max(beside, sign * (after - b));
  const float growth =
      size <= options.steepest * texel * least ? options.growth : options.even_growth;
  return size > growth * beside;
}

}  // namespace

const std::array<FaceAxes, 6>& face_axes() {
  static const std::array<FaceAxes, 6> axes = [] {
    std::array<FaceAxes, 6> made;
    const std::array<Camera, 6> cameras = environment_cameras(glm::dvec3(0), 2, 1, 2);
    for (int f = 0; f < 6; ++f) {
      const glm::dmat4& m = cameras[std::size_t(f)].world_from_eye;
      made[std::size_t(f)] = {glm::ivec3(-glm::dvec3(m[2])), glm::ivec3(glm::dvec3(m[0])),
                              glm::ivec3(glm::dvec3(m[1]))};
    }
    return made;
  }();
  return axes;
}

Result<> validate_environment(const EnvironmentMap& map) {
  const Camera& first = map.faces[0].camera;
  const int n = first.width;
  if (n < 2 || n > kMaxSize)
    return Error{"node", "its faces are " + std::to_string(n) + " texels wide, not 2 to " +
                             std::to_string(kMaxSize)};
  const glm::dmat4 pose = world_from_node(map);
  for (int f = 0; f < 6; ++f) {
    const DepthImage& face = map.faces[std::size_t(f)];
    const std::string name = "face " + std::to_string(f) + " of 6";
    if (Result<> valid = validate(face); !valid) return Error{name, valid.error().reason};
    const Camera& c = face.camera;
    if (c.width != n || c.height != n)
      return Error{name, "is " + std::to_string(c.width) + " x " + std::to_string(c.height) +
                             " texels, but the first is " + std::to_string(n) +
                             " wide; all must "
                             "be square and alike"};
    if (c.projection != Projection::perspective) return Error{name, "is not a perspective picture"};
    const ImageWindow& w = c.window;
    for (const double side : {-w.left, w.right, -w.bottom, w.top})
      if (std::abs(side - 1) > 1e-4) return Error{name, "is not 90 degrees wide and high"};
    const FaceAxes& axes = face_axes()[std::size_t(f)];
    const glm::dvec3 expected[] = {glm::dvec3(axes.right), glm::dvec3(axes.up),
                                   -glm::dvec3(axes.forward)};
    for (int k = 0; k < 3; ++k)
      if (glm::distance(glm::dmat3(pose) * expected[k], glm::dvec3(c.world_from_eye[k])) > 1e-3)
        return Error{name,
                     "does not look where it should: the order is +x -x +y -y +z -z, turned "
                     "as OpenGL's cube maps are"};
    const double reach = 1e-4 * std::max(1.0, c.z_near) + 1e-9 * glm::length(c.position());
    if (glm::distance(c.position(), first.position()) > reach)
      return Error{name, "was taken from another point than the first"};
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const float depth = face.depth(x, y);
        if (!(depth > 0)) return Error{name, "has a depth that is not positive"};
        const double eye_z = face.depth_kind == DepthKind::eye_z
                                 ? double(depth)
                                 : eye_z_from(face.depth_kind, depth, c, {x + 0.5, y + 0.5});
        if (std::abs(eye_z) < kLeastEyeZ)
          return Error{name, "has a depth that is too small to be that of a surface"};
      }
  }
  return Done{};
}

glm::dmat4 world_from_node(const EnvironmentMap& map) {
  const FaceAxes& axes = face_axes()[0];
  const glm::dmat4& world_from_eye = map.faces[0].camera.world_from_eye;
  const glm::dmat3 node_from_eye(glm::dvec3(axes.right), glm::dvec3(axes.up),
                                 -glm::dvec3(axes.forward));
  glm::dmat4 pose(glm::dmat3(world_from_eye) * glm::transpose(node_from_eye));
  pose[3] = world_from_eye[3];
  return pose;
}

Image<float> face_disparity(const DepthImage& face) {
  Image<float> disparity(face.camera.width, face.camera.height);
  parallel_for(0, face.camera.height, [&](int y) {
    for (int x = 0; x < face.camera.width; ++x) {
      float& out = disparity(x, y);
      const float depth = face.depth(x, y);
      if (depth == kNoDepth)
        out = face.color(x, y).a > 0 ? 0.0f : kNothing;
      else if (face.depth_kind == DepthKind::eye_z)
        out = 1.0f / depth;
      else
        out = float(1.0 /
                    eye_z_from(face.depth_kind, depth, face.camera, {double(x) + 0.5, y + 0.5}));
    }
  });
  return disparity;
}

CubeGrid::CubeGrid(const EnvironmentMap& map, const CutOptions& options)
    : size_(map.faces[0].camera.width), options_(options) {
  for (std::size_t f = 0; f < 6; ++f) {
    disparity_[f] = face_disparity(map.faces[f]);
    cuts_[f] = Image<std::uint8_t>(size_, size_);
    for (std::size_t s = 0; s < 4; ++s) border_[f][s].resize(std::size_t(size_));
  }
  find_cuts();
  find_border_cuts();
}

void CubeGrid::find_cuts() {
  const float texel = 2.0f / float(size_);
  parallel_for(0, 6 * size_, [&](int i) {
    const std::size_t f = std::size_t(i / size_);
    const int y = i % size_;
    const Image<float>& d = disparity_[f];
    const auto row = [&](int k) { return d.row(std::clamp(k, 0, size_ - 1)); };
    const auto here = row(y), above = row(y - 1), below = row(y + 1), next = row(y + 2);
    for (int x = 0; x < size_; ++x) {
      const std::size_t k = std::size_t(x);
      std::uint8_t cut = 0;
      // Nearly all gates are flat: one comparison.
      if (x + 1 < size_) {
        const float before = x > 0 ? here[k - 1] : kNothing;
        const float after = x + 2 < size_ ? here[k + 2] : kNothing;
        cut = is_jump(before, here[k], here[k + 1], after, texel, options_);
      }
      if (y + 1 < size_) {
        const float before = y > 0 ? above[k] : kNothing;
        const float after = y + 2 < size_ ? next[k] : kNothing;
        if (is_jump(before, here[k], below[k], after, texel, options_)) cut |= 2;
      }
      cuts_[f](x, y) = cut;
    }
  });
}

void CubeGrid::find_border_cuts() {
  const float texel = 2.0f / float(size_);
  // The texel behind a border texel, away from the border.
  const auto behind = [&](const SideTexel& t) {
    const glm::ivec2 inwards[] = {{0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    return side_texel(t.side, t.along) + inwards[t.side];
  };
  for (int f = 0; f < 6; ++f)
    for (int side = 0; side < 4; ++side)
      for (int k = 0; k < size_; ++k) {
        const SideTexel a{f, side, k}, b = across(a);
        const bool jump = is_jump(at(f, behind(a)), at(f, side_texel(side, k)),
                                  at(b.face, side_texel(b.side, b.along)), at(b.face, behind(b)),
                                  texel, options_);
        border_[std::size_t(f)][std::size_t(side)][std::size_t(k)] = jump;
      }
}

CubeGrid::Diagonal CubeGrid::joined_diagonal(int face, const glm::ivec2& corner) const {
  const int x = corner.x - 1, y = corner.y - 1;
  if (x < 0 || y < 0 || x + 1 >= size_ || y + 1 >= size_) return Diagonal::none;
  if (!cut_right(face, x, y) || !cut_right(face, x, y + 1) || !cut_below(face, x, y) ||
      !cut_below(face, x + 1, y))
    return Diagonal::none;
  const Image<float>& d = disparity_[std::size_t(face)];
  const float a = d(x, y), b = d(x + 1, y + 1), c = d(x + 1, y), e = d(x, y + 1);
  // Of slopes that never separate; the centres are a diagonal apart.
  const auto joined = [&](float one, float two, float others) {
    const float least = std::min(one, two), steepest = 1.4142f * options_.gentle * 2 / float(size_);
    return least > std::max(others, 0.0f) &&
           std::abs(one - two) <= std::max(options_.least_step, steepest * least);
  };
  if (joined(a, b, std::max(c, e))) return Diagonal::down_right;
  return joined(c, e, std::max(a, b)) ? Diagonal::down_left : Diagonal::none;
}

glm::ivec3 CubeGrid::key(int face, const glm::ivec2& half) const {
  const FaceAxes& a = face_axes()[std::size_t(face)];
  return size_ * a.forward + (half.x - size_) * a.right + (size_ - half.y) * a.up;
}

glm::ivec2 CubeGrid::half(int face, const glm::ivec3& key) const {
  const FaceAxes& a = face_axes()[std::size_t(face)];
  const auto along = [&](const glm::ivec3& v) { return v.x * key.x + v.y * key.y + v.z * key.z; };
  return {size_ + along(a.right), size_ - along(a.up)};
}

glm::ivec2 CubeGrid::side_texel(int side, int along) const {
  const int last = size_ - 1;
  const glm::ivec2 places[] = {{along, 0}, {last, along}, {along, last}, {0, along}};
  return places[side];
}

glm::ivec2 CubeGrid::side_corner(int side, int along) const {
  const int i = 2 * along, end = 2 * size_;
  const glm::ivec2 places[] = {{i, 0}, {end, i}, {i, end}, {0, i}};
  return places[side];
}

SideTexel CubeGrid::across(const SideTexel& t) const {
  // The middle of the texel's outer edge, seen from the other face on which it lies.
  const glm::ivec2 start = side_corner(t.side, t.along);
  const glm::ivec3 middle =
      key(t.face, start + ((t.side & 1) ? glm::ivec2(0, 1) : glm::ivec2(1, 0)));
  for (int f = 0; f < 6; ++f) {
    if (f == t.face) continue;
    const glm::ivec3& forward = face_axes()[std::size_t(f)].forward;
    if (middle.x * forward.x + middle.y * forward.y + middle.z * forward.z != size_) continue;
    const glm::ivec2 there = half(f, middle);
    if (there.y == 0) return {f, 0, there.x / 2};
    if (there.x == 2 * size_) return {f, 1, there.y / 2};
    if (there.y == 2 * size_) return {f, 2, there.x / 2};
    return {f, 3, there.y / 2};
  }
  return t;  // not on a cube
}

float CubeGrid::continued(int face, const glm::ivec2& texel, const glm::ivec2& half) const {
  const float d = at(face, texel);
  if (d <= 0) return d;
  const int x = texel.x, y = texel.y;
  const auto slope = [](bool low, bool high, float low_step, float high_step) {
    if (low && high) return 0.5f * (low_step + high_step);
    return low ? low_step : high ? high_step : 0.0f;
  };
  const bool left = x > 0 && !cut_right(face, x - 1, y),
             right = x + 1 < size_ && !cut_right(face, x, y);
  const bool up = y > 0 && !cut_below(face, x, y - 1),
             down = y + 1 < size_ && !cut_below(face, x, y);
  const float gx =
      slope(left, right, left ? d - at(face, {x - 1, y}) : 0, right ? at(face, {x + 1, y}) - d : 0);
  const float gy =
      slope(up, down, up ? d - at(face, {x, y - 1}) : 0, down ? at(face, {x, y + 1}) - d : 0);
  const float value = d + 0.5f * (gx * float(half.x - 2 * x - 1) + gy * float(half.y - 2 * y - 1));
  return std::clamp(value, 0.5f * d, 2.0f * d);
}

}  // namespace rilievo
