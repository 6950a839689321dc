#include "rilievo/io/rgbd_open.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/io/text_scan.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;

constexpr char kPose[] = ".pose.txt";

bool has_pose_files(const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    if (it->path().filename().string().ends_with(kPose)) return true;
  return false;
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

}  // namespace

namespace rgbd {

Result<glm::dmat4> rigid_pose(const glm::dmat4& matrix) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(matrix[c][r])) return Error{"", "the pose is not finite"};
  for (int c = 0; c < 4; ++c)
    if (std::abs(matrix[c][3] - (c == 3 ? 1.0 : 0.0)) > 1e-6)
      return Error{"", "the pose's last row is not 0 0 0 1"};
  // Far beyond any place on Earth, and far from where squares overflow.
  if (glm::length(glm::dvec3(matrix[3])) > 1e9) return Error{"", "the pose is out of range"};
  const double kSlack = 0.01;
  const glm::dmat3 axes(matrix);
  const glm::dmat3 gram = glm::transpose(axes) * axes;
  double off = 0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) off = std::max(off, std::abs(gram[c][r] - (c == r ? 1.0 : 0.0)));
  const double determinant = glm::determinant(axes);
  if (std::abs(determinant) < 1e-12) return Error{"", "the pose's matrix is singular"};
  // Twice: lengths enter squared. Not `off > `: infinite entries make NaN.
  if (!(off <= 2 * kSlack)) return Error{"", "the pose's axes are not orthonormal to 1 %"};
  if (determinant < 0) return Error{"", "the pose mirrors"};
  // Newton's iteration for the orthogonal factor of the polar decomposition, the nearest rotation;
  // its error is squared each time, from 1e-2 to below 1e-15 in three.
  glm::dmat3 rotation = axes;
  if (off > 1e-12)
    for (int i = 0; i < 4; ++i)
      rotation = 0.5 * (rotation + glm::transpose(glm::inverse(rotation)));
  glm::dmat4 rigid(rotation);
  rigid[3] = glm::dvec4(glm::dvec3(matrix[3]), 1);
  return rigid;
}

bool is_lost(const glm::dmat4& matrix) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(matrix[c][r])) return true;
  return std::abs(glm::determinant(glm::dmat3(matrix))) < 1e-12;
}

bool comes_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  // A run of digits without its leading zeros; the longer one is the larger number.
  const auto take_run = [&](const std::string& text, std::size_t& at) {
    while (at < text.size() && text[at] == '0') ++at;
    const std::size_t begin = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    return std::string_view(text).substr(begin, at - begin);
  };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string_view x = take_run(a, i), y = take_run(b, k);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else if (a[i] != b[k]) {
      return std::uint8_t(a[i]) < std::uint8_t(b[k]);
    } else {
      ++i, ++k;
    }
  }
  if (a.size() - i != b.size() - k) return a.size() - i < b.size() - k;
  return a < b;
}

void find_mask(RgbdFrame& frame) {
  const fs::path folder = frame.color.parent_path();
  const std::string stem = frame.color.stem().string(), name = frame.color.filename().string();
  for (const char* masks : {"masks", "mask"})
    for (const std::string& file : {stem + ".png", name + ".png", stem + ".jpg"})
      if (const fs::path mask = folder.parent_path() / masks / file;
          mask != frame.color && is_file(mask)) {
        frame.mask = mask;
        return;
      }
  if (const fs::path mask = folder / ("dynamic_mask_" + stem + ".png"); is_file(mask)) {
    frame.mask = mask;
    frame.mask_is_dark = false;
  }
}

glm::dmat4 flipped_axes(const glm::dmat4& world_from_camera) {
  return {world_from_camera[0], -world_from_camera[1], -world_from_camera[2], world_from_camera[3]};
}

Result<> check(const RgbdIntrinsics& lens) {
  const auto positive = [](double v) { return v > 1e-3 && v < 1e7; };
  for (const auto& [length, angle] :
       {std::pair(lens.fl_x, lens.angle_x), {lens.fl_y, lens.angle_y}}) {
    if (!std::isnan(length) && !positive(length))
      return Error{"", "the focal length is not a positive number"};
    if (std::isnan(length) && angle != 0 && !(angle > 1e-3 && angle < 3.1))
      return Error{"", "the angle of view is not between 0 and pi"};
  }
  for (double c : {lens.cx, lens.cy})
    if (std::abs(c) > 1e7) return Error{"", "the principal point is out of range"};
  if (lens.width < 0 || lens.height < 0 || lens.width > (1 << 16) || lens.height > (1 << 16))
    return Error{"", "the image size is not between 1 and 65536"};
  return Done{};
}

Result<> check_file(const fs::path& path) {
  if (is_file(path)) return Done{};
  return Error{path.string(), "is missing, or is no file"};
}

Result<std::vector<double>> numbers(std::string_view whole, std::string_view text,
                                    std::size_t count) {
  std::vector<double> values;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    const std::optional<double> value = number_of(word);
    if (!value) return Error{"", line_name(whole, word.data()) + " " + no_number(word)};
    if (values.size() == count)
      return Error{"", "holds more than " + std::to_string(count) + " numbers"};
    values.push_back(*value);
  }
  if (values.size() != count)
    return Error{"", "does not hold " + std::to_string(count) + " numbers"};
  return values;
}

}  // namespace rgbd

bool is_rgbd_capture(const fs::path& path) {
  if (is_folder(path))
    return is_file(path / "transforms.json") || is_file(path / "trajectory.log") ||
           has_pose_files(path);
  const std::string name = path.filename().string();
  return name == "transforms.json" || name.ends_with(".log");
}

Result<RgbdCapture> open_rgbd_capture(const fs::path& path, bool allow_outside) {
  Result<RgbdCapture> capture = [&]() -> Result<RgbdCapture> {
    if (!is_folder(path)) {
      if (Result<> there = rgbd::check_file(path); !there) return there.error();
      return path.extension() == ".log" ? rgbd::open_trajectory(path)
                                        : rgbd::open_transforms(path, allow_outside);
    }
    if (is_file(path / "transforms.json"))
      return rgbd::open_transforms(path / "transforms.json", allow_outside);
    if (is_file(path / "trajectory.log")) return rgbd::open_trajectory(path / "trajectory.log");
    if (has_pose_files(path)) return rgbd::open_pose_files(path);
    return Error{path.string(),
                 "is no capture: it holds no transforms.json, trajectory.log or *.pose.txt"};
  }();
  if (!capture) return capture;
  if (capture->frames.empty()) {
    const std::vector<std::string> lines = capture->warnings.lines();
    return Error{path.string(), lines.empty() ? "is a capture without frames"
                                              : "has no frame that can be used: " + lines[0]};
  }
  for (RgbdFrame& frame : capture->frames) {
    if (frame.mask.empty()) rgbd::find_mask(frame);
    if (Result<> there = rgbd::check_file(frame.color); !there) return there.error();
    if (Result<> there = rgbd::check_file(frame.depth); !there) return there.error();
    if (frame.mask.empty()) continue;
    if (Result<> there = rgbd::check_file(frame.mask); !there) return there.error();
  }
  return capture;
}

}  // namespace rilievo
