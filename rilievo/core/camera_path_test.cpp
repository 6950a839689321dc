#include "rilievo/core/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <random>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"

namespace rilievo {
namespace {

Box box_of(const glm::vec3& a, const glm::vec3& b) {
  Box box;
  box.add(a), box.add(b);
  return box;
}

CameraPath random_path(std::mt19937& rng, int keys) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  CameraPath path;
  path.z_near = 0.3, path.z_far = 70;
  double time = u(rng);
  for (int i = 0; i < keys; ++i) {
    path.keys.push_back(look_key(time, {u(rng), u(rng), u(rng)}, {5 * u(rng), 9, 5 * u(rng)},
                                 {0, 1, 0}, 1.0 + 0.5 * u(rng)));
    time += 1.1 + u(rng);
  }
  return path;
}

TEST(CameraPath, passes_through_every_key_and_stands_still_outside) {
  std::mt19937 rng(3);
  for (int n = 1; n < 8; ++n) {
    const CameraPath path = random_path(rng, n);
    ASSERT_TRUE(validate(path).ok());
    for (const PathKey& key : path.keys) {
      const Camera c = camera_at(path, key.time, 64, 48);
      ASSERT_TRUE(validate(c).ok());
      // 1e-12: rounding of doubles.
      EXPECT_LT(glm::length(c.position() - key.eye), 1e-12);
      EXPECT_LT(glm::length(c.forward() - key.world_from_eye * glm::dvec3(0, 0, -1)), 1e-12);
      EXPECT_NEAR(c.window.top, std::tan(key.vertical_fov / 2), 1e-12);
      EXPECT_NEAR(c.window.right, c.window.top * 64 / 48, 1e-12);
    }
    EXPECT_EQ(camera_at(path, path.keys.front().time - 5, 8, 8),
              camera_at(path, path.keys.front().time, 8, 8));
    EXPECT_EQ(camera_at(path, path.keys.back().time + 5, 8, 8),
              camera_at(path, path.keys.back().time, 8, 8));
  }
}

TEST(CameraPath, there_and_back_never_stands_still) {
  std::mt19937 rng(6);
  for (int n = 2; n < 8; ++n) {
    const CameraPath path = random_path(rng, n);
    const double start = path.keys.front().time, length = path.keys.back().time - start;
    for (const double lengths : {0.5, 1.0, 2.5, 7.0}) {
      const CameraPath longer = there_and_back(path, lengths * length);
      ASSERT_TRUE(validate(longer).ok());
      EXPECT_GE(longer.keys.back().time - start, lengths * length * (1 - 1e-12));
      // Not longer than it must be; 1e-9: a sum of lengths may fall short by rounding.
      EXPECT_LT(longer.keys.back().time - start,
                (std::max(lengths, 1.0) + 1) * length * (1 + 1e-9));
      // Through the keys of the path, forth and back.
      for (const PathKey& key : path.keys)
        for (double turn = 0; turn < lengths; turn += 2) {
          const double since = key.time - start;
          for (const double time : {turn * length + since, (turn + 2) * length - since}) {
            if (start + time > longer.keys.back().time) continue;
            // 1e-9: times are sums, and the eye's speed is below 1000.
            EXPECT_LT(glm::length(camera_at(longer, start + time, 8, 8).position() - key.eye), 1e-9)
                << n << " " << lengths << " " << time;
          }
        }
    }
  }
  CameraPath one;
  one.keys.push_back({});
  EXPECT_EQ(there_and_back(one, 9).keys.size(), 1u);
  // A path shorter than a frame would be walked millions of times.
  one.keys.push_back({.time = 1e-7});
  EXPECT_EQ(there_and_back(one, 1).keys.size(), 2u);
  one.keys[1].time = 1 / kFramesPerSecond;
  EXPECT_GE(there_and_back(one, 1).keys.back().time, 1 - 1e-12);
}

TEST(CameraPath, an_eye_that_jumps_stands_before_and_after) {
  // Stands, jumps, stands; then a shot of three keys.
  CameraPath path;
  const auto add = [&](double time, double x) {
    path.keys.push_back(look_key(time, {x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 0.9));
  };
  add(0, 0), add(1.499, 0), add(1.5, 100), add(2.999, 100);
  add(3, -50), add(3.5, -49), add(4, -48);
  const auto x_at = [&](double time) { return camera_at(path, time, 8, 8).position().x; };
  for (double time = 0; time <= 4; time += 1.0 / 512) {
    const double expected = time < 1.5 ? 0 : time < 3 ? 100 : -50 + 2 * (time - 3);
    // 1e-9: rounding of doubles.
    ASSERT_NEAR(x_at(time), expected, 1e-9) << time;
  }
}

TEST(CameraPath, two_milliseconds_are_a_cut_and_three_are_none_at_any_time) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(0, 1e5);
  for (int i = 0; i < 200; ++i) {
    const double time = i < 100 ? i : u(rng);
    for (const double gap : {0.002, 0.003}) {
      CameraPath path;
      path.keys = {{.time = time}, {.time = time + gap, .eye = {1, 0, 0}}};
      EXPECT_EQ(is_cut(path.keys[0], path.keys[1]), gap == 0.002) << time;
      const double half_way = camera_at(path, time + 0.5 * gap, 8, 8).position().x;
      // 1e-3: times around 1e5 s are known to 1e-11 s.
      EXPECT_NEAR(half_way, gap == 0.002 ? 0 : 0.5, 1e-3) << time;
    }
  }
}

TEST(CameraPath, the_eye_moves_smoothly) {
  std::mt19937 rng(4);
  const CameraPath path = random_path(rng, 7);
  const double h = 1e-5;
  for (std::size_t i = 1; i + 1 < path.keys.size(); ++i) {
    const double t = path.keys[i].time;
    const auto eye = [&](double time) { return camera_at(path, time, 8, 8).position(); };
    const glm::dvec3 before = (eye(t) - eye(t - h)) / h, after = (eye(t + h) - eye(t)) / h;
    // One-sided differences are off by h times the acceleration, here below 1000.
    EXPECT_LT(glm::length(before - after), 1000 * h);
  }
}

TEST(CameraPath, a_walk_keeps_its_speed_and_a_frame_is_a_sixtieth) {
  CameraPath path;
  for (const double t : {0.0, 0.3, 1.7, 2.0})
    path.keys.push_back(look_key(t, {kWalkingSpeed * t, 2, 0}, {0, 0, -9}, {0, 1, 0}, 0.9));
  EXPECT_EQ(frame_count(path), 120);
  for (int i = 0; i < 120; ++i) {
    const glm::dvec3 eye = camera_at(path, frame_time(path, i), 8, 8).position();
    EXPECT_LT(glm::length(eye - glm::dvec3(1.4 * i / 60.0, 2, 0)), 1e-12);
  }
}

TEST(CameraPath, orbit_and_walk_see_all_of_the_bounds_from_outside) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  for (int i = 0; i < 60; ++i) {
    const float scale = std::pow(10.0f, 4.0f * u(rng));
    const glm::vec3 center = 3.0f * scale * glm::vec3(u(rng), u(rng), u(rng));
    const glm::vec3 half = scale * glm::abs(glm::vec3(u(rng), u(rng), u(rng)));
    const Box box = box_of(center - half, center + half);
    for (const bool walk : {false, true}) {
      const CameraPath path = walk ? walk_path(box, 120) : orbit_path(box, 120);
      ASSERT_TRUE(validate(path).ok());
      EXPECT_EQ(frame_count(path), 120);
      for (int frame = 0; frame <= 120; frame += 20) {
        const Camera c = camera_at(path, frame_time(path, frame), 100, 100);
        ASSERT_TRUE(validate(c).ok());
        for (const glm::vec3& corner : box.corners()) {
          const glm::dvec3 raster = raster_from_world(c, corner);
          EXPECT_GT(raster.z, c.z_near);
          EXPECT_LT(raster.z, c.z_far);
          // In the middle of a walk everything is in view; an orbit always sees everything.
          if (walk && frame != 60) continue;
          EXPECT_GE(std::min(raster.x, raster.y), 0.0);
          EXPECT_LE(std::max(raster.x, raster.y), 100.0);
        }
      }
    }
  }
}

TEST(CameraPath, an_orbit_is_a_circle_at_ten_degrees_a_second) {
  const Box box = box_of({-2, 0, -1}, {4, 3, 1});
  const CameraPath path = orbit_path(box, 600);
  const glm::dvec3 center(box.center());
  const glm::dvec3 first = camera_at(path, 0, 8, 8).position() - center;
  for (int i = 0; i < 600; i += 7) {
    const Camera c = camera_at(path, frame_time(path, i), 8, 8);
    const glm::dvec3 p = c.position() - center;
    // 1e-6: what the comment at the key step of orbit_path promises.
    EXPECT_NEAR(glm::length(p) / glm::length(first), 1.0, 1e-6);
    EXPECT_LT(glm::length(c.forward() + glm::normalize(p)), 2e-6);
    const double turned = std::remainder(
        std::atan2(p.x, p.z) - std::atan2(first.x, first.z) - i / 6.0 * glm::pi<double>() / 180.0,
        2 * glm::pi<double>());
    EXPECT_NEAR(turned, 0.0, 1e-6);
  }
}

TEST(CameraPath, a_world_that_is_turned_has_the_same_paths_turned) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> u(-1, 1);
  // A cube is its own box from six sides; any other would be another box when turned.
  const Box box = box_of({-1, -1, -1}, {1, 1, 1});
  for (const glm::dvec3& up : {glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1),
                               glm::normalize(glm::dvec3(u(rng), u(rng), u(rng)))})
    for (const bool walk : {false, true}) {
      const Vantage vantage{up, {}};
      const CameraPath path = walk ? walk_path(box, 120, vantage) : orbit_path(box, 120, vantage);
      const CameraPath usual = walk ? walk_path(box, 120) : orbit_path(box, 120);
      ASSERT_TRUE(validate(path).ok());
      EXPECT_EQ(path.z_far, usual.z_far);
      for (int frame = 0; frame <= 120; frame += 30) {
        const Camera a = camera_at(path, frame_time(path, frame), 8, 8);
        const Camera b = camera_at(usual, frame_time(usual, frame), 8, 8);
        // 1e-9: rounding of doubles. Heights, distances and tilts are alike.
        EXPECT_NEAR(glm::dot(a.position(), up), b.position().y, 1e-9);
        EXPECT_NEAR(glm::length(a.position()), glm::length(b.position()), 1e-9);
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_NEAR(glm::dot(glm::dvec3(a.world_from_eye[axis]), up), b.world_from_eye[axis].y,
                      1e-9);
      }
    }
}

TEST(CameraPath, a_gaze_is_where_an_orbit_begins_and_a_walk_has_its_middle) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<double> u(-1, 1);
  const Box box = box_of({-3, -2, -1}, {3, 2, 4});
  for (int i = 0; i < 50; ++i) {
    const Vantage vantage{glm::normalize(glm::dvec3(u(rng), u(rng) + 2, u(rng))),
                          Vantage::Gaze{{2 * u(rng), 1.5 * u(rng), 0}, {u(rng), u(rng), 3}}};
    const glm::dvec3 eye = vantage.gaze->eye, target = vantage.gaze->target;
    for (const bool walk : {false, true}) {
      const CameraPath path = walk ? walk_path(box, 120, vantage) : orbit_path(box, 120, vantage);
      ASSERT_TRUE(validate(path).ok());
      const Camera c = camera_at(path, frame_time(path, walk ? 60 : 0), 8, 8);
      EXPECT_LT(glm::distance(c.position(), eye), 1e-9);
      EXPECT_LT(glm::length(c.forward() - glm::normalize(target - eye)), 1e-6);
      // Upright: no roll, and not on its head.
      EXPECT_NEAR(glm::dot(glm::dvec3(c.world_from_eye[0]), vantage.up), 0, 1e-6);
      EXPECT_GT(glm::dot(glm::dvec3(c.world_from_eye[1]), vantage.up), 0);
      for (int frame = 0; frame <= 120; frame += 20) {
        const Camera at = camera_at(path, frame_time(path, frame), 8, 8);
        if (!walk) {
          EXPECT_NEAR(glm::distance(at.position(), target), glm::distance(eye, target), 1e-5);
          EXPECT_NEAR(glm::dot(at.position() - eye, vantage.up), 0, 1e-5);
        }
        // What is before the eye is between the planes, but for the very nearest.
        for (const glm::vec3& corner : box.corners()) {
          const double z = raster_from_world(at, corner).z;
          EXPECT_LT(z, at.z_far);
        }
        EXPECT_LT(at.z_near, 0.02 * glm::distance(eye, target));
      }
    }
  }
}

TEST(CameraPath, degenerate_bounds_give_valid_paths) {
  for (const Box& box : {Box{}, box_of({7, 7, 7}, {7, 7, 7}), box_of({1e6f, 0, 0}, {1e6f, 0, 0}),
                         box_of({-5, 0, -5}, {5, 0, 5})}) {
    EXPECT_TRUE(validate(orbit_path(box, 1)).ok());
    EXPECT_TRUE(validate(walk_path(box, 1)).ok());
  }
}

TEST(CameraPath, a_file_brings_back_the_same_path) {
  std::mt19937 rng(6);
  const CameraPath path = random_path(rng, 20);
  const TemporaryFolder folder;
  ASSERT_TRUE(save_path(path, folder / "path.json").ok());
  const Result<CameraPath> loaded = load_path(folder / "path.json");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  ASSERT_EQ(loaded->keys.size(), path.keys.size());
  EXPECT_EQ(loaded->z_near, path.z_near);
  EXPECT_EQ(loaded->z_far, path.z_far);
  for (int i = 0; i < frame_count(path); ++i)
    EXPECT_EQ(camera_at(*loaded, frame_time(path, i), 64, 48),
              camera_at(path, frame_time(path, i), 64, 48));
}

TEST(CameraPath, a_target_stands_in_for_an_orientation) {
  const Result<CameraPath> path = parse_path(
      R"({"schema":"rilievo-path-1","keys":[
          {"time":0,"eye":[0,2,10],"target":[3,1,0],"vertical_fov":1}]})",
      "text");
  ASSERT_TRUE(path.ok()) << path.error().message();
  const Camera c = camera_at(*path, 0, 8, 8);
  EXPECT_LT(glm::length(c.forward() - glm::normalize(glm::dvec3(3, -1, -10))), 1e-12);
  EXPECT_NEAR(c.world_from_eye[0].y, 0.0, 1e-12);
}

TEST(CameraPath, bad_files_are_refused_with_their_name_and_a_reason) {
  const std::string head = R"({"schema":"rilievo-path-1","keys":[)";
  const std::string key = R"({"time":0,"eye":[0,0,0],"orientation":[0,0,0,1],"vertical_fov":1})";
  ASSERT_TRUE(parse_path(head + key + "]}", "x").ok());
  const std::pair<std::string, std::string> bad[] = {
      {"", "not JSON"},
      {"[1,2", "not JSON"},
      {"[]", "schema"},
      {R"({"schema":"rilievo-path-2","keys":[]})", "schema"},
      {R"({"schema":"rilievo-path-1"})", "keys"},
      {head + "]}", "no key"},
      {head + "3]}", "key 0 is not an object"},
      {head + R"({"time":"a"}]})", "\"time\""},
      {head + R"({"time":NaN,"eye":[0,0,0],"orientation":[0,0,0,1],"vertical_fov":1}]})", "JSON"},
      {head + R"({"time":1e999,"eye":[0,0,0],"orientation":[0,0,0,1],"vertical_fov":1}]})", "JSON"},
      {head + R"({"time":0,"eye":[0,0],"orientation":[0,0,0,1],"vertical_fov":1}]})", "\"eye\""},
      {head + R"({"time":0,"eye":[0,0,"a"],"orientation":[0,0,0,1],"vertical_fov":1}]})",
       "\"eye\""},
      {head + R"({"time":0,"eye":[0,0,1e300],"orientation":[0,0,0,1],"vertical_fov":1}]})",
       "range"},
      {head + R"({"time":0,"eye":[0,0,0],"orientation":[0,0,0,0],"vertical_fov":1}]})",
       "quaternion"},
      {head + R"({"time":0,"eye":[0,0,0],"target":[0,0,0],"vertical_fov":1}]})", "own eye"},
      {head + R"({"time":0,"eye":[0,0,0],"target":[1,0,0],"up":[0,0,0],"vertical_fov":1}]})", "up"},
      {head + R"({"time":0,"eye":[0,0,0],"orientation":[0,0,0,1],"vertical_fov":0}]})",
       "vertical_fov"},
      {head + key + "," + key + "]}", "later"},
      {R"({"schema":"rilievo-path-1","z_near":2,"z_far":1,"keys":[)" + key + "]}", "z_near"},
      {R"({"schema":"rilievo-path-1","z_near":"a","keys":[)" + key + "]}", "z_near"},
  };
  for (const auto& [text, reason] : bad) {
    const Result<CameraPath> path = parse_path(text, "some.json");
    ASSERT_FALSE(path.ok()) << text;
    EXPECT_EQ(path.error().where, "some.json");
    EXPECT_NE(path.error().reason.find(reason), std::string::npos) << path.error().message();
  }
  EXPECT_FALSE(load_path("/no/such/file.json").ok());
}

TEST(CameraPath, what_is_not_a_path_is_not_saved) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "path.json";
  CameraPath path;
  EXPECT_FALSE(save_path(path, file).ok());
  path.keys.push_back(look_key(0, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.0));
  path.keys[0].eye.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(save_path(path, file).ok());
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace rilievo
