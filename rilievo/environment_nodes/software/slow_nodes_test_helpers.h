// For tests of drawn nodes: a slow drawing, which asks every triangle about every sample, and a
// furnished room with three nodes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/environment_nodes/visible_faces.h"

namespace rilievo {

// One tile, of which the frame does not fill a whole number of blocks.
inline constexpr int kShadeWidth = 45, kShadeHeight = 35;

// A node, as it was captured.
struct ShadeNode {
  EnvironmentMap map;
  NodeMesh mesh;
  std::array<Rgba8Image, 6> colors;
  std::array<Image<float>, 6> disparity;
};

// What a sample shows.
struct SlowSample {
  double inverse_z = 0;  // 0: nothing
  bool skin = false;
  const ShadeNode* node = nullptr;
  std::uint32_t triangle = 0;
};

// What a sample or a pixel is to show.
struct SlowPixel {
  double inverse_z = 0;  // 0: nothing
  glm::dvec3 color{0.0};
  std::uint32_t object = 0;
};

// The colour that a direction meets, and the identifier.
struct SlowTexel {
  glm::dvec3 color{0.0};
  std::uint32_t object = kNoObject;
  double weight = 0;
};

inline SlowTexel nearest_texel(const ShadeNode& node, const glm::dvec3& d) {
  const int size = node.mesh.face_size;
  const auto& faces = face_axes();
  const auto along = [&](int f) { return glm::dot(d, glm::dvec3(faces[std::size_t(f)].forward)); };
  int face = 0;
  for (int f = 1; f < 6; ++f)
    if (along(f) > along(face)) face = f;
  const FaceAxes& axes = faces[std::size_t(face)];
  const auto at = [&](const glm::ivec3& axis) {
    const double share = 0.5 + 0.5 * glm::dot(d, glm::dvec3(axis)) / along(face);
    return std::clamp(int(share * size), 0, size - 1);
  };
  const int x = at(axes.right), y = at(-axes.up);
  const DepthImage& picture = node.map.faces[std::size_t(face)];
  return {glm::dvec3(node.colors[std::size_t(face)](x, y)),
          picture.object.empty() ? 1u : picture.object(x, y),
          double(node.mesh.weights[std::size_t(face)](x, y))};
}

// Between four texels; those beyond a face's edge are its neighbours'. Beside silhouettes only
// between those about as deep as what is shown, `own` being its disparity; NaN: all. A triangle has
// its colours from its own face, and at pixels' centres that it does not reach not from farther
// beyond an edge than a texel's middle.
inline SlowTexel slow_texel(const ShadeNode& node, std::size_t face, const glm::dvec3& d,
                            double own, double tolerance) {
  const int size = node.mesh.face_size;
  const FaceAxes& axes = face_axes()[face];
  const double ahead = glm::dot(d, glm::dvec3(axes.forward));
  const auto place = [&](const glm::ivec3& along) {
    return std::clamp((0.5 + 0.5 * glm::dot(d, glm::dvec3(along)) / ahead) * size - 0.5, -1.0,
                      double(size));
  };
  const double u = place(axes.right), v = place(-axes.up);
  SlowTexel out;
  const Image<float>& disparity = node.disparity[face];
  const auto object_at = [&](double x, double y) {
    const DepthImage& picture = node.map.faces[face];
    return picture.object.empty()
               ? 1u
               : picture.object(std::clamp(int(x), 0, size - 1), std::clamp(int(y), 0, size - 1));
  };
  out.object = object_at(std::floor(u + 0.5), std::floor(v + 0.5));
  double off[4], shares[4], least = 1e30, least_weight = 255;
  glm::dvec3 colors[4];
  std::uint32_t objects[4];
  for (int k = 0; k < 4; ++k) {
    const double x = std::floor(u) + (k & 1), y = std::floor(v) + (k >> 1);
    const glm::dvec3 texel = glm::dvec3(axes.forward) +
                             (2 * (x + 0.5) / size - 1) * glm::dvec3(axes.right) -
                             (2 * (y + 0.5) / size - 1) * glm::dvec3(axes.up);
    const SlowTexel nearest = nearest_texel(node, texel);
    const double share = (1 - std::abs(u - x)) * (1 - std::abs(v - y));
    out.color += share * nearest.color, out.weight += share * nearest.weight;
    off[k] = std::abs(
        double(disparity(std::clamp(int(x), 0, size - 1), std::clamp(int(y), 0, size - 1))) - own);
    least = std::min(least, off[k]), least_weight = std::min(least_weight, nearest.weight);
    shares[k] = std::max(share, 1e-3), colors[k] = nearest.color;
    // Beyond an edge of the face identifiers are those of its own last texels, as disparities are.
    objects[k] = object_at(x, y);
  }
  if (std::isnan(own) || least_weight > 0) return out;
  out.color = glm::dvec3(0.0);
  double sum = 0, most = 0;
  for (int k = 0; k < 4; ++k) {
    if (off[k] > least + tolerance * own) continue;
    out.color += shares[k] * colors[k], sum += shares[k];
    if (shares[k] > most) most = shares[k], out.object = objects[k];
  }
  out.color /= sum;
  return out;
}

class SlowNodes {
 public:
  SlowNodes(const Camera& frame, std::vector<const ShadeNode*> nodes,
            const NodeDrawOptions& options)
      : frame_(frame), nodes_(std::move(nodes)), options_(options) {
    double sum = 0;
    for (const ShadeNode* node : nodes_) {
      const NodeMesh& mesh = node->mesh;
      const glm::dmat4 clip = clip_from_node(mesh, frame_);
      std::vector<glm::dvec3> raster;
      for (const NodeVertex& v : mesh.vertices) {
        const glm::dvec4 at = clip * glm::dvec4(v.direction, v.disparity);
        raster.emplace_back(0.5 * frame_.width * (at.x + at.w), 0.5 * frame_.height * (at.y + at.w),
                            at.w);
      }
      raster_.push_back(std::move(raster));
      nearness_.push_back(1 / glm::distance(frame.position(), glm::dvec3(mesh.world_from_node[3])));
      sum += nearness_.back();
    }
    for (double& of : nearness_) of /= sum;
  }

  // What node `i` shows at a place of the frame, in pixels, y upwards. Skins are asked at the pixel
  // that the place is in.
  [[nodiscard]] SlowSample look(std::size_t i, const glm::dvec2& place) const {
    const ShadeNode& node = *nodes_[i];
    SlowSample best;
    for (std::uint32_t t = 0; t < node.mesh.triangles(); ++t) {
      const std::uint32_t* corners = &node.mesh.indices[3 * std::size_t(t)];
      glm::dmat3 m;
      glm::dvec3 disparity;
      for (int k = 0; k < 3; ++k) {
        m[k] = raster_[i][corners[k]];
        disparity[k] = double(node.mesh.vertices[corners[k]].disparity);
      }
      const double det = glm::determinant(m);
      const bool skin = t >= node.mesh.surface_triangles();
      if (det == 0 || (det < 0 && i > 0 && !skin)) continue;  // edge-on, or seen from behind
      const glm::dmat3 inverse = glm::inverse(m);
      const glm::dvec3 weights = inverse * glm::dvec3(place, 1);
      if (!glm::all(glm::greaterThanEqual(weights, glm::dvec3(0.0)))) continue;
      const double inverse_z = std::max(glm::dot(weights, disparity), 1e-30);
      if (inverse_z > 4 / frame_.z_near) continue;
      // Of merged nodes skins lie behind all surfaces.
      const bool merged = options_.merge != NodeMerge::layering;
      if (merged && skin != best.skin && best.inverse_z > 0) {
        if (skin) continue;
      } else if (inverse_z < best.inverse_z || (inverse_z == best.inverse_z && !skin)) {
        continue;
      }
      if (skin && (i > 0 || !options_.skin) && !is_narrow(node, corners, inverse, place)) continue;
      best = {inverse_z, skin, &node, t};
    }
    if (best.inverse_z > 0) best.inverse_z = std::max(best.inverse_z, 1 / frame_.z_far);
    return best;
  }
  // The texel that a sample of a pixel shows, at the pixel's centre.
  [[nodiscard]] SlowTexel shade(std::size_t i, const SlowSample& sample,
                                const glm::dvec2& center) const {
    const std::uint32_t* corners = &sample.node->mesh.indices[3 * std::size_t(sample.triangle)];
    glm::dmat3 m;
    for (int k = 0; k < 3; ++k) m[k] = raster_[i][corners[k]];
    const glm::dvec3 weights = glm::inverse(m) * glm::dvec3(center, 1);
    glm::dvec3 direction(0.0);
    for (int k = 0; k < 3; ++k)
      direction += weights[k] * glm::dvec3(sample.node->mesh.vertices[corners[k]].texture);
    const NodeMesh& mesh = sample.node->mesh;
    std::size_t face = 0;
    for (std::size_t f = 0; f < 6; ++f)
      for (const TriangleRange& range : {mesh.surfaces[f], mesh.skins[f]})
        if (sample.triangle >= range.first && sample.triangle < range.first + range.count) face = f;
    return slow_texel(*sample.node, face, direction,
                      sample.skin ? std::nan("") : disparity_of(sample, center),
                      double(options_.tolerance));
  }

  // What a pixel shows of all nodes, merged.
  [[nodiscard]] SlowPixel merged(const glm::dvec2& center) const {
    std::vector<SlowSample> seen;
    for (std::size_t i = 0; i < nodes_.size(); ++i) seen.push_back(look(i, center));
    if (options_.merge == NodeMerge::first) {
      // The others have one z-buffer.
      std::size_t other = 1;
      for (std::size_t i = 2; i < seen.size(); ++i) {
        const SlowSample &one = seen[i], &best = seen[other];
        const bool nothing = one.inverse_z == 0 || best.inverse_z == 0;
        if (nothing || one.skin == best.skin ? one.inverse_z >= best.inverse_z : best.skin)
          other = i;
      }
      const SlowSample &first = seen[0], &others = seen[other];
      const bool gap = first.inverse_z == 0 || first.skin;
      const bool fills =
          others.inverse_z > 0 && (!others.skin || others.inverse_z > first.inverse_z);
      const std::size_t i = gap && fills ? other : 0;
      if (seen[i].inverse_z == 0) return {};
      const SlowTexel texel = shade(i, seen[i], center);
      return {seen[i].inverse_z, texel.color, texel.object};
    }
    double nearest = 0, farthest = 1e30;
    bool skins = true;
    for (const SlowSample& s : seen) skins = skins && (s.inverse_z == 0 || s.skin);
    for (const SlowSample& s : seen) {
      if (s.skin != skins || s.inverse_z == 0) continue;
      nearest = std::max(nearest, s.inverse_z), farthest = std::min(farthest, s.inverse_z);
    }
    if (nearest == 0) return {};
    const double tolerance = double(options_.tolerance), far = 1 / frame_.z_far;
    std::vector<double> shares(seen.size(), 1.0);
    if (!skins && nearest > (1 + 0.5 * tolerance) * farthest) {
      double accepted = 0;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i].inverse_z == 0 || seen[i].skin) continue;
        const glm::dvec3 at =
            world_from_raster(frame_, {center.x, frame_.height - center.y}, 1 / seen[i].inverse_z);
        for (std::size_t j = 0; j < seen.size(); ++j)
          if (i > 0 && j != i && seen[i].inverse_z > far / 0.999)
            shares[i] = std::min(shares[i], share(*nodes_[j], at));
        if (shares[i] >= 0.5) accepted = std::max(accepted, seen[i].inverse_z);
      }
      if (accepted > 0)
        nearest = accepted;
      else
        shares.assign(seen.size(), 1.0);
    }
    SlowPixel out;
    double most = -1, weights = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const SlowSample& s = seen[i];
      if (s.inverse_z == 0 || s.skin != skins) continue;
      if (nearest > (skins ? 1 : 1 + tolerance) * s.inverse_z) continue;
      const SlowTexel texel = shade(i, s, center);
      double weight = 1;
      if (!skins) weight = shares[i] * (std::floor(texel.weight * 253 / 255 + 0.5) + 0.25);
      if (options_.merge == NodeMerge::positional) weight *= nearness_[i] * nearness_[i];
      const glm::dvec3 color = glm::floor(texel.color + 0.5);
      const bool best = weight > most;
      if (best) most = weight, out.inverse_z = s.inverse_z, out.object = texel.object;
      if (options_.merge != NodeMerge::binary)
        out.color += weight * color, weights += weight;
      else if (best)
        out.color = color, weights = 1;
    }
    out.color /= weights;
    return out;
  }

 private:
  // 1 / eye_z from the node of what a sample shows, at a pixel's centre; 0 of the sky.
  [[nodiscard]] double disparity_of(const SlowSample& sample, const glm::dvec2& center) const {
    if (sample.inverse_z <= 1.00001 / frame_.z_far) return 0;
    const glm::dvec3 world =
        world_from_raster(frame_, {center.x, frame_.height - center.y}, 1 / sample.inverse_z);
    const glm::dvec3 seen(glm::inverse(sample.node->mesh.world_from_node) * glm::dvec4(world, 1));
    const glm::dvec3 a = glm::abs(seen);
    return 1 / std::max({a.x, a.y, a.z, 1e-9});
  }
  // What is left of what lies at a point of the world where a node may see through it.
  [[nodiscard]] double share(const ShadeNode& node, const glm::dvec3& world) const {
    const glm::dvec3 seen(glm::inverse(node.mesh.world_from_node) * glm::dvec4(world, 1));
    const glm::dvec3 a = glm::abs(seen);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const auto face = std::size_t(2 * axis + (seen[axis] < 0));
    const int size = node.mesh.face_size;
    const auto texel = [&](const glm::ivec3& along) {
      const double at = (0.5 + 0.5 * glm::dot(seen, glm::dvec3(along)) / a[axis]) * size - 0.5;
      return std::clamp(int(std::floor(at)), 0, size - 1);
    };
    const int x = texel(face_axes()[face].right), y = texel(-face_axes()[face].up);
    const Image<float>& disparity = node.disparity[face];
    double nearest = double(kNothing);
    for (int k = 0; k < 4; ++k)
      nearest = std::max(nearest, double(disparity(std::min(x + (k & 1), size - 1),
                                                   std::min(y + (k >> 1), size - 1))));
    if (nearest < 0) return 1;
    const double farther = 1 / std::max(nearest * a[axis], 1e-9) - 1;
    return std::clamp(2 - 2 * farther / double(options_.tolerance), 0.0, 1.0);
  }
  // By OpenGL's derivatives, which are differences within squares of 2 x 2 pixels.
  [[nodiscard]] bool is_narrow(const ShadeNode& node, const std::uint32_t* corners,
                               const glm::dmat3& inverse, const glm::dvec2& place) const {
    const auto stretch = [&](double x, double y) {
      const glm::dvec3 weights = inverse * glm::dvec3(x, y, 1);
      double of = 0;
      for (int k = 0; k < 3; ++k) of += weights[k] * double(node.mesh.vertices[corners[k]].stretch);
      return of / (weights.x + weights.y + weights.z);
    };
    const double x = std::floor(place.x), y = std::floor(place.y);
    if (stretch(x + 0.5, y + 0.5) < 0) return true;
    const double even_x = 2 * std::floor(x / 2) + 0.5, even_y = 2 * std::floor(y / 2) + 0.5;
    const double width = std::abs(stretch(even_x + 1, y + 0.5) - stretch(even_x, y + 0.5)) +
                         std::abs(stretch(x + 0.5, even_y + 1) - stretch(x + 0.5, even_y));
    return width * double(kNodeCrack) >= 1;
  }

  Camera frame_;
  std::vector<const ShadeNode*> nodes_;
  NodeDrawOptions options_;
  std::vector<std::vector<glm::dvec3>> raster_;  // (x w, y w, w) of each node's vertices
  std::vector<double> nearness_;
};

class DrawnNodesTest : public testing::Test {
 protected:
  // Three nodes in a furnished room without a ceiling.
  void SetUp() override {
    for (const glm::dvec3& eye :
         {glm::dvec3(-0.5, 0, 0.2), glm::dvec3(0.6, 0.1, 0), glm::dvec3(0.1, 0.3, 0.9)}) {
      const DistanceAlong room =
          nearest_of({box_around(glm::dvec3(-3, -1.4, -2) - eye, glm::dvec3(3, 9, 2.5) - eye),
                      ball(glm::dvec3(0.4, -0.5, -1.2) - eye, 0.4),
                      ball(glm::dvec3(-1.4, 0.2, 1.5) - eye, 0.5)});
      ShadeNode node;
      node.map = make_node(
          20,
          [&](const glm::dvec3& d) {
            const double nearest = room(d);
            return nearest * d.y > 4 ? INFINITY : nearest;
          },
          [&](const glm::dvec3& d, double distance) {
            if (!std::isfinite(distance)) return glm::vec4(0.1f, 0.3f, 0.9f, 1);
            return glm::vec4(glm::fract(glm::vec3(eye + distance * d)) * 0.8f + 0.1f, 1);
          },
          eye);
      for (std::size_t f = 0; f < 6; ++f) {
        DepthImage& face = node.map.faces[f];
        face.object = Image<std::uint32_t>(20, 20, kNoObject);
        for (int y = 0; y < 20; ++y)
          for (int x = 0; x < 20; ++x)
            if (face.covered(x, y)) face.object(x, y) = std::uint32_t(2 + f + (x / 7) * 6);
        node.colors[f] = srgb8_from_linear(face.color);
        node.disparity[f] = face_disparity(face);
      }
      node.mesh = triangulate(node.map, {});
      nodes_.push_back(std::move(node));
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) tiles_.keep(i, nodes_[i].map, nodes_[i].mesh);
  }

  [[nodiscard]] static Camera random_camera(Random& random) {
    const double x = random.between(-1.2f, 1.2f), y = random.between(-0.6f, 0.6f),
                 z = random.between(-0.7f, 1.2f), angle = random.between(0, 6.28f),
                 up = random.between(-0.8f, 0.8f);
    const glm::dvec3 eye(x, y, z);
    return look_at(eye, eye + glm::dvec3(std::cos(angle), up, std::sin(angle)), {0, 1, 0}, 1.0,
                   kShadeWidth, kShadeHeight, 0.05, 40);
  }

  // The tile that is the whole frame.
  [[nodiscard]] std::unique_ptr<FrameTile> drawn(const Camera& frame, std::size_t count,
                                                 const NodeDrawOptions& options, int samples,
                                                 Output output) {
    auto tile = std::make_unique<FrameTile>();
    tile->width = frame.width, tile->height = frame.height;
    tile->samples = samples;
    tile->of = output == Output::color ? TileContent::color : TileContent::object_id;
    tile->nothing = float(1 / frame.z_far);
    tile->clear(0);
    const std::size_t all[] = {0, 1, 2};
    tiles_.set_samples(samples);
    tiles_.begin();
    tiles_.draw(frame, 1.0, {all, count}, output, kNoObject, options);
    tiles_.draw_tile(*tile);
    return tile;
  }
  [[nodiscard]] std::vector<const ShadeNode*> first(std::size_t count) const {
    std::vector<const ShadeNode*> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(&nodes_[i]);
    return out;
  }

  std::vector<ShadeNode> nodes_;
  NodeTiles tiles_;
};

}  // namespace rilievo
