// What do the readers of the three capture formats share? Internal to io.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
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

// Is a matrix that of a camera that was not found: not finite, or singular? Its frame is left out.
[[nodiscard]] bool is_lost(const glm::dmat4& matrix);

// Orders names as people count: "frame 2" before "frame 10".
[[nodiscard]] bool comes_before(const std::string& a, const std::string& b);

// The mask beside an image without one of its own.
void find_mask(RgbdFrame& frame);

// Reads a lens from members of JSON objects, of which the first that has one counts. Returns a
// clause about what is wrong, or nothing.
[[nodiscard]] std::string read_lens(std::initializer_list<const nlohmann::json*> objects,
                                    RgbdIntrinsics& lens);
// The distortion alone.
[[nodiscard]] std::string read_distortion(std::initializer_list<const nlohmann::json*> objects,
                                          LensDistortion& distortion);

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
