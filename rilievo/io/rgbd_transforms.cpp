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

// The number of a frame's own member, or else of the file's.
std::optional<double> number_in(const Json& file, const Json& frame, const char* name) {
  for (const Json* object : {&frame, &file})
    if (const auto found = object->find(name); found != object->end() && !found->is_null())
      return found->is_number() ? found->get<double>() : std::nan("");
  return {};
}

// A frame's own text; empty if there is none.
std::string text_in(const Json& frame, const char* name) {
  const auto found = frame.find(name);
  return found != frame.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Python writes numbers that are not finite as words, which JSON has not: as null.
std::string with_null(std::string text) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted && text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (!quoted) {
      for (const std::string_view word : {"-Infinity", "Infinity", "-NaN", "NaN", "-nan", "nan"})
        if (std::string_view(text).substr(i).starts_with(word)) {
          text.replace(i, word.size(), "null");
          break;
        }
    }
  }
  return text;
}

// The path of an image, which may be written without its ending.
fs::path image_at(const fs::path& folder, const std::string& relative) {
  const fs::path path = manifest_path(folder, relative);
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
      const bool lost = row[c].is_null() || row[c].is_string();
      if (!row[c].is_number() && !lost) return std::nullopt;
      matrix[int(c)][int(r)] = lost ? std::nan("") : row[c].get<double>();
    }
  }
  return matrix;
}

// One clause; nothing if the frame is fine. `lost`: its camera was not found.
std::string read_frame(const Json& file, const Json& json, const fs::path& folder, RgbdFrame& frame,
                       bool& lost) {
  if (!json.is_object()) return "is not an object";
  const std::optional<glm::dmat4> matrix = matrix_of(json);
  if (!matrix) return "\"transform_matrix\" is not 4 rows of 4 numbers";
  lost = is_lost(*matrix);
  for (const char* name : {"file_path", "depth_file_path"})
    if (text_in(json, name).empty()) return std::string("there is no \"") + name + "\"";
  frame.color = image_at(folder, text_in(json, "file_path"));
  frame.depth = manifest_path(folder, text_in(json, "depth_file_path"));
  frame.name = frame.color.stem().string();
  if (const std::string mask = text_in(json, "mask_path"); !mask.empty())
    frame.mask = image_at(folder, mask);
  if (std::string fault = read_lens({&json, &file}, frame.intrinsics); !fault.empty()) return fault;
  frame.metres_per_unit =
      number_in(file, json, "integer_depth_scale")
          .value_or(number_in(file, json, "depth_unit_scale_factor").value_or(0.001));
  if (!(frame.metres_per_unit > 0 && frame.metres_per_unit < 1e6))
    return "the unit of depth is not a positive number";
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
  Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) json = Json::parse(with_null(*text), nullptr, false);
  if (!json.is_object()) return error("is not valid JSON");
  const auto frames = json.find("frames");
  if (frames == json.end() || !frames->is_array()) return error("has no list \"frames\"");
  if (frames->size() > kMaxFrames) return error("has too many frames");
  RgbdCapture capture{RgbdFormat::nerfstudio, {}};
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const std::string name = "frame " + std::to_string(i) + ": ";
    RgbdFrame frame;
    bool lost = false;
    const std::string fault = read_frame(json, (*frames)[i], file.parent_path(), frame, lost);
    if (lost) {
      capture.warnings.add(name + fault + "; it is left out");
      continue;
    }
    if (!fault.empty()) return error(name + fault);
    for (const fs::path& image : {frame.color, frame.depth, frame.mask})
      if (!image.empty() && !allow_outside && !lies_within(file.parent_path(), image))
        return error(name + "'" + image.string() +
                     "' is outside of the capture's folder (--allow-outside reads it)");
    capture.frames.push_back(std::move(frame));
  }
  return capture;
}

}  // namespace rilievo::rgbd
