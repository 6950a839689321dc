#include "rilievo/scene/builtin/traffic.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

constexpr float kJump = 1e-4f;  // seconds

struct VehiclePose {
  glm::vec3 position;
  glm::quat rotation;
};

VehiclePose pose_at(const Road& road, const Vehicle& vehicle, float driven) {
  const float way = vehicle.lane > 0 ? 1.0f : -1.0f;
  const float x = way * (2 * driven - 1) * road.half_length;
  const auto z = [&](float at) { return vehicle.lane + vehicle.sway * std::sin(at / 9.0f); };
  // Both axles stand on the road.
  const float a = x - vehicle.half_length, b = x + vehicle.half_length;
  const glm::vec3 back{a, road.height(a), z(a)}, front{b, road.height(b), z(b)};
  const glm::vec3 along = glm::normalize(way * (front - back));
  const glm::vec3 right = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0)));
  const glm::mat3 axes(along, glm::cross(right, along), right);
  return {0.5f * (back + front), glm::normalize(glm::quat_cast(axes))};
}

}  // namespace

void add_vehicle(Scene& scene, const Road& road, const Vehicle& vehicle) {
  Channel move, turn;
  move.node = turn.node = int(scene.nodes.size());
  move.path = Channel::Path::translation;
  turn.path = Channel::Path::rotation;
  const auto key = [&](float time, float driven) {
    if (!move.times.empty() && time <= move.times.back()) return;
    const VehiclePose p = pose_at(road, vehicle, driven);
    glm::vec4 q{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w};
    // q and -q are the same rotation; neighbours must lie on the same side.
    if (!turn.values.empty() && glm::dot(q, turn.values.back()) < 0) q = -q;
    move.times.push_back(time), move.values.push_back(glm::vec4(p.position, 0));
    turn.times.push_back(time), turn.values.push_back(q);
  };
  // A key every two metres or so, and one at either end of the road.
  const int steps = std::max(8, int(road.half_length));
  const float jump = (1 - vehicle.phase) * road.seconds;
  for (int i = 0; i <= steps; ++i) {
    const float time = road.seconds * float(i) / float(steps);
    const float before = road.seconds * float(i - 1) / float(steps);
    if (before < jump && jump <= time) key(jump, 1.0f), key(jump + kJump, 0.0f);
    const float driven = vehicle.phase + time / road.seconds;
    key(time, driven >= 1 ? driven - 1 : driven);
  }
  scene.nodes.push_back({});
  scene.channels.push_back(std::move(move));
  scene.channels.push_back(std::move(turn));
  scene.duration = std::max(scene.duration, road.seconds);
  Object object;
  object.name = vehicle.name, object.model = vehicle.model, object.node = turn.node;
  scene.objects.push_back(std::move(object));
}

}  // namespace rilievo
