// Camera paths: where the eye is at each moment of a walk.
//
// A path is a list of keyed poses. The eye moves along a smooth curve through them; its orientation
// turns along great arcs. World space, metres, seconds, radians. A frame is 1/60 s of scene time,
// however long it takes to draw. Speeds are a person's (1.4 m/s: 2.3 cm a frame), because the
// lifetime of a picture depends on how far the eye moves in a frame.
//
// The file is JSON:
//   { "schema": "rilievo-path-1", "z_near": 0.1, "z_far": 500,
//     "keys": [ { "time": 0, "eye": [0, 1.7, 9], "orientation": [0, 0, 0, 1],
//                 "vertical_fov": 0.9 }, ... ] }
// "orientation" is the quaternion x y z w that takes eye space to world space. "target": [x, y, z],
// with an optional "up": [x, y, z], can replace it. "z_near" and "z_far" are optional.
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

// Frames of scene time in a second.
inline constexpr double kFramesPerSecond = 60.0;
// The speed of a person on foot.
inline constexpr double kWalkingSpeed = 1.4;  // metres a second

// Two keys that are not farther apart are a cut: the eye jumps from one to the other.
inline constexpr double kCutSeconds = 0.002;

// A pose that the path passes through.
struct PathKey {
  double time = 0.0;  // seconds
  glm::dvec3 eye{0.0};
  glm::dquat world_from_eye{1, 0, 0, 0};  // unit
  double vertical_fov = 0.9;
};

// Does the eye jump from `key` to the next one?
[[nodiscard]] bool is_cut(const PathKey& key, const PathKey& next);

// A camera path with clipping planes for all its cameras.
struct CameraPath {
  std::vector<PathKey> keys;  // at least one, times ascending
  double z_near = 0.1, z_far = 1000.0;
};

// A key at `eye` that looks at `target`; `up` need not be orthogonal to the viewing direction.
[[nodiscard]] PathKey look_key(double time, const glm::dvec3& eye, const glm::dvec3& target,
                               const glm::dvec3& up, double vertical_fov);

// The path with every eye relative to `origin`; relative_to(-origin, ...) undoes it.
[[nodiscard]] CameraPath relative_to(const glm::dvec3& origin, CameraPath path);

// The number of frames of 1/60 s from the first key to the last; at least one.
[[nodiscard]] int frame_count(const CameraPath& path);
// The time of frame `frame`, counted from 0; it can lie after the last key.
[[nodiscard]] double frame_time(const CameraPath& path, int frame);

// The camera at `time`: at the first key before the path begins, at the last after it ends. The
// curve passes through every key, and knows nothing of what lies beyond a cut. Requires a valid
// path.
[[nodiscard]] Camera camera_at(const CameraPath& path, double time, int width, int height);

// From where is an object, or a place, best viewed?
struct Vantage {
  glm::dvec3 up{0, 1, 0};  // unit
  // For a place that is viewed from within, such as a room: an eye that saw it, and a point at the
  // centre of its view. The two differ, and not only along `up`.
  struct Gaze {
    glm::dvec3 eye{0.0}, target{0.0};
    friend bool operator==(const Gaze&, const Gaze&) = default;
  };
  std::optional<Gaze> gaze;
  friend bool operator==(const Vantage&, const Vantage&) = default;
};

// An arc around `bounds` at 10 degrees a second, with all of `bounds` in view and the eye outside.
// If there is a gaze: an arc around its target that begins at its eye.
[[nodiscard]] CameraPath orbit_path(const Box& bounds, int frames, const Vantage& vantage = {});
// A straight walk past `bounds`, with all of it in view half way and the eye outside. If there is a
// gaze: through its eye half way. The speed is 0.14 radii a second: a person walking past a house
// of 10 m radius.
[[nodiscard]] CameraPath walk_path(const Box& bounds, int frames, const Vantage& vantage = {});

// The path, and back again, and so on, until it lasts at least `seconds`: an eye that does not stop
// where a path is shorter than a walk. A path of one key, or shorter than a frame, stays as it is.
// Requires a valid path.
[[nodiscard]] CameraPath there_and_back(const CameraPath& path, double seconds);

// Checks that there is a key, that times ascend, and that every number is finite and in range.
[[nodiscard]] Result<> validate(const CameraPath& path);

// Reads a path from JSON; `where` names the source in errors.
[[nodiscard]] Result<CameraPath> parse_path(std::string_view json, const std::string& where);
// Reads a path from a file; the error names the file.
[[nodiscard]] Result<CameraPath> load_path(const std::filesystem::path& file);
// Writes a path as JSON. The file is replaced at once or not at all.
[[nodiscard]] Result<> save_path(const CameraPath& path, const std::filesystem::path& file);

}  // namespace rilievo
