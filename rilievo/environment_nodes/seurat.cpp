#include "rilievo/environment_nodes/seurat.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "rilievo/core/color.h"
#include "rilievo/core/file.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/io/exr_channels.h"
#include "rilievo/io/load_context.h"
#include "rilievo/io/png.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::uint64_t kMaxText = 64u << 20;
constexpr std::size_t kMaxViews = 4096;
constexpr char kConstantOne[] = "CONSTANT_ONE", kConstantZero[] = "CONSTANT_ZERO";

Error because(const std::string& reason) { return Error{"", reason}; }

const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

Result<std::string> text_of(const Json& object, const char* name) {
  const Json* found = member(object, name);
  if (!found || !found->is_string()) return because(std::string("has no text \"") + name + "\"");
  return found->get<std::string>();
}

Result<glm::dmat4> matrix_of(const Json& object, const char* name) {
  const Json* found = member(object, name);
  const Error bad = because(std::string("has no \"") + name + "\" of 16 finite numbers");
  if (!found || !found->is_array() || found->size() != 16) return bad;
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) {
    const Json& value = (*found)[std::size_t(i)];
    if (!value.is_number() || !std::isfinite(value.get<double>())) return bad;
    matrix[i % 4][i / 4] = value.get<double>();
  }
  return matrix;
}

Result<glm::dmat4> rigid(glm::dmat4 m) {
  // Homogeneous: any multiple is the same.
  if (!(std::abs(m[3][3]) > 1e-12)) return because("world_from_eye_matrix is not affine");
  m /= m[3][3];
  for (int k = 0; k < 3; ++k)
    if (std::abs(m[k][3]) > 1e-6) return because("world_from_eye_matrix is not affine");
  glm::dmat3 turn(m);
  const glm::dmat3 off = glm::transpose(turn) * turn - glm::dmat3(1.0);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      if (std::abs(off[k][j]) > 0.02)
        return because("world_from_eye_matrix is not a rotation and a place");
  if (glm::determinant(turn) < 0) return because("world_from_eye_matrix mirrors");
  // The nearest rotation, by Newton's iteration.
  for (int i = 0; i < 5; ++i) turn = 0.5 * (turn + glm::transpose(glm::inverse(turn)));
  glm::dmat4 pose(turn);
  pose[3] = glm::dvec4(glm::dvec3(m[3]), 1);
  return pose;
}

// x: (2 x / z - (R + L)) / (R - L) with tangents L and R, and so on; see clip_from_eye().
Result<Camera> lens_of(const glm::dmat4& clip) {
  const auto at = [&](int row, int column) { return clip[column][row]; };
  const Error bad = because("clip_from_eye_matrix is no projection of a camera that looks down -z");
  Camera camera;
  const double w_from_z = at(3, 2), w_constant = at(3, 3);
  for (const auto& [row, column] : {std::pair(0, 1), {1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}})
    if (std::abs(at(row, column)) > 1e-9) return bad;
  const double x = at(0, 0), y = at(1, 1);
  if (!(x > 1e-9) || !(y > 1e-9)) return bad;
  if (std::abs(w_from_z) > 1e-12 && std::abs(w_constant) < 1e-12) {
    // Divided by -z; a multiple of the matrix is the same.
    const double scale = -1 / w_from_z;
    if (scale < 0 || std::abs(at(0, 3)) > 1e-9 || std::abs(at(1, 3)) > 1e-9) return bad;
    const double shift_x = at(0, 2) * scale, shift_y = at(1, 2) * scale;
    camera.window = {(shift_x - 1) / (x * scale), (shift_x + 1) / (x * scale),
                     (shift_y - 1) / (y * scale), (shift_y + 1) / (y * scale)};
    const double a = at(2, 2) * scale, b = at(2, 3) * scale;
    camera.z_near = b / (a - 1);
    camera.z_far = std::abs(a + 1) > 1e-12 ? b / (a + 1) : 1e9;
    if (!(camera.z_far > 0) || camera.z_far > 1e9) camera.z_far = 1e9;
    if (!(camera.z_near > 0 && camera.z_near < camera.z_far)) return bad;
  } else if (std::abs(w_from_z) < 1e-12 && std::abs(w_constant) > 1e-12) {
    if (std::abs(at(0, 2)) > 1e-9 || std::abs(at(1, 2)) > 1e-9) return bad;
    const double wide = x / w_constant, high = y / w_constant;
    if (!(wide > 0) || !(high > 0)) return bad;
    const double shift_x = at(0, 3) / w_constant, shift_y = at(1, 3) / w_constant;
    camera.projection = Projection::parallel;
    camera.window = {(-1 - shift_x) / wide, (1 - shift_x) / wide, (-1 - shift_y) / high,
                     (1 - shift_y) / high};
    // The identity, as tests have it, has its planes before and behind the eye: the depths decide.
    camera.z_near = 1e-3, camera.z_far = 1e9;
    const double a = at(2, 2) / w_constant, b = at(2, 3) / w_constant;
    if (a < 0 && (1 + b) / -a > 0 && (1 - b) / -a > (1 + b) / -a)
      camera.z_near = (1 + b) / -a, camera.z_far = (1 - b) / -a;
  } else {
    return bad;
  }
  return camera;
}

// The channels of an image; constants where their name says so.
Result<std::vector<Image<float>>> load_channels(const fs::path& file,
                                                const std::vector<std::string>& names,
                                                bool linear) {
  if (file.extension() != ".png") {
    std::vector<std::string> kept;
    for (const std::string& name : names)
      if (name != kConstantOne && name != kConstantZero) kept.push_back(name);
    if (kept.empty()) return Error{file.string(), "none of its channels is used"};
    Result<std::vector<Image<float>>> loaded = load_exr_channels(file, kept);
    if (!loaded) return loaded.error();
    std::vector<Image<float>> planes;
    std::size_t next = 0;
    for (const std::string& name : names) {
      const int w = (*loaded)[0].width(), h = (*loaded)[0].height();
      if (name == kConstantOne || name == kConstantZero)
        planes.emplace_back(w, h, name == kConstantOne ? 1.0f : 0.0f);
      else
        planes.push_back(std::move((*loaded)[next++]));
    }
    return planes;
  }
  const Result<Rgba8Image> loaded = load_png(file);
  if (!loaded) return loaded.error();
  const ColorImage color = linear ? linear_from_srgb8(*loaded) : ColorImage();
  std::vector<Image<float>> planes;
  for (const std::string& name : names) {
    planes.emplace_back(loaded->width(), loaded->height(), name == kConstantOne ? 1.0f : 0.0f);
    if (name == kConstantOne || name == kConstantZero) continue;
    const std::size_t channel = std::string("RGBA").find(name);
    if (name.size() != 1 || channel == std::string::npos)
      return Error{file.string(), "has no channel " + name};
    for (std::size_t i = 0; i < planes.back().texels().size(); ++i)
      planes.back().texels()[i] = linear ? color.texels()[i][int(channel)]
                                         : float(loaded->texels()[i][int(channel)]) / 255.0f;
  }
  return planes;
}

Result<DepthImage> read_view(const Json& view, const fs::path& folder, bool allow_outside) {
  const Json* lens = member(view, "projective_camera");
  const Json* files = member(view, "depth_image_file");
  if (!lens) return because("has no \"projective_camera\"");
  const Json* color_file = files ? member(*files, "color") : nullptr;
  const Json* depth_file = files ? member(*files, "depth") : nullptr;
  if (!color_file || !depth_file)
    return because("has no \"depth_image_file\" with \"color\" and \"depth\"");
  const Result<glm::dmat4> clip = matrix_of(*lens, "clip_from_eye_matrix");
  if (!clip) return clip.error();
  const Result<glm::dmat4> pose = matrix_of(*lens, "world_from_eye_matrix");
  if (!pose) return pose.error();
  const Result<Camera> camera = lens_of(*clip);
  if (!camera) return camera.error();
  const Result<glm::dmat4> world_from_eye = rigid(*pose);
  if (!world_from_eye) return world_from_eye.error();
  DepthImage picture;
  picture.camera = *camera;
  picture.camera.world_from_eye = *world_from_eye;
  const std::pair<const char*, int*> sizes[] = {{"image_width", &picture.camera.width},
                                                {"image_height", &picture.camera.height}};
  for (const auto& [name, size] : sizes) {
    const Json* found = member(*lens, name);
    if (!found || !found->is_number_integer() || *found < 1 || *found > 1 << 14)
      return because(std::string("\"") + name + "\" is no size of an image");
    *size = found->get<int>();
  }
  const Result<std::string> kind = text_of(*lens, "depth_type");
  if (!kind) return kind.error();
  if (*kind == "WINDOW_Z")
    picture.depth_kind = DepthKind::window_z;
  else if (*kind == "RAY_DEPTH")
    picture.depth_kind = DepthKind::ray;
  else if (*kind != "EYE_Z")
    return because("\"depth_type\" is none of WINDOW_Z, EYE_Z, RAY_DEPTH");

  std::vector<std::string> names;
  for (const char* name : {"channel_0", "channel_1", "channel_2", "channel_alpha"}) {
    const Result<std::string> channel = text_of(*color_file, name);
    if (!channel) return channel.error();
    names.push_back(*channel);
  }
  const Result<std::string> depth_name = text_of(*depth_file, "channel_0");
  if (!depth_name) return depth_name.error();
  const Result<std::string> color_path = text_of(*color_file, "path");
  if (!color_path) return color_path.error();
  const Result<std::string> depth_path = text_of(*depth_file, "path");
  if (!depth_path) return depth_path.error();
  for (const std::string* image : {&*color_path, &*depth_path})
    if (!allow_outside && !lies_within(folder, manifest_path(folder, *image)))
      return because("'" + *image +
                     "' is outside of the capture's folder (--allow-outside reads it)");
  const Result<std::vector<Image<float>>> color =
      load_channels(manifest_path(folder, *color_path), names, true);
  if (!color) return color.error();
  const Result<std::vector<Image<float>>> depth =
      load_channels(manifest_path(folder, *depth_path), {*depth_name}, false);
  if (!depth) return depth.error();
  const int w = picture.camera.width, h = picture.camera.height;
  for (const auto& [planes, file] : {std::pair(&*color, &*color_path), {&*depth, &*depth_path}})
    if ((*planes)[0].width() != w || (*planes)[0].height() != h)
      return Error{(folder / *file).string(), "is " + std::to_string((*planes)[0].width()) + " x " +
                                                  std::to_string((*planes)[0].height()) +
                                                  " texels, but its camera is " +
                                                  std::to_string(w) + " x " + std::to_string(h)};

  picture.name = fs::path(*color_path).stem().string();
  picture.color = ColorImage(w, h);
  picture.depth = Image<float>(w, h, kNoDepth);
  const float most = picture.depth_kind == DepthKind::window_z ? 1.0f : 1e9f;
  for (std::size_t i = 0; i < picture.color.texels().size(); ++i) {
    glm::vec4 c((*color)[0].texels()[i], (*color)[1].texels()[i], (*color)[2].texels()[i],
                (*color)[3].texels()[i]);
    for (int k = 0; k < 4; ++k)
      if (!std::isfinite(c[k])) c[k] = 0;
    if (c.a <= 0) continue;
    const float d = (*depth)[0].texels()[i];
    picture.color.texels()[i] = c;
    if (d > 0 && d < most) picture.depth.texels()[i] = d;
  }
  if (Result<> valid = validate(picture); !valid) return because(valid.error().reason);
  return picture;
}

}  // namespace

Result<SeuratCapture> load_seurat_capture(const fs::path& path, bool allow_outside) {
  std::error_code ignored;
  const fs::path file = fs::is_directory(path, ignored) ? path / "manifest.json" : path;
  const auto error = [&](const std::string& reason) { return Error{file.string(), reason}; };
  const Result<std::string> text = read_file(file, kMaxText);
  if (!text) return text.error();
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) return error("is not valid JSON");
  SeuratCapture capture;
  if (const Json* center = member(json, "headbox_center")) {
    if (!center->is_array() || center->size() != 3)
      return error("\"headbox_center\" is not three numbers");
    for (int k = 0; k < 3; ++k) {
      if (!(*center)[std::size_t(k)].is_number())
        return error("\"headbox_center\" is not three numbers");
      capture.headbox_center[k] = (*center)[std::size_t(k)].get<double>();
    }
  }
  const Json* groups = member(json, "view_groups");
  if (!groups || !groups->is_array() || groups->empty()) return error("has no \"view_groups\"");
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups->size(); ++g) {
    const Json* views = member((*groups)[g], "views");
    if (!views || !views->is_array() || views->empty())
      return error("view group " + std::to_string(g) + " has no \"views\"");
    capture.groups.emplace_back();
    for (std::size_t v = 0; v < views->size(); ++v) {
      if (++count > kMaxViews) return error("has too many views");
      Result<DepthImage> picture = read_view((*views)[v], file.parent_path(), allow_outside);
      const std::string where = "view " + std::to_string(v) + " of group " + std::to_string(g);
      if (!picture)
        return picture.error().where.empty() ? error(where + ": " + picture.error().reason)
                                             : picture.error();
      capture.groups.back().push_back(*std::move(picture));
    }
  }
  return capture;
}

}  // namespace rilievo
