// Where every object stands at a time: curves are sampled, then the hierarchy is multiplied out.
//
// Interpolation as glTF 2.0, appendix C: step, linear (rotations on the shorter great arc), and
// cubic Hermite splines. Before the first and after the last key a curve is constant.
#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/scene/bend.h"
#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

glm::quat quaternion(const glm::vec4& xyzw) { return {xyzw.w, xyzw.x, xyzw.y, xyzw.z}; }
glm::vec4 xyzw(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }

glm::vec4 unit(const glm::vec4& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec4(0, 0, 0, 1);
}

glm::vec4 slerp(const glm::vec4& a, const glm::vec4& b, float s) {
  return unit(xyzw(glm::slerp(quaternion(a), quaternion(b), s)));
}

// A node's translation, rotation (xyzw) and scale, kept in the columns of a matrix until its turn
// comes, so that posing needs no memory of its own.
glm::dmat4 packed(const Node& node) {
  return {glm::dvec4(node.translation, 0), glm::dvec4(xyzw(node.rotation)),
          glm::dvec4(glm::dvec3(node.scale), 0), glm::dvec4(0)};
}

glm::dmat4 parent_from_node(const glm::dmat4& packed) {
  const glm::dmat3 rotation(glm::mat3_cast(quaternion(unit(glm::vec4(packed[1])))));
  return {glm::dvec4(rotation[0] * packed[2].x, 0), glm::dvec4(rotation[1] * packed[2].y, 0),
          glm::dvec4(rotation[2] * packed[2].z, 0), glm::dvec4(glm::dvec3(packed[0]), 1)};
}

}  // namespace

glm::vec4 sample(const Channel& c, double time) {
  const bool rotation = c.path == Channel::Path::rotation;
  const bool cubic = c.interpolation == Channel::Interpolation::cubic_spline;
  const auto value = [&](std::size_t key) { return c.values[cubic ? 3 * key + 1 : key]; };
  const auto turned = [&](const glm::vec4& v) { return rotation ? unit(v) : v; };

  // The keys on both sides of `time`.
  const auto after = std::upper_bound(c.times.begin(), c.times.end(), time,
                                      [](double t, float key) { return t < double(key); });
  if (after == c.times.begin()) return turned(value(0));
  const std::size_t k = std::size_t(after - c.times.begin()) - 1;
  if (after == c.times.end() || c.interpolation == Channel::Interpolation::step)
    return turned(value(k));

  const double step = double(c.times[k + 1]) - double(c.times[k]);
  const float s = float((time - double(c.times[k])) / step);
  if (!cubic) {
    if (rotation) return slerp(unit(value(k)), unit(value(k + 1)), s);
    return value(k) + s * (value(k + 1) - value(k));
  }
  // p(s) = (2s^3 - 3s^2 + 1) v_k + (s^3 - 2s^2 + s) d b_k + (-2s^3 + 3s^2) v_k+1 + (s^3 - s^2) d
  // a_k+1, with d the time between the keys, a and b the in- and out-tangents.
  const float s2 = s * s, s3 = s2 * s, d = float(step);
  const glm::vec4 out_tangent = c.values[3 * k + 2], in_tangent = c.values[3 * (k + 1)];
  return turned((2 * s3 - 3 * s2 + 1) * value(k) + (s3 - 2 * s2 + s) * d * out_tangent +
                (3 * s2 - 2 * s3) * value(k + 1) + (s3 - s2) * d * in_tangent);
}

double repeated(double time, double duration) {
  if (!(duration > 0.0) || !std::isfinite(time)) return 0.0;
  const double t = std::fmod(time, duration);
  return t < 0.0 ? t + duration : t;
}

void pose_nodes(std::span<const Node> nodes, std::span<const Channel> channels, double time,
                std::span<glm::dmat4> scene_from_node) {
  RILIEVO_EXPECTS_EQ(nodes.size(), scene_from_node.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) scene_from_node[i] = packed(nodes[i]);
  for (const Channel& channel : channels) {
    RILIEVO_EXPECTS_LT(std::size_t(channel.node), nodes.size());
    RILIEVO_EXPECTS(!channel.times.empty());
    scene_from_node[std::size_t(channel.node)][int(channel.path)] =
        glm::dvec4(sample(channel, time));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const int parent = nodes[i].parent;
    RILIEVO_EXPECTS_LT(parent, int(i));
    const glm::dmat4 local = parent_from_node(scene_from_node[i]);
    scene_from_node[i] = parent < 0 ? local : scene_from_node[std::size_t(parent)] * local;
  }
}

void pose(const Scene& scene, double time, std::vector<glm::mat4>& world_from_model) {
  const double t = repeated(time, double(scene.duration));

  // The nodes' matrices keep their memory from call to call.
  thread_local std::vector<glm::dmat4> scene_from_node;
  scene_from_node.resize(scene.nodes.size());
  pose_nodes(scene.nodes, scene.channels, t, scene_from_node);

  world_from_model.resize(scene.objects.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    world_from_model[i] =
        object.node < 0
            ? object.placement
            : glm::mat4(scene_from_node[std::size_t(object.node)] * glm::dmat4(object.placement));
  }
}

}  // namespace rilievo
