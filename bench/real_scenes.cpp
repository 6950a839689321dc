#include "bench/real_scenes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "bench/random.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kPathSeconds = 60;   // a slow method walks on until it has drawn its frames
constexpr double kShotSeconds = 1.5;  // from jump to jump

// ---- models

void shift_texture(TextureUse& use, int by) {
  if (use.texture >= 0) use.texture += by;
}

// Appends all but the objects, which are returned with models and placements of `out`.
std::vector<Object> append_scene(const Scene& from, Scene& out) {
  const int image = int(out.images.size()), texture = int(out.textures.size()),
            material = int(out.materials.size()), mesh = int(out.meshes.size()),
            model = int(out.models.size());
  out.images.insert(out.images.end(), from.images.begin(), from.images.end());
  for (Texture t : from.textures) {
    t.image += image;
    out.textures.push_back(std::move(t));
  }
  for (Material m : from.materials) {
    for (TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                            &m.occlusion_texture, &m.emissive_texture})
      shift_texture(*use, texture);
    out.materials.push_back(std::move(m));
  }
  for (Mesh m : from.meshes) {
    if (m.material >= 0) m.material += material;
    out.meshes.push_back(std::move(m));
  }
  for (Model m : from.models) {
    for (Part& part : m.parts) part.mesh += mesh;
    out.models.push_back(std::move(m));
  }
  std::vector<glm::mat4> poses;
  pose(from, 0, poses);
  std::vector<Object> objects;
  for (std::size_t i = 0; i < from.objects.size(); ++i) {
    Object object;
    object.model = from.objects[i].model + model;
    object.placement = poses[i];
    objects.push_back(std::move(object));
  }
  return objects;
}

void add_ground(float half, Scene& scene) {
  Material earth;
  earth.base_color = {0.25f, 0.3f, 0.18f, 1};
  earth.roughness = 1;
  scene.materials.push_back(earth);
  Mesh ground;
  ground.material = int(scene.materials.size()) - 1;
  ground.positions = {{-half, 0, -half}, {half, 0, -half}, {half, 0, half}, {-half, 0, half}};
  ground.normals.assign(4, {0, 1, 0});
  ground.indices = {0, 2, 1, 0, 3, 2};
  scene.meshes.push_back(ground);
  Model model;
  model.parts = {{int(scene.meshes.size()) - 1, glm::mat4(1)}};
  scene.models.push_back(model);
  Object object;
  object.model = int(scene.models.size()) - 1;
  scene.objects.push_back(object);
}

// Spots on a ground, as bark or leather have.
Rgba8Image spotted_image(std::uint64_t seed) {
  constexpr int kSize = 512;
  SplitMix64 random{seed};
  Rgba8Image image(kSize, kSize, glm::u8vec4(200, 190, 170, 255));
  for (int spot = 0; spot < 600; ++spot) {
    const int x = int(random.between(0, kSize)), y = int(random.between(0, kSize));
    const int r = int(random.between(2, 14));
    const glm::ivec3 color{int(random.between(40, 255)), int(random.between(40, 220)),
                           int(random.between(30, 180))};
    for (int dy = -r; dy <= r; ++dy)
      for (int dx = -r; dx <= r; ++dx)
        if (dx * dx + dy * dy <= r * r)
          image((x + dx + kSize) % kSize, (y + dy + kSize) % kSize) = glm::u8vec4(color, 255);
  }
  return image;
}

// A built-in model one metre high on the ground, with a texture on everything.
Result<Scene> textured_builtin(const std::string& spec, std::uint64_t seed) {
  Result<BuiltinScene> made = make_builtin(spec);
  if (!made) return made.error();
  Scene scene = std::move(made->scene);
  scene.images.push_back(spotted_image(seed));
  Texture texture;
  texture.image = int(scene.images.size()) - 1;
  scene.textures.push_back(texture);
  scene.materials.emplace_back();
  for (Material& material : scene.materials)
    if (material.base_color_texture.texture < 0)
      material.base_color_texture.texture = int(scene.textures.size()) - 1;
  for (Mesh& mesh : scene.meshes) {
    if (mesh.material < 0) mesh.material = int(scene.materials.size()) - 1;
    if (!mesh.uv[0].empty()) continue;
    const float size = std::max(mesh.bounds.radius(), 1e-6f);
    for (const glm::vec3& p : mesh.positions)
      mesh.uv[0].emplace_back((p.x + 0.7f * p.z) / size, p.y / size);
  }
  const Box box = world_bounds(scene);
  const float scale = 1 / std::max(box.extent().y, 1e-6f);
  glm::mat4 place = glm::scale(glm::mat4(1), glm::vec3(scale));
  place = glm::translate(place, {-box.center().x, -box.min.y, -box.center().z});
  for (Object& object : scene.objects) object.placement = place * object.placement;
  return scene;
}

Result<std::vector<Scene>> load_all(const std::vector<fs::path>& files) {
  std::vector<Scene> scenes;
  for (const fs::path& file : files) {
    LoadOptions options;
    options.allow_outside = true;
    Result<LoadedScene> loaded = load_scene(file, options);
    if (!loaded) return loaded.error();
    scenes.push_back(std::move(loaded->scene));
  }
  return scenes;
}

Result<Scene> planted(Result<std::vector<Scene>> models, const PlantOptions& options) {
  if (!models) return models.error();
  return plant(*models, options);
}

// ---- walks

// Among things, turning; `scale` is how far ahead one looks.
RealWalk inside_walk(double height, double speed, double scale, double z_near, double z_far,
                     glm::dvec3 start = {0, 0, 0}) {
  RealWalk walk{"inside", {}};
  walk.path.z_near = z_near, walk.path.z_far = z_far;
  double gaze = 0.3;
  constexpr double kStep = 5 / kFramesPerSecond;
  for (int i = 0; i * kStep <= kPathSeconds; ++i) {
    const glm::dvec3 ahead(std::sin(gaze), 0, -std::cos(gaze));
    const glm::dvec3 eye = start + glm::dvec3(0, height, 0);
    walk.path.keys.push_back(look_key(
        i * kStep, eye, eye + scale * ahead + glm::dvec3(0, 0.02 * height, 0), {0, 1, 0}, 0.9));
    start += speed * kStep * ahead;
    gaze += 0.15 * std::sin(i / 3.0);
  }
  return walk;
}

PathKey key_around(double time, double angle, double radius, double height) {
  return look_key(time, {radius * std::cos(angle), height, radius * std::sin(angle)},
                  {0, 0.2 * height, 0}, {0, 1, 0}, 0.9);
}

// Around, looking in.
RealWalk fly_walk(double radius, double height, double z_near, double z_far) {
  RealWalk walk{"fly", {}};
  walk.path.z_near = z_near, walk.path.z_far = z_far;
  for (int i = 0; i <= int(kPathSeconds * 4); ++i)
    walk.path.keys.push_back(key_around(i / 4.0, 0.2 * i / 4.0, radius, height));
  return walk;
}

// Stands, jumps, stands.
RealWalk cut_walk(double radius, double height, double z_near, double z_far) {
  RealWalk walk{"cut", {}};
  walk.path.z_near = z_near, walk.path.z_far = z_far;
  for (int i = 0; i * kShotSeconds < kPathSeconds; ++i)
    for (const double time : {i * kShotSeconds, (i + 1) * kShotSeconds - 0.001})
      walk.path.keys.push_back(key_around(time, 1.1 * i, radius, height));
  return walk;
}

// From the middle of what there is; a person is `height` of its height tall.
std::vector<RealWalk> walks_in_the_middle(const Scene& scene, double height) {
  const Box box = world_bounds(scene);
  const double radius = double(box.radius());
  const glm::dvec3 middle(box.center().x, box.min.y, box.center().z);
  return {inside_walk(height * double(box.extent().y), 0.04 * radius, 0.2 * radius, 0.002 * radius,
                      4 * radius, middle)};
}

}  // namespace

Scene plant(std::span<const Scene> models, const PlantOptions& options) {
  Scene scene;
  std::vector<std::vector<Object>> objects;
  for (const Scene& model : models) objects.push_back(append_scene(model, scene));
  SplitMix64 random{options.seed};
  const int side = int(std::ceil(std::sqrt(double(options.count))));
  for (int i = 0; i < options.count; ++i) {
    const std::size_t which =
        std::min(std::size_t(random.next() * double(objects.size())), objects.size() - 1);
    const float angle = float(random.between(0, 6.2831853));
    const float scale = float(random.between(0.8, 1.2));
    const double x = i % side - side / 2.0 + random.between(-0.3, 0.3);
    const double z = i / side - side / 2.0 + random.between(-0.3, 0.3);
    glm::mat4 place = glm::translate(
        glm::mat4(1), {float(x * options.spacing), 0.0f, float(z * options.spacing)});
    place = glm::rotate(place, angle, {0, 1, 0});
    place = glm::scale(place, glm::vec3(scale));
    for (Object object : objects[which]) {
      object.placement = place * object.placement;
      scene.objects.push_back(std::move(object));
    }
  }
  if (options.ground > 0) add_ground(float(options.ground), scene);
  finish(scene);
  return scene;
}

namespace {

RealScene scene_of_file(const fs::path& file) {
  const auto load = [=]() -> Result<Scene> {
    Result<std::vector<Scene>> loaded = load_all({file});
    if (!loaded) return loaded.error();
    return std::move((*loaded)[0]);
  };
  const auto walks = [=](const Scene& scene) {
    std::vector<RealWalk> found;
    const std::string start = file.stem().string() + "-";
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(
             file.parent_path().empty() ? fs::path(".") : file.parent_path(), ignored)) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with(start) || entry.path().extension() != ".json") continue;
      Result<CameraPath> path = load_path(entry.path());
      if (!path) continue;
      found.push_back({entry.path().stem().string().substr(start.size()), *path});
    }
    std::sort(found.begin(), found.end(),
              [](const RealWalk& a, const RealWalk& b) { return a.name < b.name; });
    if (found.empty()) found.push_back({"orbit", orbit_path(world_bounds(scene), 3600)});
    return found;
  };
  return {file.stem().string(), load, walks};
}

}  // namespace

std::vector<RealScene> real_scenes(const fs::path& data, bool quick) {
  const bool real = !data.empty();
  const int few = quick ? 4 : 0;
  const auto count = [=](int all) { return few ? few : all; };
  const auto builtins = [](const std::vector<std::string>& specs) {
    std::vector<Scene> models;
    for (const std::string& spec : specs) {
      Result<Scene> made = textured_builtin(spec, models.size() + 1);
      if (!made) return Result<std::vector<Scene>>(made.error());
      models.push_back(std::move(*made));
    }
    return Result<std::vector<Scene>>(std::move(models));
  };
  const fs::path models = data / "models";
  std::vector<RealScene> scenes;
  scenes.push_back({"helmets",
                    [=] {
                      return planted(real ? load_all({models / "FlightHelmet/FlightHelmet.gltf"})
                                          : builtins({quick ? "builtin:teapot"
                                                            : "builtin:teapot?triangles=90000"}),
                                     {count(100), 1.2, 1, 9});
                    },
                    [](const Scene&) {
                      return std::vector<RealWalk>{inside_walk(0.85, 0.7, 1, 0.02, 30),
                                                   fly_walk(5, 2, 0.05, 40)};
                    }});
  // The beech is in centimetres.
  const double unit = real ? 700 : 1.5;
  scenes.push_back({"grove",
                    [=] {
                      return planted(real ? load_all({data / "obj/copperBeech/copperBeech.obj"})
                                          : builtins({"builtin:fern"}),
                                     {count(64), unit, 1, 5.7 * unit});
                    },
                    [=](const Scene&) {
                      return std::vector<RealWalk>{
                          inside_walk(0.17 * unit, 0.13 * unit, unit, 0.007 * unit, 17 * unit),
                          fly_walk(6 * unit, 2.1 * unit, 0.03 * unit, 21 * unit),
                          cut_walk(3.6 * unit, 0.43 * unit, 0.007 * unit, 17 * unit)};
                    }});
  scenes.push_back(
      {"town",
       [=] {
         if (!real)
           return planted(builtins({"builtin:fish", "builtin:cube", "builtin:teapot"}),
                          {count(1200), 1.8, 2, 36});
         std::vector<fs::path> files;
         for (const char* name :
              {"buildings/Building1_Large", "buildings/Building2_Small", "buildings/Building3_Big",
               "vehicles/Rover_2-transformed", "vehicles/Sail_ship", "vehicles/Tank4",
               "street_pack/Streetlight_Double", "street_pack/Streetlight_Single",
               "street_pack/Streetlight_Triple", "street_pack/Street_Bridge",
               "street_pack/Street_Bridge_Ramp", "street_pack/Street_Bridge_Underpass",
               "street_pack/Street_Bridge_Water", "street_pack/Street_Bridge_WaterRamp"})
           files.push_back(models / "quaternius" / (std::string(name) + ".glb"));
         return planted(load_all(files), {count(1200), 9, 2, 180});
       },
       [=](const Scene&) {
         const double k = real ? 1 : 0.2;
         return std::vector<RealWalk>{inside_walk(0.7, 0.6, 10 * k, 0.05, 400 * k),
                                      fly_walk(130 * k, 35 * k, 0.5 * k, 600 * k),
                                      cut_walk(70 * k, 15 * k, 0.5 * k, 600 * k)};
       }});
  if (!real) return scenes;
  for (const char* name : {"cave", "vr-gallery"}) {
    const fs::path file = models / (std::string(name) + ".glb");
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    RealScene scene = scene_of_file(file);
    scene.walks = [](const Scene& made) { return walks_in_the_middle(made, 0.4); };
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

RealScene builtin_scene(const std::string& name) {
  return {name.substr(name.find(':') + 1),
          [name]() -> Result<Scene> {
            Result<BuiltinScene> made = make_builtin(name);
            if (!made) return made.error();
            return std::move(made->scene);
          },
          [name](const Scene&) {
            const Result<BuiltinScene> made = make_builtin(name);
            return std::vector<RealWalk>{{"path", made ? made->path : CameraPath{}}};
          }};
}

std::vector<RealScene> bench_scenes(const BenchOptions& options) {
  const char* data = std::getenv("RILIEVO_DATA");
  std::vector<RealScene> own = real_scenes(data && !options.quick ? data : "", options.quick);
  if (options.scenes.empty()) return own;
  std::vector<RealScene> scenes;
  for (const std::string& name : options.scenes) {
    const auto found = std::ranges::find(own, name, &RealScene::name);
    scenes.push_back(found != own.end() ? *found
                     : is_builtin(name) ? builtin_scene(name)
                                        : scene_of_file(name));
  }
  return scenes;
}

}  // namespace rilievo::bench
