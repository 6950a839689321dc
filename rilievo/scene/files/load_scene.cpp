#include "rilievo/scene/files/load_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <set>

#include "rilievo/core/file.h"
#include "rilievo/io/load_context.h"
#include "rilievo/io/text_scan.h"
#include "rilievo/scene/gltf/read.h"
#include "rilievo/scene/polygons/polygon_read.h"
#include "rilievo/scene/solid_materials.h"
#include "rilievo/scene/take_as.h"

namespace rilievo {
namespace {

bool starts_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

std::string lower_extension(const std::filesystem::path& path) {
  const std::string e = lower_case(path.extension().string());
  return e.empty() ? e : e.substr(1);
}

// What a file is that cannot be a scene, by its first bytes.
const char* foreign_kind(Bytes file) {
  struct Magic {
    std::string_view bytes;
    const char* kind;
  };
  static constexpr Magic kMagics[] = {{"\x89PNG", "a PNG picture"},
                                      {"\xFF\xD8\xFF", "a JPEG picture"},
                                      {"v/1\x01", "an OpenEXR file of pictures"},
                                      {"\xABKTX", "a KTX picture"},
                                      {"DDS ", "a DDS picture"},
                                      {"PK\x03\x04", "a ZIP archive"},
                                      {"\x1F\x8B", "a gzip archive"},
                                      {"Kaydara FBX", "an FBX file"},
                                      {"SQLite format 3", "a SQLite database"},
                                      {"\x7F"
                                       "ELF",
                                       "a program"},
                                      {"%PDF", "a PDF document"},
                                      {"BLENDER", "a Blender file"}};
  for (const Magic& magic : kMagics)
    if (starts_with(file, magic.bytes)) return magic.kind;
  return nullptr;
}

// "gltf", "obj", "ply" or "stl".
std::string kind_of(Bytes file, const std::string& extension) {
  if (file.empty()) refuse("is empty");
  for (const char* splats : {"splat", "spz", "ksplat", "sog"})
    if (extension == splats || starts_with(file, "NGSP"))
      refuse(
          "holds 3-D Gaussian splats, which are no surfaces and are not drawn: make a mesh of "
          "them, or points with colours");
  if (starts_with(file, "glTF")) return "gltf";
  if (const char* kind = foreign_kind(file)) refuse(std::string("is ") + kind + ", not a scene");
  if (starts_with(file, "ply\n") || starts_with(file, "ply\r")) return "ply";
  if (extension == "glb") refuse("is not a .glb file: it does not begin with 'glTF'");
  if (extension == "gltf") return "gltf";
  if (extension == "ply") refuse("is not a PLY file: it does not begin with 'ply'");
  if (extension == "obj" || extension == "stl") return extension;
  const Bytes head = file.first(std::min<std::size_t>(file.size(), 6));
  if (lower_case({reinterpret_cast<const char*>(head.data()), head.size()}) == "solid " ||
      is_binary_stl(file))
    return "stl";
  const auto first =
      std::find_if(file.begin(), file.end(), [](std::uint8_t c) { return c > ' ' && c < 0x80; });
  if (first != file.end() && *first == '{') return "gltf";
  refuse("is of no kind that can be read (.gltf, .glb, .obj, .ply, .stl)");
}

LoadedScene read(Bytes file, const std::string& extension, const LoadOptions& options,
                 LoadContext& context) {
  const std::string kind = kind_of(file, extension);
  LoadedScene out;
  if (options.deformations) context.deformations = &out.deformations;
  out.scene = kind == "gltf"  ? read_gltf(file, context)
              : kind == "obj" ? read_obj(file, context)
              : kind == "ply" ? read_ply(file, context)
                              : read_stl(file, context);
  std::vector<int> bent;
  for (const Deformation& one : out.deformations.meshes) bent.push_back(one.mesh);
  finish_points(out.scene, options.point_size, bent);
  take_as(out.scene, options.up.value_or(UpAxis::y), options.metres_per_unit.value_or(1));
  finish(out.scene);
  if (const Result<> valid = validate(out.scene); !valid) refuse(valid.error().reason);
  make_solid_materials_opaque(out.scene);
  if (count_triangles(out.scene) == 0) refuse("has no triangles, lines or points to draw");
  const Box bounds = world_bounds(out.scene, context.time);
  if (!std::isfinite(bounds.radius())) refuse("is too large for single-precision coordinates");
  if (bounds.radius() == 0.0f) refuse("has all that it shows in one point");
  out.warnings = context.warnings.lines();
  return out;
}

Result<LoadedScene> guarded(Bytes file, const std::filesystem::path& path,
                            const LoadOptions& options, LoadContext& context) {
  const std::string where = path.string();
  try {
    context.budget.earn(file.size());
    return read(file, lower_extension(path), options, context);
  } catch (const LoadError& fault) {
    return Error{where, fault.reason};
  } catch (const std::bad_alloc&) {
    return Error{where, "needs more memory than is available"};
  } catch (const std::exception& e) {
    // A library's own complaint; none is expected that is not caught nearer to its cause.
    return Error{where, std::string("cannot be read: ") + e.what()};
  }
}

// A folder is what many a model comes in; say which file in it to name.
Error folder_error(const std::filesystem::path& path) {
  std::error_code failed;
  std::set<std::string> names;
  for (std::filesystem::directory_iterator it(path, failed), end; !failed && it != end;
       it.increment(failed)) {
    const std::string e = lower_extension(it->path());
    if (e == "gltf" || e == "glb" || e == "obj" || e == "ply" || e == "stl")
      names.insert(it->path().filename().string());
  }
  if (!names.empty())
    return {path.string(), "is a folder: name a file in it, as " + *names.begin()};
  return {path.string(),
          "is a folder without a scene (.gltf, .glb, .obj, .ply, .stl), and no capture either "
          "(transforms.json, trajectory.log, *.pose.txt)"};
}

}  // namespace

Result<LoadedScene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) return folder_error(path);
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  if (!unknown && size > options.max_bytes)
    return Error{path.string(), "has " + std::to_string(size >> 20) + " MiB, more than the " +
                                    std::to_string(options.max_bytes >> 20) +
                                    " that --memory-limit-mb allows"};
  const Result<std::string> file = read_file(path, options.max_bytes);
  if (!file) return file.error();
  LoadContext context{path.stem().string(), path.parent_path(), options.time,
                      MemoryBudget(options.max_bytes), options.allow_outside};
  return guarded(bytes_of(*file), path, options, context);
}

Result<LoadedScene> load_scene(std::span<const std::uint8_t> bytes, const std::string& name,
                               const LoadOptions& options) {
  const std::filesystem::path path(name);
  LoadContext context{path.stem().string(), {}, options.time, MemoryBudget(options.max_bytes)};
  return guarded(bytes, path, options, context);
}

}  // namespace rilievo
