#include "rilievo/environment_nodes/file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/io/stroke_attributes.h"
#include "rilievo/io/world_attributes.h"

namespace rilievo {
namespace {

constexpr const char* kRepresentation = "representation";
constexpr const char* kEnvironmentNodes = "environment-nodes";
constexpr const char* kMesh = "mesh";
constexpr double kMaxTriangles = 1e9;

std::string mesh_text(const TriangulateOptions& mesh) {
  return fmt::format("{} {} {}", mesh.triangles, mesh.error_px, mesh.reach);
}

std::optional<TriangulateOptions> mesh_from(std::string_view text) {
  double n[3] = {};
  for (double& value : n) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const auto [rest, error] = std::from_chars(text.data(), text.data() + end, value);
    if (error != std::errc() || rest != text.data() + end || !(value >= 0) || !std::isfinite(value))
      return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!text.empty() || n[0] > kMaxTriangles || n[0] != std::floor(n[0])) return std::nullopt;
  // Something must end the triangulation.
  if (n[0] == 0 && n[1] == 0) return std::nullopt;
  TriangulateOptions mesh;
  mesh.triangles = std::size_t(n[0]), mesh.error_px = n[1], mesh.reach = n[2];
  return mesh;
}

}  // namespace

Result<> save_environment_nodes(const std::filesystem::path& path, const EnvironmentNodes& nodes,
                                const WorldSpace& world) {
  FileAttributes attributes;
  store_world(world, attributes.file);
  store_strokes(nodes.strokes, attributes.file);
  attributes.file[kRepresentation] = kEnvironmentNodes;
  attributes.file[kMesh] = mesh_text(nodes.mesh);
  if (!nodes.pictures.empty()) return save_pictures(path, nodes.pictures, attributes);
  const Result<std::vector<DepthImage>> pictures = load_pictures(nodes.file);
  if (!pictures) return pictures.error();
  return save_pictures(path, *pictures, attributes);
}

bool matches_environment_nodes(const FileAttributes& attributes) {
  const auto found = attributes.file.find(kRepresentation);
  return found != attributes.file.end() && found->second == kEnvironmentNodes;
}

Result<EnvironmentNodes> open_environment_nodes(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& reason) { return Error{path.string(), reason}; };
  const Result<PictureFile> file = load_picture_file(path, {0, 0});
  if (!file) return file.error();
  if (!matches_environment_nodes(file->attributes))
    return refuse("holds no environment nodes: it does not say that its pictures are faces");
  const auto text = file->attributes.file.find(kMesh);
  if (text == file->attributes.file.end())
    return refuse("it does not say how its faces are triangulated");
  const std::optional<TriangulateOptions> mesh = mesh_from(text->second);
  if (!mesh) return refuse(fmt::format("\"{}\" is not a way to triangulate faces", text->second));
  const std::size_t count = file->pictures.size();
  if (count % 6 != 0)
    return refuse(fmt::format("its {} pictures are not six faces for each node", count));

  const Result<StrokeSize> strokes = strokes_from(file->attributes.file);
  if (!strokes) return refuse(strokes.error().reason);

  EnvironmentNodes nodes;
  nodes.strokes = *strokes;
  nodes.name = path.stem().string();
  nodes.mesh = *mesh;
  nodes.file = path;
  // load_node() wants to know how many there are.
  nodes.nodes.resize(count / 6);
  for (std::size_t i = 0; i < nodes.nodes.size(); ++i) {
    const Result<EnvironmentMap> map = load_node(nodes, i);
    if (!map) return map.error();
    nodes.nodes[i] = make_sketch(*map, nodes.nodes.size());
  }
  return nodes;
}

}  // namespace rilievo
