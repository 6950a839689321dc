// A forest with cars, and eyes that walk through it.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "rilievo/cache/plan/plan_test_helpers.h"

namespace rilievo::test_forest {

// A grid of trees of 2000 triangles, 5.5 m apart, in front of the eye, the nearest first.
inline PlanObjects plant(int trees, std::uint32_t seed = 1) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  struct Place {
    float distance, x, z;
  };
  std::vector<Place> places;
  const int reach = 8 + int(1.3 * std::sqrt(trees));
  for (int j = -reach; j <= 0; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const float x = (float(i) + 0.2f + 0.6f * u(rng)) * 5.5f;
      const float z = (float(j) - 0.2f - 0.6f * u(rng)) * 5.5f;
      if (z < -3 && std::abs(x) < 30 - 1.2f * z) places.push_back({std::hypot(x, z), x, z});
    }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.distance < b.distance; });
  PlanObjects forest;
  for (int i = 0; i < trees; ++i) {
    const Place& p = places[std::size_t(i)];
    const float radius = 1.5f + u(rng), height = 4 + 3 * u(rng);
    Box box;
    box.add({p.x - radius, 0, p.z - radius}), box.add({p.x + radius, height, p.z + radius});
    forest.add(box, 2000);
  }
  forest.build();
  return forest;
}

inline FrameView looking(const glm::dvec3& eye, const glm::dvec3& direction,
                         const glm::dvec3& velocity) {
  return {look_at(eye, eye + direction, {0, 1, 0}, 1.0472, 1280, 720, 0.1, 2000), velocity};
}

// A walk at 2.3 cm a frame, 10 m up; 0: ahead, 1: to the side.
inline FrameView walk(int kind, int frame) {
  const glm::dvec3 velocity = kind == 0 ? glm::dvec3(0, 0, -0.0233) : glm::dvec3(0.0233, 0, 0);
  return looking(glm::dvec3(0, 10, 0) + velocity * double(frame), {0, -0.1, -1}, velocity);
}

// Somebody who strolls, turns, stops and, once, jumps.
inline FrameView stroll(int frame) {
  const auto eye_at = [](double t) {
    const double jump = t > 150 ? 25 : 0;
    return glm::dvec3(3 * std::sin(0.02 * t) + jump, 6 + std::sin(0.01 * t), 2 - 0.04 * t);
  };
  const double t = std::min(frame, 240);  // stands still in the end
  const glm::dvec3 velocity =
      frame < 240 && frame != 150 ? eye_at(t + 1) - eye_at(t) : glm::dvec3(0);
  const double turn = 0.9 * std::sin(0.03 * t);
  return looking(eye_at(t), {std::sin(turn), -0.1, -std::cos(turn)}, velocity);
}

// Four cars, of which one has no pictures.
inline std::vector<MovingObject> cars(int frame) {
  std::vector<MovingObject> all;
  for (int i = 0; i < 4; ++i) {
    const auto place = [&](int f) {
      glm::dmat4 m = glm::translate(glm::dmat4(1), {-20.0 + 9 * i + 0.05 * f, 0.5, -15.0 - 20 * i});
      return glm::rotate(m, 0.002 * i * f, {0, 1, 0});
    };
    MovingObject car;
    Box box;
    box.add({-2, -0.7f, -1}), box.add({2, 0.7f, 1});
    car.world_from_object = place(frame);
    car.now_from_last = place(frame) * glm::inverse(place(frame - 1));
    car.box = transformed(glm::mat4(car.world_from_object), box);
    car.triangles = 20000;
    car.polygons_only = i == 3;
    all.push_back(car);
  }
  return all;
}

// Does the camera see any of the box? By points: never says so wrongly.
inline bool surely_sees(const Camera& camera, const Box& box) {
  for (int i = 0; i < 27; ++i) {
    const glm::vec3 share(0.5f * float(i % 3), 0.5f * float(i / 3 % 3), 0.5f * float(i / 9));
    const glm::dvec3 at = raster_from_world(camera, glm::dvec3(box.min + share * box.extent()));
    if (at.z > camera.z_near && at.x > 0 && at.x < camera.width && at.y > 0 && at.y < camera.height)
      return true;
  }
  return false;
}

}  // namespace rilievo::test_forest
