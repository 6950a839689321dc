// A vertex is homogeneous (c, d), c / d from the node (node_mesh.h), and so is (x w, y w, w), its
// place in the frame: nothing is infinite where d = 0. Its eye_z is w / d. Texture directions t are
// interpolated with perspective correction by that w (gl/node_shaders.cpp): at pixel p = (x, y, 1)
//
//   sum b_i t_i,   b = (m_0, m_1, m_2)^-1 p,   m_i = (x w, y w, w) of corner i
//
// up to a factor, which does not change a direction.
//
// The rasteriser's depth is kSkyDepth - nearest / eye_z, just below 1 for the sky, so that it is
// drawn.
#include "rilievo/environment_nodes/software/node_layer.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

// Nodes are drawn from the eye; nearer than this share of the frame's near plane is nothing.
constexpr double kNearShare = 0.25;
// Triangles are cut so many frames beside the frame, where single precision would not suffice.
constexpr double kGuard = 8;
// The least w of corners by which is divided.
constexpr double kInFront = 1e-30;

using ClipCorner = NodeLayer::ClipCorner;

// How far inside of plane 0 to 4 is the corner?
double inside(const ClipCorner& c, int plane, double nearest, const glm::dvec2& size) {
  const double w = c.raster.z;
  const glm::dvec2 at = 2.0 * glm::dvec2(c.raster) / size - w;  // -w to w in the frame
  switch (plane) {
    case 0:
      return w - nearest * c.disparity;
    case 1:
      return kGuard * w - at.x;
    case 2:
      return kGuard * w + at.x;
    case 3:
      return kGuard * w - at.y;
    default:
      return kGuard * w + at.y;
  }
}

// [Sutherland and Hodgman 1974]; returns the number of corners.
int cut(ClipCorner (&polygon)[9], double nearest, const glm::dvec2& size) {
  bool whole = true;
  for (int plane = 0; plane < 5; ++plane)
    for (int k = 0; k < 3; ++k) whole = whole && inside(polygon[k], plane, nearest, size) >= 0;
  if (whole) return 3;  // as nearly all are
  int count = 3;
  for (int plane = 0; plane < 5 && count >= 3; ++plane) {
    ClipCorner out[9];
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const ClipCorner &a = polygon[i], &b = polygon[(i + 1) % count];
      const double at_a = inside(a, plane, nearest, size), at_b = inside(b, plane, nearest, size);
      if (at_a >= 0) out[kept++] = a;
      if ((at_a >= 0) == (at_b >= 0)) continue;
      // From the corner inside, so that two triangles that share the edge get the same corner.
      const bool forward = at_a >= 0;
      const ClipCorner &in = forward ? a : b, &beyond = forward ? b : a;
      const double from = forward ? at_a : at_b, to = forward ? at_b : at_a;
      const double share = from / (from - to);
      out[kept++] = {glm::mix(in.raster, beyond.raster, share),
                     glm::mix(in.disparity, beyond.disparity, share)};
    }
    std::copy_n(out, kept, polygon);
    count = kept;
  }
  return count;
}

// Do the bounds of corners touch any of the blocks?
bool touches(const FrameBlocks& blocks, std::span<const ClipCorner> corners,
             const glm::dvec2& size) {
  glm::dvec2 low(INFINITY), high(-INFINITY);
  for (const ClipCorner& c : corners) {
    const double w = std::max(c.raster.z, kInFront);
    const glm::dvec2 at(c.raster.x / w, size.y - c.raster.y / w);
    low = glm::min(low, at), high = glm::max(high, at);
  }
  if (!(low.x < size.x && low.y < size.y && high.x >= 0 && high.y >= 0)) return false;
  const glm::ivec2 from(glm::max(low, 0.0)), to(glm::min(high, size - 1.0));
  return blocks.any(from.x, from.y, to.x, to.y);
}

}  // namespace

void NodeLayer::begin(const Camera& frame, int samples, std::span<const DrawnNode> nodes) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  width_ = frame.width, height_ = frame.height, samples_ = samples;
  nearest_ = kNearShare * frame.z_near;
  nodes_.clear();
  for (Soup* soup : {&surfaces_, &skins_, &doubtful_}) {
    soup->positions.clear(), soup->indices.clear(), soup->node.clear(), soup->triangle.clear();
    soup->face.clear(), soup->instances.clear();
  }
  for (const DrawnNode& drawn : nodes) {
    const glm::dmat4 clip = glm::transpose(clip_from_node(drawn.node->mesh, frame));
    nodes_.push_back({drawn, 0.5 * width_ * (clip[0] + clip[3]),
                      0.5 * height_ * (clip[1] + clip[3]), clip[3],
                      visible_faces(drawn.node->mesh, drawn.node->reaches, frame),
                      glm::distance(frame.position(), drawn.node->eye())});
  }
  corners_.clear();
  for (Placed& placed : nodes_) {
    placed.first_corner = corners_.size();
    for (const NodeVertex& v : placed.drawn.node->mesh.vertices) {
      const glm::dvec4 p(v.direction, v.disparity);
      corners_.emplace_back(glm::dot(placed.row_x, p), glm::dot(placed.row_y, p),
                            glm::dot(placed.row_w, p));
    }
  }
}

void NodeLayer::place(const Camera& frame, int samples, std::span<const DrawnNode> nodes) {
  begin(frame, samples, nodes);
  only_ = nullptr;
  add(Part::surfaces, surfaces_, nullptr);
  add(Part::skins, skins_, nullptr);
  add(Part::doubtful, doubtful_, nullptr);
  for (Soup* soup : {&surfaces_, &skins_}) rasterize(*soup, width_, height_, samples_);
  rasterize_doubtful(nullptr);
  find_triangles();
}

void NodeLayer::place_surfaces(const Camera& frame, std::span<const DrawnNode> nodes,
                               const FrameBlocks* only) {
  begin(frame, 1, nodes);
  only_ = only;
  add(Part::surfaces, surfaces_, only);
  rasterize(surfaces_, width_, height_, 1);
}

void NodeLayer::place_skins(const FrameBlocks& gaps) {
  if (gaps.share() > 0) {
    add(Part::skins, skins_, &gaps);
    add(Part::doubtful, doubtful_, &gaps);
    rasterize(skins_, width_, height_, 1);
    rasterize_doubtful(&gaps);
  }
  find_triangles();
}

// Of equal depths OpenGL shows the last, the rasteriser the first.
void NodeLayer::add(Part part, Soup& soup, const FrameBlocks* only) {
  for (std::size_t i = nodes_.size(); i-- > 0;) add(std::uint32_t(i), part, soup, only);
}

void NodeLayer::add(std::uint32_t node, Part part, Soup& soup, const FrameBlocks* only) {
  const NodeMesh& mesh = nodes_[node].drawn.node->mesh;
  const std::array<bool, 6>& visible = nodes_[node].visible;
  const glm::dvec3* const corners = &corners_[nodes_[node].first_corner];
  const glm::dvec2 size(width_, height_);
  RasterInstance instance;
  instance.first_triangle = std::uint32_t(soup.triangle.size());
  instance.row_x = {1, 0, 0, 0}, instance.row_y = {0, 1, 0, 0};
  instance.row_z = {0, 0, 1, 0}, instance.row_w = {0, 0, 0, 1};
  instance.front = true, instance.back = part != Part::surfaces || !nodes_[node].drawn.front_only;
  for (std::size_t f = 6; f-- > 0;) {
    if (!visible[f]) continue;
    const TriangleRange& range = part == Part::surfaces ? mesh.surfaces[f] : mesh.skins[f];
    for (std::uint32_t t = range.first + range.count; t-- > range.first;) {
      ClipCorner polygon[9];
      int outside = 0x1f;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.indices[3 * std::size_t(t) + std::size_t(k)];
        polygon[k] = {corners[v], double(mesh.vertices[v].disparity)};
        const glm::dvec3& c = corners[v];
        outside &= int(c.x < 0 && c.z > 0) | int(c.x > size.x * c.z && c.z > 0) << 1 |
                   int(c.y < 0 && c.z > 0) << 2 | int(c.y > size.y * c.z && c.z > 0) << 3 |
                   int(c.z <= 0) << 4;
      }
      if (outside) continue;
      // In front of the eye a triangle that is cut lies within the bounds of the whole one.
      const bool in_front = polygon[0].raster.z > kInFront && polygon[1].raster.z > kInFront &&
                            polygon[2].raster.z > kInFront;
      if (only && in_front && !touches(*only, {polygon, 3}, size)) continue;
      const int count = cut(polygon, nearest_, size);
      if (only && !in_front && !touches(*only, {polygon, std::size_t(std::max(count, 0))}, size))
        continue;
      if (part != Part::surfaces &&
          narrowness(nodes_[node], t, {polygon, std::size_t(std::max(count, 0))}) !=
              (part == Part::skins ? 2 : 1))
        continue;
      const auto first = std::uint32_t(soup.positions.size());
      for (int k = 0; k < count; ++k) {
        const ClipCorner& c = polygon[k];
        const double w = std::max(c.raster.z, kInFront);
        soup.positions.emplace_back(c.raster.x / w, c.raster.y / w,
                                    double(kSkyDepth) - nearest_ * std::max(c.disparity / w, 0.0));
      }
      for (int k = 2; k < count; ++k) {
        soup.indices.insert(soup.indices.end(),
                            {first, first + std::uint32_t(k) - 1, first + std::uint32_t(k)});
        soup.node.push_back(node);
        soup.triangle.push_back(t);
        soup.face.push_back(std::uint8_t(f));
      }
    }
  }
  instance.triangles = std::uint32_t(soup.triangle.size()) - instance.first_triangle;
  soup.instances.push_back(instance);
}

void NodeLayer::rasterize(Soup& soup, int width, int height, int samples) {
  if (soup.triangle.empty()) return;
  soup.raster.begin(width, height, samples);
  for (RasterInstance& instance : soup.instances) {
    instance.positions = soup.positions.data();
    instance.indices = soup.indices.data() + 3 * std::size_t(instance.first_triangle);
  }
  soup.raster.draw(soup.instances);
}

// One triangle after the other, by bands of rows.
void NodeLayer::rasterize_doubtful(const FrameBlocks* gaps) {
  const Soup& soup = doubtful_;
  if (soup.triangle.empty()) return;
  doubtful_seen_.begin(width_, height_, samples_);
  doubtful_edges_.clear();
  for (std::size_t t = 0; t < soup.triangle.size(); ++t) {
    const std::uint32_t* corner = &soup.indices[3 * t];
    doubtful_edges_.push_back({CornerEdges(soup.positions[corner[0]], soup.positions[corner[1]],
                                           soup.positions[corner[2]]),
                               skin_width(nodes_[soup.node[t]], soup.triangle[t])});
  }
  const std::span<const DoubtfulSkin> skins(doubtful_edges_);
  constexpr int kBand = 16;
  parallel_for(0, (height_ + kBand - 1) / kBand, [&](int band) {
    const int low = band * kBand, high = std::min(low + kBand, height_);
    for (std::uint32_t t = 0; t < skins.size(); ++t) {
      const CornerEdges& triangle = skins[t].edges;
      if (triangle.y1 <= low || triangle.y0 >= high) continue;
      for (int y = std::max(low, triangle.y0); y < std::min(high, triangle.y1); ++y) {
        int x0 = std::max(0, triangle.x0), x1 = std::min(width_, triangle.x1);
        triangle.narrow_row(y, x0, x1);
        for (int x = x0; x < x1; ++x) {
          if (gaps && !gaps->holds(x, height_ - 1 - y)) {
            x |= FrameBlocks::kBlock - 1;
            continue;
          }
          bool asked = false, narrow = false;
          for (int s = 0; s < samples_; ++s) {
            const glm::vec2 at = glm::vec2(x, y) + sample_position(s, samples_);
            if (!triangle.covers(at)) continue;
            const std::size_t i =
                doubtful_seen_.row(y) + std::size_t(x) * std::size_t(samples_) + std::size_t(s);
            const float depth = triangle.depth(at);
            if (!(depth < doubtful_seen_.depth[i])) continue;
            if (!asked) narrow = skins[t].width.is_narrow(x, y);
            asked = true;
            if (!narrow) break;
            doubtful_seen_.depth[i] = depth;
            doubtful_seen_.triangle[i] = t;
          }
        }
      }
    }
  });
}

NodeLayer::Weights NodeLayer::weights(const Placed& placed, std::uint32_t triangle) const {
  const NodeMesh& mesh = placed.drawn.node->mesh;
  glm::dvec3 m[3];
  for (int k = 0; k < 3; ++k) {
    const NodeVertex& v = mesh.vertices[mesh.indices[3 * std::size_t(triangle) + std::size_t(k)]];
    const glm::dvec4 p(v.direction, v.disparity);
    m[k] = {glm::dot(placed.row_x, p), glm::dot(placed.row_y, p), glm::dot(placed.row_w, p)};
  }
  Weights out{{glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])}};
  if (glm::dot(m[0], out.of[0]) < 0)
    for (glm::dvec3& of : out.of) of = -of;
  return out;
}

// Weights are taken at a corner, from which those of the triangle's pixels differ by little: in
// single precision the differences lose nothing.
NodeTriangle NodeLayer::triangle_of(const Soup& soup, std::size_t triangle) const {
  const Placed& placed = nodes_[soup.node[triangle]];
  const NodeMesh& mesh = placed.drawn.node->mesh;
  const std::uint32_t number = soup.triangle[triangle];
  const Weights w = weights(placed, number);
  glm::dvec3 at(0.0), per_x(0.0), per_y(0.0);
  const glm::dvec3 corner(soup.positions[soup.indices[3 * triangle]]);
  const glm::dvec2 from(std::clamp(std::floor(corner.x), 0.0, double(width_)) + 0.5,
                        std::clamp(std::floor(corner.y), 0.0, double(height_)) + 0.5);
  // The face's coordinates of a direction, as affine ones: texels, and a border of one.
  const FaceAxes& axes = face_axes()[soup.face[triangle]];
  const double half = 0.5 * mesh.face_size, middle = half + 0.5;
  const glm::dvec3 forward(axes.forward), right = half * glm::dvec3(axes.right) + middle * forward,
                                          down = middle * forward - half * glm::dvec3(axes.up);
  double length = 0;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 direction(
        mesh.vertices[mesh.indices[3 * std::size_t(number) + std::size_t(k)]].texture);
    const glm::dvec3 texture(glm::dot(right, direction), glm::dot(down, direction),
                             glm::dot(forward, direction));
    at += glm::dot(w.of[k], glm::dvec3(from, 1)) * texture;
    per_x += w.of[k].x * texture, per_y += w.of[k].y * texture;
    length += std::abs(w.of[k].x) + std::abs(w.of[k].y) + std::abs(w.of[k].z);
  }
  // Nothing underflows; the length does not matter.
  const double scale = length > 0 ? 1 / length : 0;
  NodeTriangle out;
  out.at = glm::vec3(scale * at);
  out.per_x = glm::vec3(scale * per_x), out.per_y = glm::vec3(-scale * per_y);
  out.x = float(from.x), out.y = float(height_ - from.y);
  out.face = soup.face[triangle];
  out.node = soup.node[triangle];
  return out;
}

void NodeLayer::find_triangles() {
  triangles_.resize(surfaces_.triangle.size() + skins_.triangle.size() + doubtful_.triangle.size());
  NodeTriangle* to = triangles_.data();
  constexpr std::size_t kPiece = 1024;
  for (const Soup* soup : {&surfaces_, &skins_, &doubtful_}) {
    const std::size_t count = soup->triangle.size();
    parallel_for(std::size_t(0), (count + kPiece - 1) / kPiece, [&](std::size_t piece) {
      for (std::size_t t = piece * kPiece; t < std::min(count, (piece + 1) * kPiece); ++t)
        to[t] = triangle_of(*soup, t);
    });
    to += count;
  }
}

NodeLayer::SkinWidth NodeLayer::skin_width(const Placed& placed, std::uint32_t triangle) const {
  const NodeMesh& mesh = placed.drawn.node->mesh;
  const Weights w = weights(placed, triangle);
  SkinWidth width;
  width.widest = double(placed.drawn.widest_skin);
  for (int k = 0; k < 3; ++k) {
    width.stretch +=
        double(mesh.vertices[mesh.indices[3 * std::size_t(triangle) + std::size_t(k)]].stretch) *
        w.of[k];
    width.weight += w.of[k];
  }
  return width;
}

// The rate at which the stretch s / w changes over the frame tells the width. OpenGL's derivatives
// are differences between the pixels of a square of 2 x 2, from even ones on. Without divisions:
//
//   |s1 / w1 - s0 / w0| = |s1 w0 - s0 w1| / |w0 w1|
bool NodeLayer::SkinWidth::is_narrow(double x, double y) const {
  const double px = x + 0.5, py = y + 0.5;
  const double s = stretch.x * px + stretch.y * py + stretch.z,
               w = weight.x * px + weight.y * py + weight.z;
  if (!(s * w >= 0)) return true;
  struct Change {
    double by, of;
  };
  // From the even pixel to the odd one along an axis, this one being `odd` or not.
  const auto along = [&](bool odd, double per_s, double per_w) {
    const double s0 = odd ? s - per_s : s, w0 = odd ? w - per_w : w;
    return Change{std::abs((s0 + per_s) * w0 - s0 * (w0 + per_w)), std::abs(w0 * (w0 + per_w))};
  };
  const auto is_odd = [](double v) { return (std::int64_t(v) & 1) != 0; };
  const Change a = along(is_odd(x), stretch.x, weight.x), b = along(is_odd(y), stretch.y, weight.y);
  return !((a.by * b.of + b.by * a.of) * widest < a.of * b.of);
}

// Where is a skin narrow? Everywhere 2, somewhere 1, nowhere 0: as at its corners.
int NodeLayer::narrowness(const Placed& placed, std::uint32_t triangle,
                          std::span<const ClipCorner> corners) const {
  if (placed.drawn.widest_skin > kNodeCrack) return 2;
  const SkinWidth width = skin_width(placed, triangle);
  std::size_t narrow = 0;
  for (const ClipCorner& c : corners) {
    const double w = std::max(c.raster.z, kInFront);
    narrow += width.is_narrow(std::floor(c.raster.x / w), std::floor(c.raster.y / w));
  }
  return narrow == 0 ? 0 : narrow == corners.size() ? 2 : 1;
}

std::array<NodeLayer::Seen, 3> NodeLayer::seen() const {
  const auto shown = [](const Soup& soup, const SampleBuffer& samples) {
    return soup.triangle.empty() ? nullptr : &samples;
  };
  return {
      Seen{shown(surfaces_, surfaces_.raster.seen()), 0},
      Seen{shown(skins_, skins_.raster.seen()), first_skin()},
      Seen{shown(doubtful_, doubtful_seen_), first_skin() + std::uint32_t(skins_.triangle.size())}};
}

}  // namespace rilievo
