#include "rilievo/scene/files/save_glb.h"

#include <algorithm>

#include "rilievo/core/file.h"
#include "rilievo/scene/gltf/glb_writer.h"

namespace rilievo {
namespace {

// What glTF takes where there is no material is a rough metal; a scene's is not. Index of the one
// that takes its place, if any mesh needs it.
int add_default_material(GlbWriter& writer, const Scene& scene) {
  const bool needed = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                  [](const Mesh& mesh) { return mesh.material < 0; });
  if (!needed) return -1;
  const Material plain;
  return writer.add("materials",
                    {{"name", "default"},
                     {"pbrMetallicRoughness",
                      {{"metallicFactor", plain.metallic}, {"roughnessFactor", plain.roughness}}}});
}

}  // namespace

Result<> save_glb(const Scene& scene, const std::filesystem::path& path) {
  if (const Result<> valid = validate(scene); !valid)
    return Error{path.string(), "cannot be written: " + valid.error().message()};
  GlbWriter writer;
  writer.json["asset"] = {{"version", "2.0"}, {"generator", "Rilievo"}};
  add_glb_materials(writer, scene);
  const int default_material = add_default_material(writer, scene);
  const std::vector<int> mesh_of_model = add_glb_meshes(writer, scene, default_material);
  const std::vector<int> roots = add_glb_nodes(writer, scene, mesh_of_model);
  add_glb_animation(writer, scene);

  GlbJson shown = GlbJson::object();
  if (!scene.name.empty()) shown["name"] = scene.name;
  if (!roots.empty()) shown["nodes"] = roots;
  writer.add("scenes", std::move(shown));
  writer.json["scene"] = 0;
  const auto pieces = writer.finish();
  if (!pieces) return Error{path.string(), pieces.error().reason};
  return write_file(path, *pieces);
}

}  // namespace rilievo
