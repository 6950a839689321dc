// What do the readers of the three capture formats share? Internal to io.
#pragma once

#include <string>
#include <vector>

#include "rilievo/io/rgbd.h"

namespace rilievo::rgbd {

// The sizes beyond which a capture is refused:
inline constexpr std::size_t kMaxFrames = 100000;
inline constexpr std::uint64_t kMaxTextBytes = 256u << 20;

// The rigid motion nearest to a camera-to-world matrix. Fails with a clause that says what is wrong
// if they differ by more than 1 %.
[[nodiscard]] Result<glm::dmat4> rigid_pose(const glm::dmat4& matrix);

// The pose of a camera that looks down -z, y up, from that of one that looks down +z, y down.
[[nodiscard]] glm::dmat4 flipped_axes(const glm::dmat4& world_from_camera);

// Checks that the numbers describe a lens.
[[nodiscard]] Result<> check(const RgbdIntrinsics& intrinsics);

// Checks that there is a file at `path`; the error names it.
[[nodiscard]] Result<> check_file(const std::filesystem::path& path);

// Reads exactly `count` numbers, finite or not, from `text`, a part of `whole`. The error names the
// line of `whole`.
[[nodiscard]] Result<std::vector<double>> numbers(std::string_view whole, std::string_view text,
                                                  std::size_t count);

// Open a capture of each format; the error names the file and the reason.
[[nodiscard]] Result<RgbdCapture> open_transforms(const std::filesystem::path& file,
                                                  bool allow_outside);
[[nodiscard]] Result<RgbdCapture> open_trajectory(const std::filesystem::path& file);
[[nodiscard]] Result<RgbdCapture> open_pose_files(const std::filesystem::path& folder);

}  // namespace rilievo::rgbd
