#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "rilievo/core/file.h"
#include "rilievo/io/load_context.h"
#include "rilievo/io/rgbd_open.h"

namespace rilievo::rgbd {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A frame's own members come before those of the file.
struct Members {
  const Json& file;
  const Json& frame;
  std::string fault;

  [[nodiscard]] const Json* find(const char* name) const {
    for (const Json* object : {&frame, &file})
      if (const auto found = object->find(name); found != object->end() && !found->is_null())
        return &*found;
    return nullptr;
  }
  double number(const char* name, double otherwise) {
    const Json* found = find(name);
    if (!found) return otherwise;
    if (found->is_number() && std::isfinite(found->get<double>())) return found->get<double>();
    if (fault.empty()) fault = std::string("\"") + name + "\" is not a finite number";
    return otherwise;
  }
  int texels(const char* name) {
    const double value = number(name, 0);
    if (value >= 0 && value <= (1 << 16) && value == std::floor(value)) return int(value);
    if (fault.empty()) fault = std::string("\"") + name + "\" is no size of an image";
    return 0;
  }
  std::string text(const char* name) {
    const auto found = frame.find(name);
    if (found != frame.end() && found->is_string()) return found->get<std::string>();
    if (fault.empty()) fault = std::string("there is no \"") + name + "\"";
    return {};
  }
};

// The path of an image, which may be written without its ending.
fs::path image_at(const fs::path& folder, const std::string& relative) {
  const fs::path path = folder / relative;
  if (path.has_extension()) return path;
  std::error_code ignored;
  for (const char* ending : {".png", ".jpg", ".jpeg"}) {
    fs::path with = path;
    with += ending;
    if (fs::is_regular_file(with, ignored)) return with;
  }
  return path;
}

std::optional<glm::dmat4> matrix_of(const Json& frame) {
  const auto found = frame.find("transform_matrix");
  if (found == frame.end() || !found->is_array() || found->size() < 3 || found->size() > 4)
    return std::nullopt;
  glm::dmat4 matrix(1.0);
  for (std::size_t r = 0; r < found->size(); ++r) {
    const Json& row = (*found)[r];
    if (!row.is_array() || row.size() != 4) return std::nullopt;
    for (std::size_t c = 0; c < 4; ++c) {
      // JSON has no NaN; writers that have one put null or a word.
      if (!row[c].is_number()) return std::nullopt;
      matrix[int(c)][int(r)] = row[c].get<double>();
    }
  }
  return matrix;
}

// One clause; nothing if the frame is fine.
std::string read_frame(const Json& file, const Json& json, const fs::path& folder,
                       RgbdFrame& frame) {
  if (!json.is_object()) return "is not an object";
  Members members{file, json, {}};
  frame.color = image_at(folder, members.text("file_path"));
  frame.depth = folder / members.text("depth_file_path");
  frame.name = frame.color.stem().string();

  RgbdIntrinsics& lens = frame.intrinsics;
  lens.angle_x = members.number("camera_angle_x", 0);
  lens.fl_x = members.number("fl_x", kNone);
  if (!members.find("fl_x") && !members.find("camera_angle_x"))
    return "there is neither \"fl_x\" nor \"camera_angle_x\"";
  lens.fl_y = members.number("fl_y", kNone);
  lens.cx = members.number("cx", kNone);
  lens.cy = members.number("cy", kNone);
  lens.width = members.texels("w");
  lens.height = members.texels("h");
  frame.metres_per_unit =
      members.number("integer_depth_scale", members.number("depth_unit_scale_factor", 0.001));
  for (const char* name : {"k1", "k2", "k3", "k4", "p1", "p2"})
    if (members.number(name, 0) != 0)
      return std::string("the lens is distorted (\"") + name +
             "\" is not 0), which is not supported: undistort the images first";
  if (const Json* model = members.find("camera_model"))
    if (!model->is_string() ||
        (*model != "OPENCV" && *model != "PINHOLE" && *model != "SIMPLE_PINHOLE"))
      return "\"camera_model\" is none of OPENCV, PINHOLE, SIMPLE_PINHOLE";
  if (!members.fault.empty()) return members.fault;
  if (!(frame.metres_per_unit > 0 && frame.metres_per_unit < 1e6))
    return "the unit of depth is not a positive number";
  if (Result<> fine = check(lens); !fine) return fine.error().reason;

  const std::optional<glm::dmat4> matrix = matrix_of(json);
  if (!matrix) return "\"transform_matrix\" is not 4 rows of 4 numbers";
  const Result<glm::dmat4> pose = rigid_pose(*matrix);
  if (!pose) return pose.error().reason;
  frame.world_from_eye = *pose;
  return {};
}

}  // namespace

Result<RgbdCapture> open_transforms(const fs::path& file, bool allow_outside) {
  const auto error = [&](const std::string& reason) { return Error{file.string(), reason}; };
  const Result<std::string> text = read_file(file, kMaxTextBytes);
  if (!text) return text.error();
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) return error("is not valid JSON");
  const auto frames = json.find("frames");
  if (frames == json.end() || !frames->is_array()) return error("has no list \"frames\"");
  if (frames->size() > kMaxFrames) return error("has too many frames");
  RgbdCapture capture{RgbdFormat::nerfstudio, {}};
  for (const Json& each : *frames) {
    RgbdFrame frame;
    const std::string fault = read_frame(json, each, file.parent_path(), frame);
    if (!fault.empty())
      return error("frame " + std::to_string(capture.frames.size()) + ": " + fault);
    for (const fs::path& image : {frame.color, frame.depth})
      if (!allow_outside && !lies_within(file.parent_path(), image))
        return error("frame " + std::to_string(capture.frames.size()) + ": '" + image.string() +
                     "' is outside of the capture's folder (--allow-outside reads it)");
    capture.frames.push_back(std::move(frame));
  }
  return capture;
}

}  // namespace rilievo::rgbd
