// Which objects of a scene are impostors, and who shades them?
//
//   raytrace      each object is one, with the scene around it in its shadows and reflections
//   sdf:NAME      each object gives its place and size to a field; its polygons are never drawn
//   exec:PROGRAM  one impostor, whatever the program shows, in the place of all objects
//
// Each worker has a capture source of its own, with the store in front of it.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/capture/store/kept_source.h"
#include "rilievo/relief_impostor/impostor_workers.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/scene/bend.h"

namespace rilievo {

// What is shaded, and how.
struct ImpostorContentOptions {
  std::string shader = "raytrace";  // software_shader.h
  // Names of objects of the scene, all of each name; or #0, #1, ... by index. Empty: all objects.
  std::vector<std::string> objects;
  int workers = 1;
  std::string store;  // a file; empty: none
  StoreOptions store_options = {};
  TraceOptions trace = {};
  ExecOptions exec = {};
  std::function<void(const std::string&)> warn = {};  // of the store; a line each
  // What bends the scene's meshes by time, for raytrace; null: nothing. Must outlive the content.
  // What bends is not drawn as polygons, which would stand still.
  const Deformations* deformations = nullptr;
};

// An impostor, and the scene's objects in whose place it stands.
struct ShadedImpostor {
  ImpostorObject shown;                // as the workers take it
  std::vector<std::uint32_t> objects;  // indices into Scene::objects
};

// The impostors of a scene and their sources.
struct ImpostorContent {
  std::unique_ptr<RayScene> rays;  // of raytrace
  std::vector<std::unique_ptr<CaptureSource>> shaders;
  std::unique_ptr<PictureStore> store;               // null: none
  std::vector<std::unique_ptr<KeptSource>> sources;  // one for each worker
  std::vector<ShadedImpostor> impostors;

  // The pictures of all sources.
  [[nodiscard]] std::uint64_t rendered() const;
  [[nodiscard]] std::uint64_t found() const;
};

// The objects of these names, ascending. The error names the one that is not there.
[[nodiscard]] Result<std::vector<std::uint32_t>> find_objects(
    const Scene& scene, const std::vector<std::string>& names);

// Makes them, with the scene as it is at `time` (seconds). `scene` must outlive the content. Fails
// for unknown objects and shaders, a store that cannot be opened, a program that cannot be started.
[[nodiscard]] Result<ImpostorContent> make_impostor_content(const Scene& scene, double time,
                                                            const ImpostorContentOptions& options);

}  // namespace rilievo
