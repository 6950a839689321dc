#include "rilievo/web_walk/walk_writer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "rilievo/core/file.h"
#include "rilievo/web_walk/page_files.h"
#include "rilievo/web_walk/sha256.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;

// Half of a digest: no two contents meet by chance.
constexpr int kDigits = 32;

nlohmann::json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

nlohmann::json json_of(const glm::dmat4& matrix) {
  nlohmann::json json = nlohmann::json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) json.push_back(matrix[column][row]);
  return json;
}

nlohmann::json json_of(const Box& box) {
  return {json_of(glm::dvec3(box.min)), json_of(glm::dvec3(box.max))};
}

nlohmann::json json_of(const ImageWindow& window) {
  return {window.left, window.right, window.bottom, window.top};
}

nlohmann::json json_of(const WalkFile& file) {
  return {{"file", file.name}, {"bytes", file.bytes}};
}

nlohmann::json json_of(const WalkMesh& mesh) {
  nlohmann::json json = json_of(mesh.file);
  const auto stream = [&](const char* name, const WalkMesh::Stream& of) {
    json[name] = {{"bytes", of.bytes}, {"count", of.count}};
  };
  stream("surface_vertices", mesh.surface_vertices);
  stream("surface_indices", mesh.surface_indices);
  stream("skin_vertices", mesh.skin_vertices);
  stream("skin_indices", mesh.skin_indices);
  json["surfaces"] = mesh.surfaces;
  json["skins"] = mesh.skins;
  json["disparity_step"] = mesh.disparity_step;
  return json;
}

nlohmann::json json_of(const WalkLevel& level) {
  nlohmann::json json{{"face_size", level.face_size},
                      {"colors", json_of(level.colors)},
                      {"mesh", json_of(level.mesh)},
                      {"error_px", level.error_px},
                      {"reach", level.reach}};
  json["weights"] = json_of(level.weights);
  json["weights"]["steps"] = kWalkWeightSteps;
  json["colors"]["psnr_db"] = std::min(level.psnr_db, 100.0);
  if (!level.objects.name.empty()) json["objects"] = json_of(level.objects);
  return json;
}

nlohmann::json json_of(const WalkNode& node) {
  nlohmann::json levels = nlohmann::json::array();
  for (const WalkLevel& level : node.levels) levels.push_back(json_of(level));
  nlohmann::json json{{"world_from_node", json_of(node.world_from_node)},
                      {"covered", node.covered},
                      {"levels", levels}};
  if (!node.bounds.empty()) json["bounds"] = json_of(node.bounds);
  return json;
}

nlohmann::json json_of(const WalkPicture& picture, WalkPictures::Drawn drawn) {
  const Camera& camera = picture.camera;
  nlohmann::json json{{"world_from_eye", json_of(camera.world_from_eye)},
                      {"window", json_of(camera.window)},
                      {"size", {camera.width, camera.height}},
                      {"z_near", camera.z_near},
                      {"z_far", camera.z_far},
                      {"colors", json_of(picture.colors)},
                      {"depths", json_of(picture.depths)}};
  json["colors"]["psnr_db"] = std::min(picture.psnr_db, 100.0);
  json["depths"]["least"] = picture.least_disparity;
  json["depths"]["step"] = picture.disparity_step;
  if (drawn == WalkPictures::Drawn::nailboards) {
    json["plane_z"] = picture.plane_z;
    return json;
  }
  json["back_perspective"] = camera.keeps_farthest();
  json["complete"] = picture.complete;
  json["sees_through"] = picture.sees_through;
  json["direction"] = json_of(picture.direction);
  return json;
}

nlohmann::json json_of(const WalkPictures& pictures) {
  nlohmann::json list = nlohmann::json::array();
  for (const WalkPicture& picture : pictures.pictures)
    list.push_back(json_of(picture, pictures.drawn));
  const bool surfaces = pictures.drawn == WalkPictures::Drawn::surfaces;
  nlohmann::json json{{"drawn", surfaces ? "surfaces" : "nailboards"},
                      {"bounds", json_of(pictures.bounds)},
                      {"list", list}};
  if (!surfaces) return json;
  json["handover"] = pictures.handover;
  json["links"] = {{"gentle", pictures.links.gentle},
                   {"steepest", pictures.links.steepest},
                   {"growth", pictures.links.growth}};
  return json;
}

nlohmann::json json_of(const WalkRelief& relief) {
  nlohmann::json hull = nlohmann::json::array();
  for (const glm::dvec3& corner : relief.hull) hull.push_back(json_of(corner));
  nlohmann::json json{
      {"world_from_eye", json_of(relief.camera.world_from_eye)},
      {"projection", relief.camera.projection == Projection::parallel ? "parallel" : "perspective"},
      {"window", json_of(relief.camera.window)},
      {"size", {relief.camera.width, relief.camera.height}},
      {"plane_z", relief.plane_z},
      {"first", relief.first_d},
      {"step", relief.d_step},
      {"splat_scale", relief.splat_scale},
      {"hull", hull},
      {"samples", relief.samples},
      {"sheet", {relief.sheet_width, relief.sheet_height}},
      {"colors", json_of(relief.colors)},
      {"codes", json_of(relief.codes)},
      {"layers", json_of(relief.layers)}};
  json["colors"]["psnr_db"] = std::min(relief.psnr_db, 100.0);
  return json;
}

nlohmann::json json_of(const WalkReliefs& reliefs) {
  nlohmann::json list = nlohmann::json::array();
  for (const WalkRelief& relief : reliefs.reliefs) list.push_back(json_of(relief));
  return {{"bounds", json_of(reliefs.bounds)},
          {"splat", reliefs.splat},
          {"resolution", reliefs.resolution},
          {"max_size", reliefs.max_size},
          {"list", list}};
}

nlohmann::json json_of(const WalkManifest& walk) {
  nlohmann::json nodes = nlohmann::json::array();
  for (const WalkNode& node : walk.nodes) nodes.push_back(json_of(node));
  nlohmann::json json{{"schema", "rilievo-walk-1"},
                      {"name", walk.name},
                      {"up", json_of(walk.up)},
                      {"start",
                       {{"eye", json_of(walk.eye)},
                        {"target", json_of(walk.target)},
                        {"vertical_fov", walk.vertical_fov},
                        {"z_near", walk.z_near},
                        {"z_far", walk.z_far}}}};
  if (walk.origin != glm::dvec3(0)) json["origin"] = json_of(walk.origin);
  if (!walk.pictures.pictures.empty()) json["pictures"] = json_of(walk.pictures);
  if (!walk.reliefs.reliefs.empty()) json["reliefs"] = json_of(walk.reliefs);
  const auto color = [](const glm::vec3& c) { return json_of(glm::dvec3(c)); };
  if (walk.sky)
    json["sky"] = {{"zenith", color(walk.sky->zenith)},
                   {"horizon", color(walk.sky->horizon)},
                   {"ground", color(walk.sky->ground)}};
  if (!walk.nodes.empty()) {
    json["nodes"] = nodes;
    json["sketches"] = json_of(walk.sketches.file);
    json["sketches"]["size"] = walk.sketches.size;
    json["sketches"]["near"] = walk.sketches.near;
    json["sketches"]["far"] = walk.sketches.far;
  }
  return json;
}

bool is_walk_picture(const std::string& name) {
  return name.size() > std::size_t(kDigits) + 1 && name[kDigits] == '.' &&
         name.find_first_not_of("0123456789abcdef") == std::size_t(kDigits);
}

}  // namespace

struct WalkWriter::State {
  fs::path folder;
  std::mutex mutex;
  std::map<std::string, std::size_t> files;  // bytes, by name in the folder
  std::size_t page_bytes = 0;                // the page and the manifest
};

WalkWriter::WalkWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
WalkWriter::WalkWriter(WalkWriter&&) noexcept = default;
WalkWriter& WalkWriter::operator=(WalkWriter&&) noexcept = default;
WalkWriter::~WalkWriter() = default;

Result<WalkWriter> WalkWriter::create(const fs::path& folder) {
  std::error_code failed;
  if (fs::exists(folder, failed)) {
    if (!fs::is_directory(folder, failed)) return Error{folder.string(), "is no folder"};
    if (!fs::is_empty(folder, failed) && !fs::exists(folder / "walk.json", failed))
      return Error{folder.string(), "holds other files than a walk's: name a folder of its own"};
  }
  auto state = std::make_unique<State>();
  state->folder = folder;
  return WalkWriter(std::move(state));
}

Result<WalkFile> WalkWriter::add(std::span<const std::uint8_t> bytes, std::string_view extension) {
  const std::string name = "pictures/" + sha256_hex(bytes, kDigits) + "." + std::string(extension);
  {
    const std::lock_guard lock(state_->mutex);
    std::error_code failed;
    fs::create_directories(state_->folder / "pictures", failed);
    if (failed) return Error{state_->folder.string(), failed.message()};
    if (!state_->files.try_emplace(name, bytes.size()).second) return WalkFile{name, bytes.size()};
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (Result<> written = write_file(state_->folder / name, text); !written) return written.error();
  return WalkFile{name, bytes.size()};
}

Result<> WalkWriter::finish(const WalkManifest& manifest) {
  const std::string text =
      json_of(manifest).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  struct File {
    std::string_view name, content;
    bool needed;
  };
  std::vector<File> files;
  for (const PageFile& file : page_files()) {
    // A folder holds no live walk.
    if (file.name == "live.js") continue;
    const bool needed = (file.name != "pictures.js" || !manifest.pictures.pictures.empty()) &&
                        (file.name != "reliefs.js" || !manifest.reliefs.reliefs.empty());
    files.push_back({file.name, file.content, needed});
  }
  files.push_back({"walk.json", text, true});
  std::error_code failed;
  for (const auto& [name, content, needed] : files) {
    if (!needed) {
      fs::remove(state_->folder / name, failed);
      continue;
    }
    if (Result<> written = write_file(state_->folder / name, content); !written) return written;
    state_->files[std::string(name)] = content.size();
    state_->page_bytes += content.size();
  }
  // What an earlier walk left.
  for (const fs::directory_entry& entry :
       fs::directory_iterator(state_->folder / "pictures", failed)) {
    const std::string name = entry.path().filename().string();
    if (is_walk_picture(name) && !state_->files.contains("pictures/" + name))
      fs::remove(entry.path(), failed);
  }
  return Done{};
}

std::size_t WalkWriter::files() const { return state_->files.size(); }

std::size_t WalkWriter::bytes() const {
  std::size_t sum = 0;
  for (const auto& [name, bytes] : state_->files) sum += bytes;
  return sum;
}

std::size_t WalkWriter::first_view_bytes(const WalkManifest& manifest) const {
  std::size_t first = 0;
  double least = INFINITY;
  for (const WalkNode& node : manifest.nodes) {
    const double distance = glm::distance(glm::dvec3(node.world_from_node[3]), manifest.eye);
    if (!(distance < least)) continue;
    least = distance;
    const WalkLevel& level = node.levels[0];
    first = level.colors.bytes + level.mesh.file.bytes + level.weights.bytes;
  }
  // The page loads first the picture for its own eye.
  double most = -INFINITY;
  const WalkPictures& pictures = manifest.pictures;
  for (const WalkPicture& picture : pictures.pictures) {
    const double along =
        glm::dot(picture.direction, manifest.eye - glm::dvec3(pictures.bounds.center()));
    if (!(along > most)) continue;
    most = along;
    first = picture.colors.bytes + picture.depths.bytes;
  }
  for (const WalkRelief& relief : manifest.reliefs.reliefs) {
    const double along = glm::dot(-relief.camera.forward(),
                                  manifest.eye - glm::dvec3(manifest.reliefs.bounds.center()));
    if (!(along > most)) continue;
    most = along;
    first = relief.colors.bytes + relief.codes.bytes + relief.layers.bytes;
  }
  return state_->page_bytes + manifest.sketches.file.bytes + first;
}

}  // namespace rilievo
