// Nodes as captures for Seurat, and back.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/seurat.h"
#include "rilievo/io/exr_channels.h"

namespace rilievo {

// Six views at one point as a node, with its faces in order. The views are square, 90 degrees wide,
// one for each direction, with any rotation about their axes. Texels are copied, not interpolated.
[[nodiscard]] inline Result<EnvironmentMap> environment_from_views(
    const std::vector<DepthImage>& views) {
  if (views.size() != 6)
    return Error{"", "a node has six views, not " + std::to_string(views.size())};
  const int n = views[0].camera.width;
  const std::array<Camera, 6> cameras = environment_cameras(
      views[0].camera.position(), n, views[0].camera.z_near, views[0].camera.z_far);
  EnvironmentMap map;
  std::array<bool, 6> taken{};
  for (const DepthImage& view : views) {
    std::size_t f = 0;
    while (f < 6 && glm::dot(view.camera.forward(), cameras[f].forward()) < 1 - 1e-4) ++f;
    if (f == 6) return Error{view.name, "does not look along an axis, as a node's face must"};
    if (taken[f]) return Error{view.name, "looks where another view does"};
    taken[f] = true;
    const ImageWindow& w = view.camera.window;
    if (view.camera.width != n || view.camera.height != n)
      return Error{view.name, "is not square or differs in size from the first view"};
    for (const double side : {-w.left, w.right, -w.bottom, w.top})
      if (std::abs(side - 1) > 1e-4) return Error{view.name, "is not 90 degrees wide and high"};
    if (glm::distance(view.camera.position(), cameras[f].position()) > 1e-4)
      return Error{view.name, "was taken from another point than the first view"};
    DepthImage& face = map.faces[f];
    face.name = view.name;
    face.camera = cameras[f];
    face.camera.z_near = view.camera.z_near, face.camera.z_far = view.camera.z_far;
    face.depth_kind = view.depth_kind;
    face.color = ColorImage(n, n);
    face.depth = Image<float>(n, n, kNoDepth);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const glm::dvec3 at = world_from_raster(face.camera, {x + 0.5, y + 0.5}, 1.0);
        const glm::dvec3 raster = raster_from_world(view.camera, at);
        const int u = glm::clamp(int(raster.x), 0, n - 1), v = glm::clamp(int(raster.y), 0, n - 1);
        face.color(x, y) = view.color(u, v);
        face.depth(x, y) = view.depth(u, v);
      }
  }
  if (Result<> valid = validate_environment(map); !valid) return valid.error();
  return map;
}

// Writes manifest.json and two OpenEXR files for each face into `folder`, which is created. Depths
// are EYE_Z.
[[nodiscard]] inline Result<> save_seurat_capture(const std::filesystem::path& folder,
                                                  const EnvironmentMap& map) {
  if (Result<> valid = validate_environment(map); !valid)
    return Error{folder.string(), valid.error().message()};
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return Error{folder.string(), failed.message()};
  const auto rows = [](const glm::dmat4& m) {
    nlohmann::json out = nlohmann::json::array();
    for (int i = 0; i < 16; ++i) out.push_back(m[i % 4][i / 4]);
    return out;
  };
  nlohmann::json views = nlohmann::json::array();
  for (std::size_t f = 0; f < 6; ++f) {
    const DepthImage& face = map.faces[f];
    const std::string name = "face" + std::to_string(f);
    const int n = face.camera.width;
    std::vector<Image<float>> planes(5, Image<float>(n, n));
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        for (int k = 0; k < 4; ++k) planes[std::size_t(k)](x, y) = face.color(x, y)[k];
        planes[4](x, y) = face.covered(x, y) ? float(eye_z_from(face.depth_kind, face.depth(x, y),
                                                                face.camera, {x + 0.5, y + 0.5}))
                                             : 0.0f;
      }
    const std::string channels[] = {"R", "G", "B", "A"}, depth[] = {"R"};
    if (Result<> saved =
            save_exr_channels(folder / (name + "_color.exr"), channels, std::span(planes).first(4));
        !saved)
      return saved;
    if (Result<> saved =
            save_exr_channels(folder / (name + "_depth.exr"), depth, std::span(planes).subspan(4));
        !saved)
      return saved;
    views.push_back({{"projective_camera",
                      {{"image_width", n},
                       {"image_height", n},
                       {"clip_from_eye_matrix", rows(clip_from_eye(face.camera))},
                       {"world_from_eye_matrix", rows(face.camera.world_from_eye)},
                       {"depth_type", "EYE_Z"}}},
                     {"depth_image_file",
                      {{"color",
                        {{"path", name + "_color.exr"},
                         {"channel_0", "R"},
                         {"channel_1", "G"},
                         {"channel_2", "B"},
                         {"channel_alpha", "A"}}},
                       {"depth", {{"path", name + "_depth.exr"}, {"channel_0", "R"}}}}}});
  }
  const glm::dvec3 center = map.faces[0].camera.position();
  const nlohmann::json manifest = {{"headbox_center", {center.x, center.y, center.z}},
                                   {"view_groups", {{{"views", views}}}}};
  return write_file(folder / "manifest.json", manifest.dump(1) + "\n");
}

}  // namespace rilievo
