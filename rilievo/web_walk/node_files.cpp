#include "rilievo/web_walk/node_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/web_walk/dilate.h"
#include "rilievo/web_walk/pack_mesh.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/webp.h"

namespace rilievo {
namespace {

constexpr int kSheetColumns = 3;
// Codes of a sketch's distances (WalkSketches).
constexpr double kSketchSteps = 65533;

// Six faces of n x n texels in one picture, each with its bottom row first. `texel` is called with
// a face and a place in it.
template <typename Texel>
auto make_sheet(int n, const Texel& texel) {
  Image<decltype(texel(0, 0, 0))> sheet(kSheetColumns * n, 6 / kSheetColumns * n);
  for (int f = 0; f < 6; ++f)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        sheet(f % kSheetColumns * n + x, f / kSheetColumns * n + n - 1 - y) = texel(f, x, y);
  return sheet;
}

Result<Image<std::uint16_t>> object_sheet(const EnvironmentMap& map) {
  for (const DepthImage& face : map.faces) {
    if (face.object.empty()) return Error{"", "its pictures have no identifiers"};
    if (std::ranges::max(face.object.texels()) > 0xFFFF)
      return Error{"", "it has more than 65535 objects to identify"};
  }
  return make_sheet(map.faces[0].camera.width, [&](int f, int x, int y) {
    return std::uint16_t(map.faces[std::size_t(f)].object(x, y));
  });
}

Image<std::uint16_t> weight_sheet(const NodeMesh& mesh) {
  return make_sheet(mesh.face_size, [&](int f, int x, int y) {
    const int weight = mesh.weights[std::size_t(f)](x, y);
    return std::uint16_t((weight * kWalkWeightSteps + 127) / 255);
  });
}

Result<WalkLevel> write_level(const EnvironmentMap& map, const TriangulateOptions& mesh_options,
                              WalkWriter& writer, const WalkOptions& options) {
  WalkLevel level;
  level.face_size = map.faces[0].camera.width;
  TriangulateStats stats;
  const NodeMesh mesh = triangulate(map, mesh_options, &stats);
  level.reach = stats.reach;
  PackedMesh packed = pack_mesh(mesh, disparity_step(mesh, options.rounding_px, stats.reach));
  level.mesh = packed.mesh;
  level.error_px =
      stats.worst_error_px + 0.25 * packed.mesh.disparity_step * stats.reach * level.face_size;
  Result<WalkFile> mesh_file = writer.add(packed.bytes, "bin");
  if (!mesh_file) return mesh_file.error();
  level.mesh.file = std::move(*mesh_file);

  const Result<WebpFile> colors = encode_webp(face_sheet(map), {options.least_psnr_db});
  if (!colors) return colors.error();
  level.psnr_db = colors->psnr_db;
  Result<WalkFile> color_file = writer.add(colors->bytes, "webp");
  if (!color_file) return color_file.error();
  level.colors = std::move(*color_file);
  Result<WalkFile> weight_file = writer.add(encode_plane16(weight_sheet(mesh)), "bin");
  if (!weight_file) return weight_file.error();
  level.weights = std::move(*weight_file);
  if (!options.objects) return level;
  const Result<Image<std::uint16_t>> objects = object_sheet(map);
  if (!objects) return objects.error();
  Result<WalkFile> object_file = writer.add(encode_plane16(*objects), "bin");
  if (!object_file) return object_file.error();
  level.objects = std::move(*object_file);
  return level;
}

Result<WalkNode> write_node(const EnvironmentNodes& nodes, std::size_t i, WalkWriter& writer,
                            const WalkOptions& options) {
  const Result<EnvironmentMap> map = load_node(nodes, i);
  if (!map) return map.error();
  const NodeSketch& sketch = nodes.nodes[i];
  WalkNode node;
  node.world_from_node = sketch.world_from_node;
  node.covered = sketch.covered;
  node.bounds = sketch.bounds;
  const int factor = sketch.face_size / options.coarse_face;
  std::vector<EnvironmentMap> levels;
  if (factor > 1 && sketch.face_size % factor == 0) levels.push_back(coarser(*map, factor));
  levels.push_back(*map);
  for (const EnvironmentMap& of : levels) {
    TriangulateOptions mesh = nodes.mesh;
    const int fewer = sketch.face_size / of.faces[0].camera.width;
    // A budget shrinks as silhouettes do.
    mesh.triangles = mesh.triangles / std::size_t(fewer);
    Result<WalkLevel> level = write_level(of, mesh, writer, options);
    if (!level) return Error{fmt::format("node {}", i), level.error().message()};
    node.levels.push_back(std::move(*level));
  }
  return node;
}

Result<WalkSketches> write_sketches(const EnvironmentNodes& nodes, WalkWriter& writer) {
  constexpr int kSize = NodeSketch::kSize;
  double near = INFINITY, far = 0;
  for (const NodeSketch& node : nodes.nodes)
    for (const Image<float>& face : node.distance)
      for (const float d : face.texels())
        if (d > 0 && std::isfinite(d))
          near = std::min(near, double(d)), far = std::max(far, double(d));
  if (!(far > near)) {
    near = std::isfinite(near) ? near : 1;
    far = 2 * near;
  }
  WalkSketches sketches;
  sketches.size = kSize;
  sketches.near = near;
  sketches.far = far;
  Image<std::uint16_t> plane(kSize, int(nodes.nodes.size()) * 6 * kSize);
  int row = 0;
  for (const NodeSketch& node : nodes.nodes)
    for (const Image<float>& face : node.distance)
      for (int y = 0; y < kSize; ++y, ++row)
        for (int x = 0; x < kSize; ++x) {
          const float d = face(x, y);
          plane(x, row) =
              !(d > 0) ? std::uint16_t(0)
              : !std::isfinite(d)
                  ? std::uint16_t(0xFFFF)
                  : std::uint16_t(1 + std::lround(kSketchSteps * std::log(double(d) / near) /
                                                  std::log(far / near)));
        }
  Result<WalkFile> file = writer.add(encode_plane16(plane), "bin");
  if (!file) return file.error();
  sketches.file = std::move(*file);
  return sketches;
}

}  // namespace

EnvironmentMap coarser(const EnvironmentMap& map, int factor) {
  EnvironmentMap small;
  small.name = map.name;
  for (std::size_t f = 0; f < 6; ++f) {
    const DepthImage& from = map.faces[f];
    DepthImage& to = small.faces[f];
    const int n = from.camera.width / factor;
    to.name = from.name;
    to.camera = from.camera;
    to.camera.width = to.camera.height = n;
    to.depth_kind = from.depth_kind;
    to.color = ColorImage(n, n);
    to.depth = Image<float>(n, n);
    if (!from.object.empty()) to.object = Image<std::uint32_t>(n, n);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        glm::vec4 sum(0.0f);
        for (int j = 0; j < factor; ++j)
          for (int i = 0; i < factor; ++i) sum += from.color(x * factor + i, y * factor + j);
        to.color(x, y) = sum / float(factor * factor);
        const int u = x * factor + factor / 2, v = y * factor + factor / 2;
        // A texel shows as a whole what its middle shows, or nothing.
        if (from.color(u, v).a == 0) to.color(x, y) = glm::vec4(0.0f);
        to.depth(x, y) = from.depth(u, v);
        if (!from.object.empty()) to.object(x, y) = from.object(u, v);
      }
  }
  return small;
}

Rgba8Image face_sheet(const EnvironmentMap& map) {
  std::array<Rgba8Image, 6> faces;
  for (std::size_t f = 0; f < 6; ++f) {
    faces[f] = srgb8_from_linear(map.faces[f].color);
    dilate_colors(faces[f]);
  }
  return make_sheet(map.faces[0].camera.width,
                    [&](int f, int x, int y) { return faces[std::size_t(f)](x, y); });
}

Result<> add_nodes(const EnvironmentNodes& nodes, WalkWriter& writer, WalkManifest& manifest,
                   const WalkOptions& options) {
  const std::size_t count = nodes.nodes.size();
  std::vector<std::optional<Result<WalkNode>>> written(count);
  std::mutex mutex;
  int done = 0;
  parallel_for(std::size_t(0), count, [&](std::size_t i) {
    written[i].emplace(write_node(nodes, i, writer, options));
    const std::lock_guard lock(mutex);
    if (options.progress) options.progress(++done, int(count));
  });
  for (std::optional<Result<WalkNode>>& node : written) {
    if (!*node) return node->error();
    manifest.nodes.push_back(std::move(**node));
  }
  Result<WalkSketches> sketches = write_sketches(nodes, writer);
  if (!sketches) return sketches.error();
  manifest.sketches = std::move(*sketches);
  manifest.sky = nodes.sky();
  return Done{};
}

}  // namespace rilievo
