#include "rilievo/scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace rilievo {
namespace {

float uniform(std::mt19937& rng, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(rng);
}

glm::vec4 random_quaternion(std::mt19937& rng) {
  glm::vec4 q;
  do q = {uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
  while (glm::length(q) < 0.1f);
  return glm::normalize(q);
}

Channel random_channel(std::mt19937& rng, int node) {
  Channel c;
  c.node = node;
  c.path = Channel::Path(rng() % 3);
  c.interpolation = Channel::Interpolation(rng() % 3);
  const std::size_t keys = 1 + rng() % 5;
  float t = uniform(rng, 0, 0.5f);
  for (std::size_t k = 0; k < keys; ++k) c.times.push_back(t), t += uniform(rng, 0.1f, 1.0f);
  const bool cubic = c.interpolation == Channel::Interpolation::cubic_spline;
  for (std::size_t v = 0; v < keys * (cubic ? 3 : 1); ++v)
    c.values.push_back(
        c.path == Channel::Path::rotation
            ? random_quaternion(rng)
            : glm::vec4(uniform(rng, -2, 2), uniform(rng, -2, 2), uniform(rng, -2, 2), 0));
  return c;
}

Mesh random_mesh(std::mt19937& rng, int triangles) {
  Mesh mesh;
  for (int i = 0; i < 3 * triangles; ++i) {
    mesh.positions.push_back({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)});
    mesh.indices.push_back(std::uint32_t(i));
  }
  return mesh;
}

Scene random_scene(std::mt19937& rng) {
  Scene scene;
  for (int i = 0; i < 3; ++i) scene.meshes.push_back(random_mesh(rng, 1 + int(rng() % 4)));
  for (int i = 0; i < 2; ++i) {
    Model model;
    model.parts.push_back({i, glm::mat4(1.0f)});
    glm::mat4 m(1.0f);
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 3; ++r) m[c][r] = uniform(rng, -1, 1);
    model.parts.push_back({2, m});
    scene.models.push_back(model);
  }
  for (int i = 0; i < 6; ++i) {
    Node node;
    node.parent = int(rng() % (i + 1)) - 1;
    node.translation = {uniform(rng, -3, 3), uniform(rng, -3, 3), uniform(rng, -3, 3)};
    const glm::vec4 q = random_quaternion(rng);
    node.rotation = {q.w, q.x, q.y, q.z};
    node.scale = {uniform(rng, -2, 2), uniform(rng, 0.5f, 2), uniform(rng, 0.5f, 2)};
    scene.nodes.push_back(node);
  }
  std::vector<std::pair<int, Channel::Path>> taken;
  for (int i = 0; i < 5; ++i) {
    Channel c = random_channel(rng, int(rng() % scene.nodes.size()));
    const std::pair<int, Channel::Path> key{c.node, c.path};
    if (std::find(taken.begin(), taken.end(), key) != taken.end()) continue;
    taken.push_back(key);
    scene.duration = std::max(scene.duration, c.times.back());
    scene.channels.push_back(std::move(c));
  }
  for (int i = 0; i < 5; ++i) {
    Object object;
    object.model = int(rng() % 2);
    object.node = int(rng() % (scene.nodes.size() + 1)) - 1;
    object.placement[3] = {uniform(rng, -1, 1), 0, 0, 1};
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

// The slow twin: doubles, recursion, a walk over all keys, and slerp by its definition.
glm::dvec4 slow_sample(const Channel& c, double t) {
  const bool cubic = c.interpolation == Channel::Interpolation::cubic_spline;
  const std::size_t n = c.times.size();
  const auto v = [&](std::size_t i) { return glm::dvec4(c.values[cubic ? 3 * i + 1 : i]); };
  glm::dvec4 out = t < c.times[0] ? v(0) : v(n - 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    if (!(c.times[k] <= t && t < c.times[k + 1])) continue;
    const double d = double(c.times[k + 1]) - c.times[k], s = (t - c.times[k]) / d;
    if (c.interpolation == Channel::Interpolation::step) {
      out = v(k);
    } else if (cubic) {
      const glm::dvec4 b(c.values[3 * k + 2]), a(c.values[3 * k + 3]);
      out = (1 + 2 * s) * (1 - s) * (1 - s) * v(k) + s * (1 - s) * (1 - s) * d * b +
            s * s * (3 - 2 * s) * v(k + 1) + s * s * (s - 1) * d * a;
    } else if (c.path == Channel::Path::rotation) {
      glm::dvec4 end = v(k + 1);
      if (glm::dot(v(k), end) < 0) end = -end;
      const double angle = std::acos(std::min(1.0, glm::dot(v(k), end)));
      out = angle < 1e-4
                ? glm::mix(v(k), end, s)
                : (std::sin((1 - s) * angle) * v(k) + std::sin(s * angle) * end) / std::sin(angle);
    } else {
      out = glm::mix(v(k), v(k + 1), s);
    }
  }
  return out;
}

glm::dmat4 slow_world_from_node(const Scene& scene, int i, double t) {
  const Node& node = scene.nodes[i];
  glm::dvec4 translation(node.translation, 0), scale(node.scale, 0);
  glm::dvec4 q(node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w);
  for (const Channel& c : scene.channels) {
    if (c.node != i) continue;
    if (c.path == Channel::Path::translation) translation = slow_sample(c, t);
    if (c.path == Channel::Path::rotation) q = glm::normalize(slow_sample(c, t));
    if (c.path == Channel::Path::scale) scale = slow_sample(c, t);
  }
  // v' = v + 2 w (u x v) + 2 u x (u x v) for each axis.
  glm::dmat4 local(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 e(0.0);
    e[axis] = scale[axis];
    const glm::dvec3 u(q);
    e += 2.0 * q.w * glm::cross(u, e) + 2.0 * glm::cross(u, glm::cross(u, e));
    local[axis] = glm::dvec4(e, 0);
  }
  local[3] = glm::dvec4(glm::dvec3(translation), 1);
  return node.parent < 0 ? local : slow_world_from_node(scene, node.parent, t) * local;
}

TEST(Pose, agrees_with_the_recursive_definition) {
  std::mt19937 rng(7);
  std::vector<glm::mat4> world_from_model;
  for (int round = 0; round < 300; ++round) {
    const Scene scene = random_scene(rng);
    ASSERT_TRUE(validate(scene).ok()) << validate(scene).error().message();
    const double time = uniform(rng, -3, 8);
    pose(scene, time, world_from_model);
    ASSERT_EQ(world_from_model.size(), scene.objects.size());
    double t = scene.duration > 0 ? time - scene.duration * std::floor(time / scene.duration) : 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Object& object = scene.objects[i];
      glm::dmat4 expected(object.placement);
      if (object.node >= 0) expected = slow_world_from_node(scene, object.node, t) * expected;
      // A spline through quaternions may pass close to zero, where its direction is ill-defined:
      // floats then lose digits, at most about 1e3 of them in 300 rounds. Else a chain of 6
      // matrices with entries up to 2^6: 1e-7 * 64 * a few.
      double largest = 1;
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(expected[c][r]));
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
          EXPECT_NEAR(world_from_model[i][c][r], expected[c][r], 1e-4 * largest) << round;
    }
  }
}

TEST(Pose, repeats_after_its_duration_and_reuses_the_buffer) {
  std::mt19937 rng(8);
  Scene scene = random_scene(rng);
  scene.duration = 2.0f;  // exact, so that time + duration has the same phase
  std::vector<glm::mat4> a, b;
  pose(scene, 0.25, a);
  const glm::mat4* const storage = a.data();
  pose(scene, 0.25 + 3 * 2.0, b);
  EXPECT_EQ(a, b);
  pose(scene, 0.25 - 2.0, a);
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.data(), storage);
}

TEST(Finish, bounds_hold_exactly_what_triangles_use) {
  std::mt19937 rng(9);
  for (int round = 0; round < 100; ++round) {
    Scene scene = random_scene(rng);
    scene.meshes[0].positions.push_back(glm::vec3(100));  // nothing refers to it
    finish(scene);
    std::uint64_t triangles = 0;
    for (const Model& model : scene.models) {
      Box box;
      std::uint64_t of_model = 0;
      for (const Part& part : model.parts)
        for (std::uint32_t i : scene.meshes[part.mesh].indices)
          box.add(
              glm::vec3(part.model_from_mesh * glm::vec4(scene.meshes[part.mesh].positions[i], 1)));
      for (const Part& part : model.parts) of_model += scene.meshes[part.mesh].indices.size() / 3;
      EXPECT_EQ(model.bounds.min, box.min);
      EXPECT_EQ(model.bounds.max, box.max);
      EXPECT_EQ(model.triangles, of_model);
    }
    for (const Object& object : scene.objects) triangles += scene.models[object.model].triangles;
    EXPECT_EQ(count_triangles(scene), triangles);
  }
}

TEST(WorldBounds, hold_every_vertex_at_every_time) {
  std::mt19937 rng(10);
  std::vector<glm::mat4> world_from_model;
  for (int round = 0; round < 100; ++round) {
    const Scene scene = random_scene(rng);
    const double time = uniform(rng, 0, 4);
    const Box box = world_bounds(scene, time);
    pose(scene, time, world_from_model);
    // Rounding of floats relative to the box.
    const glm::vec3 slack = 1e-5f * (box.extent() + glm::abs(box.max) + glm::abs(box.min));
    for (std::size_t i = 0; i < scene.objects.size(); ++i)
      for (const Part& part : scene.models[scene.objects[i].model].parts)
        for (const glm::vec3& p : scene.meshes[part.mesh].positions) {
          const glm::vec3 world(world_from_model[i] * part.model_from_mesh * glm::vec4(p, 1));
          EXPECT_TRUE(glm::all(glm::lessThanEqual(box.min - slack, world)));
          EXPECT_TRUE(glm::all(glm::lessThanEqual(world, box.max + slack)));
        }
  }
}

TEST(Finish, an_object_moves_if_a_changing_channel_is_at_or_above_its_node) {
  std::mt19937 rng(11);
  Scene scene = random_scene(rng);
  scene.nodes.assign(3, Node{});
  scene.nodes[1].parent = 0;
  scene.nodes[2].parent = -1;
  Channel channel;
  channel.node = 0;
  channel.times = {0, 1};
  channel.values = {{0, 0, 0, 0}, {1, 0, 0, 0}};
  scene.channels = {channel};
  scene.objects.assign(4, Object{});
  for (int i = 0; i < 3; ++i) scene.objects[i].node = i;
  finish(scene);
  EXPECT_TRUE(scene.objects[0].moving);
  EXPECT_TRUE(scene.objects[1].moving);
  EXPECT_FALSE(scene.objects[2].moving);
  EXPECT_FALSE(scene.objects[3].moving);
  scene.channels[0].values[1] = scene.channels[0].values[0];  // a curve that stays where it is
  finish(scene);
  EXPECT_FALSE(scene.objects[0].moving);
  // Equal keys, but the spline swings out between them.
  scene.channels[0].interpolation = Channel::Interpolation::cubic_spline;
  scene.channels[0].values.assign(6, glm::vec4(0));
  scene.channels[0].values[2].x = 1;
  finish(scene);
  EXPECT_TRUE(scene.objects[0].moving);
}

TEST(Validate, names_the_fault) {
  std::mt19937 rng(12);
  const Scene good = random_scene(rng);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto fault = [&](auto&& damage) {
    Scene scene = good;
    scene.materials.resize(1);
    scene.channels.resize(1);
    scene.lights.resize(1);
    damage(scene);
    const Result<> checked = validate(scene);
    return checked.ok() ? std::string("ok") : checked.error().reason;
  };
  EXPECT_EQ(fault([](Scene&) {}), "ok");
  EXPECT_EQ(fault([](Scene& s) { s.meshes[1].indices[0] = 99; }),
            "mesh 1 has an index out of range: 99");
  EXPECT_EQ(fault([](Scene& s) { s.meshes[0].indices.pop_back(); }),
            "mesh 0 has a number of indices that 3 does not divide");
  EXPECT_EQ(fault([](Scene& s) { s.meshes[0].normals.resize(1); }),
            "mesh 0 has arrays of different lengths");
  EXPECT_EQ(fault([&](Scene& s) { s.meshes[2].positions[0].y = nan; }),
            "mesh 2 has a position that is not finite");
  EXPECT_EQ(fault([](Scene& s) { s.meshes[2].material = 1; }),
            "mesh 2 has a material that does not exist");
  EXPECT_EQ(fault([](Scene& s) { s.materials[0].normal_texture.texture = 0; }),
            "material 0 uses a texture that does not exist");
  EXPECT_EQ(fault([](Scene& s) { s.models[1].parts[0].mesh = -1; }),
            "model 1 has a mesh that does not exist");
  EXPECT_EQ(fault([](Scene& s) { s.objects[3].model = 2; }),
            "object 3 has a model that does not exist");
  EXPECT_EQ(fault([](Scene& s) { s.objects[3].node = 6; }),
            "object 3 has a node that does not exist");
  EXPECT_EQ(fault([&](Scene& s) { s.objects[0].placement[1][1] = nan; }),
            "object 0 has a placement that is not finite and affine");
  EXPECT_EQ(fault([](Scene& s) { s.nodes[2].parent = 2; }),
            "node 2 does not come after its parent");
  EXPECT_EQ(fault([](Scene& s) { s.channels[0].values.push_back(glm::vec4(0)); }),
            "channel 0 has a wrong number of values for its keys");
  EXPECT_EQ(fault([](Scene& s) { s.lights[0].direction *= 2.0f; }),
            "light 0 has a direction that is not a unit vector");
}

TEST(Scene, an_origin_moves_everything_the_other_way) {
  std::mt19937 rng(11);
  for (int round = 0; round < 30; ++round) {
    Scene scene = random_scene(rng);
    scene.lights.push_back({Light::Kind::point, {1, 2, 3}});
    scene.cameras.push_back({});
    Scene moved = scene;
    // Coordinates of a few metres stay within the steps of a float, 1e-6 after a few products.
    const glm::dvec3 origin(uniform(rng, -8, 8), uniform(rng, -8, 8), uniform(rng, -8, 8));
    set_origin(moved, origin);
    EXPECT_EQ(moved.world.origin, origin);
    for (double t = 0; t < 3; t += 0.37) {
      std::vector<glm::mat4> before, after;
      pose(scene, t, before);
      pose(moved, t, after);
      ASSERT_EQ(before.size(), after.size());
      for (std::size_t i = 0; i < before.size(); ++i)
        for (int c = 0; c < 4; ++c)
          for (int r = 0; r < 3; ++r)
            EXPECT_NEAR(double(after[i][c][r]) + (c == 3 ? origin[r] : 0.0), before[i][c][r], 2e-5)
                << round << " " << t;
    }
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(double(moved.lights[0].position[r]) + origin[r], r + 1, 1e-6);
      EXPECT_EQ(moved.cameras[0].world_from_eye[3][r], -origin[r]);
    }
    set_origin(moved, glm::dvec3(0));
    EXPECT_EQ(moved.world, scene.world);
  }
}

}  // namespace
}  // namespace rilievo
