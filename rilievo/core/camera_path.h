// Where is the eye at each moment of a walk?
//
// A path is a list of keyed poses; the eye moves along a smooth curve through them, the gaze turns
// along great arcs between them. World space, metres, seconds, radians. A frame is 1/60 s of scene
// time, however long it takes to draw: how long a picture lives depends on how far the eye moves
// in a frame, so a path moves as a person would (1.4 m/s: 2.3 cm a frame).
//
// The file is JSON:
//   { "schema": "rilievo-path-1", "z_near": 0.1, "z_far": 500,
//     "keys": [ { "time": 0, "eye": [0, 1.7, 9], "orientation": [0, 0, 0, 1],
//                 "vertical_fov": 0.9 }, ... ] }
// "orientation" is the quaternion x y z w that takes eye space to world space; "target": [x, y, z],
// with or without "up": [x, y, z], may stand in its place. "z_near" and "z_far" may be left out.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"

namespace rilievo {

inline constexpr double kFramesPerSecond = 60.0;
inline constexpr double kWalkingSpeed = 1.4;  // metres a second

struct PathKey {
  double time = 0.0;  // seconds
  glm::dvec3 eye{0.0};
  glm::dquat world_from_eye{1, 0, 0, 0};  // unit
  double vertical_fov = 0.9;
};

struct CameraPath {
  std::vector<PathKey> keys;  // at least one, times ascending
  double z_near = 0.1, z_far = 1000.0;
};

// A key at `eye` that looks at `target`; `up` need not be orthogonal.
[[nodiscard]] PathKey look_key(double time, const glm::dvec3& eye, const glm::dvec3& target,
                               const glm::dvec3& up, double vertical_fov);

// Frames of 1/60 s between the first key and the last; at least one.
[[nodiscard]] int frame_count(const CameraPath& path);
// The moment of frame `frame`, counted from 0; it may lie after the last key.
[[nodiscard]] double frame_time(const CameraPath& path, int frame);

// The camera at `time`; before the first key and after the last it stands still. Passes through
// every key. Requires a valid path.
[[nodiscard]] Camera camera_at(const CameraPath& path, double time, int width, int height);

// How is a thing, or a place, best looked at?
struct Vantage {
  glm::dvec3 up{0, 1, 0};  // unit
  // Of a place that is seen from within, like a room: an eye from which it was seen, and a point
  // that this eye sees in the middle. They differ, and not along `up` alone.
  struct Gaze {
    glm::dvec3 eye{0.0}, target{0.0};
    friend bool operator==(const Gaze&, const Gaze&) = default;
  };
  std::optional<Gaze> gaze;
  friend bool operator==(const Vantage&, const Vantage&) = default;
};

// Part of a circle around `bounds` at 10 degrees a second, all of it in view, the eye outside; or
// around the gaze's target, from the gaze's eye on.
[[nodiscard]] CameraPath orbit_path(const Box& bounds, int frames, const Vantage& vantage = {});
// A straight line past `bounds`, all of it in view in the middle of the walk, the eye outside; or
// through the gaze's eye in the middle of the walk. The speed is what a house of 10 m radius looks
// like to a person on foot: 0.14 radii a second.
[[nodiscard]] CameraPath walk_path(const Box& bounds, int frames, const Vantage& vantage = {});

// Is there a key, do times ascend, is every number finite and in range?
[[nodiscard]] Result<> validate(const CameraPath& path);

// `where` names the source in errors.
[[nodiscard]] Result<CameraPath> parse_path(std::string_view json, const std::string& where);
[[nodiscard]] Result<CameraPath> load_path(const std::filesystem::path& file);
[[nodiscard]] Result<> save_path(const CameraPath& path, const std::filesystem::path& file);

}  // namespace rilievo
