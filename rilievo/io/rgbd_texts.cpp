// Captures whose poses are plain text: trajectory.log, and one NAME.pose.txt a frame.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "rilievo/core/file.h"
#include "rilievo/io/rgbd_open.h"
#include "rilievo/io/text_scan.h"

namespace rilievo::rgbd {
namespace {

namespace fs = std::filesystem;

// Open3D's PrimeSenseDefault.
constexpr RgbdIntrinsics kPrimeSense{525, 525, 319.5 + 0.5, 239.5 + 0.5, 0, 0, 640, 480};

// Of 16 numbers, row by row.
glm::dmat4 matrix_of_rows(std::span<const double> rows) {
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) matrix[i % 4][i / 4] = rows[std::size_t(i)];
  return matrix;
}

// The pose of a camera that looks down +z, y down.
Result<glm::dmat4> pose_of(const glm::dmat4& matrix) {
  const Result<glm::dmat4> pose = rigid_pose(matrix);
  if (!pose) return pose.error();
  return flipped_axes(*pose);
}

// Of fx 0 cx, 0 fy cy, 0 0 1, counted from the top left texel's centre.
Result<RgbdIntrinsics> lens_of(std::span<const double> rows) {
  if (!std::all_of(rows.begin(), rows.end(), [](double v) { return std::isfinite(v); }))
    return Error{"", "is a matrix that is not finite"};
  if (rows[1] != 0 || rows[3] != 0 || rows[6] != 0 || rows[7] != 0 || rows[8] != 1)
    return Error{"", "is not a matrix fx 0 cx, 0 fy cy, 0 0 1"};
  const RgbdIntrinsics lens{rows[0], rows[4], rows[2] + 0.5, rows[5] + 0.5, 0, 0, 0, 0};
  if (Result<> fine = check(lens); !fine) return fine.error();
  return lens;
}

// The images of a folder, by the numbers in their names.
Result<std::vector<fs::path>> images_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string ending = lower_case(it->path().extension().string());
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") files.push_back(it->path());
  }
  if (failed) return Error{folder.string(), failed.message()};
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return files;
}

fs::path color_folder(const fs::path& folder) {
  std::error_code ignored;
  for (const char* name : {"color", "rgb", "image"})
    if (fs::is_directory(folder / name, ignored)) return folder / name;
  return folder / "color";
}

// {"width", "height", "intrinsic_matrix": column by column}
Result<RgbdIntrinsics> read_intrinsic_json(const fs::path& file) {
  const auto error = [&](const std::string& reason) { return Error{file.string(), reason}; };
  const Result<std::string> text = read_file(file, kMaxTextBytes);
  if (!text) return text.error();
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object()) return error("is not valid JSON");
  const auto matrix = json.find("intrinsic_matrix");
  if (matrix == json.end() || !matrix->is_array() || matrix->size() != 9)
    return error("has no \"intrinsic_matrix\" of 9 numbers");
  std::array<double, 9> rows{};
  for (std::size_t i = 0; i < 9; ++i) {
    if (!(*matrix)[i].is_number()) return error("has no \"intrinsic_matrix\" of 9 numbers");
    rows[i % 3 * 3 + i / 3] = (*matrix)[i].get<double>();
  }
  Result<RgbdIntrinsics> lens = lens_of(rows);
  if (!lens) return error(lens.error().reason);
  for (const auto& [name, size] : {std::pair("width", &lens->width), {"height", &lens->height}}) {
    const auto found = json.find(name);
    if (found == json.end()) continue;
    if (!found->is_number_integer() || *found < 1 || *found > 1 << 16)
      return error(std::string("\"") + name + "\" is no size of an image");
    *size = found->get<int>();
  }
  if (std::string fault = read_distortion({&json}, lens->distortion); !fault.empty())
    return error(fault);
  return lens;
}

}  // namespace

Result<RgbdCapture> open_trajectory(const fs::path& file) {
  const auto error = [&](const std::string& reason) { return Error{file.string(), reason}; };
  const fs::path folder = file.parent_path();
  const Result<std::string> text = read_file(file, kMaxTextBytes);
  if (!text) return text.error();
  const Result<std::vector<fs::path>> colors = images_in(color_folder(folder));
  if (!colors) return colors.error();
  const Result<std::vector<fs::path>> depths = images_in(folder / "depth");
  if (!depths) return depths.error();
  if (colors->size() != depths->size())
    return error("there are " + std::to_string(colors->size()) + " colour images but " +
                 std::to_string(depths->size()) + " of depth beside it");
  RgbdIntrinsics lens = kPrimeSense;
  for (const char* name : {"camera_intrinsic.json", "intrinsic.json"}) {
    std::error_code ignored;
    if (!fs::exists(folder / name, ignored)) continue;
    const Result<RgbdIntrinsics> read = read_intrinsic_json(folder / name);
    if (!read) return read.error();
    lens = *read;
    break;
  }

  RgbdCapture capture{RgbdFormat::redwood, {}};
  std::string_view left = *text;
  for (std::size_t at = 0; !trimmed(left).empty(); ++at) {
    const std::string entry = "entry " + std::to_string(at) + ": ";
    const char* begin = left.data();
    for (int line = 0; line < 5;) {
      const std::optional<std::string_view> next = take_line(left);
      if (!next) return error(entry + "has fewer than five lines");
      if (trimmed(*next).empty()) continue;
      ++line;
    }
    const std::string_view block(begin, std::size_t(left.data() - begin));
    const Result<std::vector<double>> values = numbers(*text, block, 3 + 16);
    if (!values) return error(entry + values.error().reason);
    const double index = (*values)[0];
    if (!(index >= 0 && index < double(colors->size()) && index == std::floor(index)))
      return error(entry + "there is no image for it: " + std::to_string(colors->size()) +
                   " are there");
    const glm::dmat4 matrix = matrix_of_rows(std::span(*values).subspan(3));
    const Result<glm::dmat4> pose = pose_of(matrix);
    if (is_lost(matrix)) {
      capture.warnings.add(entry + pose.error().reason + "; it is left out");
      continue;
    }
    if (!pose) return error(entry + pose.error().reason);
    if (capture.frames.size() == kMaxFrames) return error("has too many frames");
    const std::size_t i = std::size_t(index);
    RgbdFrame& frame = capture.frames.emplace_back();
    frame.name = (*colors)[i].stem().string();
    frame.color = (*colors)[i];
    frame.depth = (*depths)[i];
    frame.world_from_eye = *pose;
    frame.intrinsics = lens;
  }
  return capture;
}

Result<RgbdCapture> open_pose_files(const fs::path& folder) {
  const fs::path lens_file = folder / "camera-intrinsics.txt";
  const Result<std::string> lens_text = read_file(lens_file, kMaxTextBytes);
  if (!lens_text) return lens_text.error();
  const Result<std::vector<double>> lens_values = numbers(*lens_text, *lens_text, 9);
  if (!lens_values) return Error{lens_file.string(), lens_values.error().reason};
  const Result<RgbdIntrinsics> lens = lens_of(*lens_values);
  if (!lens) return Error{lens_file.string(), lens.error().reason};

  constexpr std::string_view kPose = ".pose.txt";
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string file = it->path().filename().string();
    if (file.ends_with(kPose)) names.push_back(file.substr(0, file.size() - kPose.size()));
    if (names.size() > kMaxFrames) return Error{folder.string(), "has too many frames"};
  }
  if (failed) return Error{folder.string(), failed.message()};
  std::sort(names.begin(), names.end(), comes_before);

  RgbdCapture capture{RgbdFormat::pose_files, {}};
  for (const std::string& name : names) {
    const fs::path file = folder / (name + std::string(kPose));
    const Result<std::string> text = read_file(file, kMaxTextBytes);
    if (!text) return text.error();
    const Result<std::vector<double>> values = numbers(*text, *text, 16);
    if (!values) return Error{file.string(), values.error().reason};
    const glm::dmat4 matrix = matrix_of_rows(*values);
    const Result<glm::dmat4> pose = pose_of(matrix);
    if (is_lost(matrix)) {
      capture.warnings.add("'" + file.filename().string() + "': " + pose.error().reason +
                           "; the frame is left out");
      continue;
    }
    if (!pose) return Error{file.string(), pose.error().reason};
    fs::path color = folder / (name + ".color.png");
    std::error_code ignored;
    if (!fs::exists(color, ignored) && fs::exists(folder / (name + ".color.jpg"), ignored))
      color = folder / (name + ".color.jpg");
    RgbdFrame& frame = capture.frames.emplace_back();
    frame.name = name;
    frame.color = color;
    frame.depth = folder / (name + ".depth.png");
    if (fs::exists(folder / (name + ".mask.png"), ignored))
      frame.mask = folder / (name + ".mask.png");
    frame.world_from_eye = *pose;
    frame.intrinsics = *lens;
  }
  return capture;
}

}  // namespace rilievo::rgbd
