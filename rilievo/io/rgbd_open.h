// What the readers of the three kinds of captures share. Internal to io.
#pragma once

#include <string>
#include <vector>

#include "rilievo/io/rgbd.h"

namespace rilievo::rgbd {

// More frames or larger texts are no capture.
inline constexpr std::size_t kMostFrames = 100000;
inline constexpr std::uint64_t kMostTextBytes = 256u << 20;

// The nearest rigid motion to a camera-to-world matrix that is one to 1 %; the error is a clause
// that says what is wrong with it.
[[nodiscard]] Result<glm::dmat4> rigid_pose(const glm::dmat4& matrix);

// To a camera that looks down -z, y up, from one that looks down +z, y down.
[[nodiscard]] glm::dmat4 flipped_axes(const glm::dmat4& world_from_camera);

// Are the numbers those of a lens?
[[nodiscard]] Result<> check(const RgbdIntrinsics& intrinsics);

// Is there a file at `path`? The error says which is missing.
[[nodiscard]] Result<> check_file(const std::filesystem::path& path);

// `count` numbers, and nothing else, out of text.
[[nodiscard]] Result<std::vector<double>> numbers(std::string_view text, std::size_t count);

[[nodiscard]] Result<RgbdCapture> open_transforms(const std::filesystem::path& file,
                                                  bool allow_outside);
[[nodiscard]] Result<RgbdCapture> open_trajectory(const std::filesystem::path& file);
[[nodiscard]] Result<RgbdCapture> open_pose_files(const std::filesystem::path& folder);

}  // namespace rilievo::rgbd
