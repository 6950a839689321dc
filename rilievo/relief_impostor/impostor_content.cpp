#include "rilievo/relief_impostor/impostor_content.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "rilievo/capture/shaders/posed_tracer.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/capture/store/content_hash.h"
#include "rilievo/core/file.h"
#include "rilievo/relief_impostor/impostor_motion.h"

namespace rilievo {
namespace {

// A field in the place of each of several objects.
class PlacedFields final : public CaptureSource {
 public:
  explicit PlacedFields(std::string name) : name_(std::move(name)) {}
  void place(std::uint32_t object, const DistanceField& field, const FieldLook& look) {
    fields_.push_back({object, FieldShader(field, look)});
  }

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override {
    Box all;
    for (const Placed& placed : fields_)
      if (objects.empty() || std::count(objects.begin(), objects.end(), placed.object))
        all.add(placed.shader.bounds({}));
    return all;
  }
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    if (request.objects.size() != 1) return Error{name_, "shows one object at a time"};
    for (Placed& placed : fields_)
      if (placed.object == request.objects[0]) {
        CaptureRequest one = request;
        one.objects = {};
        return placed.shader.capture(one);
      }
    return Error{name_, "does not stand for this object"};
  }

 private:
  struct Placed {
    std::uint32_t object;
    FieldShader shader;
  };
  std::string name_;
  std::vector<Placed> fields_;
};

// In the middle of the object's bounds, as large as fits into them.
FieldLook look_in(const Box& place, const DistanceField& field) {
  const glm::vec3 room = place.max - place.min, own = field.bounds.max - field.bounds.min;
  FieldLook look;
  look.scale = double(std::min({room.x / own.x, room.y / own.y, room.z / own.z}));
  look.center = glm::dvec3(place.center()) -
                look.scale * 0.5 * glm::dvec3(field.bounds.min + field.bounds.max);
  return look;
}

bool bends(const ImpostorContentOptions& options) {
  return options.deformations && !options.deformations->meshes.empty();
}

template <class T>
void add_values(const std::vector<T>& values, ContentHash& hash) {
  hash.add(
      std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
}

void add_channel(const Channel& channel, ContentHash& hash) {
  hash.add(std::to_string(channel.node) + ' ' + std::to_string(int(channel.path)) + ' ' +
           std::to_string(int(channel.interpolation)));
  add_values(channel.times, hash);
  add_values(channel.values, hash);
}

void add_deformations(const Deformations& all, ContentHash& hash) {
  add_values(all.rig.nodes, hash);
  for (const Channel& channel : all.rig.channels) add_channel(channel, hash);
  for (const Deformation& one : all.meshes) {
    hash.add(std::to_string(one.mesh));
    add_values(one.positions, hash);
    add_values(one.normals, hash);
    add_values(one.tangents, hash);
    add_values(one.corners, hash);
    add_values(one.joints, hash);
    add_values(one.first_influence, hash);
    add_values(one.influences, hash);
    for (const Deformation::Target& target : one.targets) {
      hash.add(std::to_string(target.weight));
      add_values(target.positions, hash);
      add_values(target.normals, hash);
      add_values(target.tangents, hash);
      add_channel(target.weights, hash);
    }
  }
}

constexpr std::uint64_t kMaxFileBytes = std::uint64_t(1) << 30;
constexpr std::uint64_t kMaxArgumentBytes = std::uint64_t(64) << 20;

// The file that posix_spawnp() starts: without a slash, the first along PATH that may be executed.
Result<std::filesystem::path> find_program(const std::string& program) {
  if (program.find('/') != std::string::npos) return std::filesystem::path(program);
  const char* set = std::getenv("PATH");
  std::string_view folders = set ? set : "/bin:/usr/bin";
  while (true) {
    const std::size_t colon = folders.find(':');
    const std::filesystem::path file = std::filesystem::path(folders.substr(0, colon)) / program;
    std::error_code none;
    if (std::filesystem::is_regular_file(file, none) && ::access(file.c_str(), X_OK) == 0)
      return file;
    if (colon == std::string_view::npos) return Error{program, "is no program along PATH"};
    folders.remove_prefix(colon + 1);
  }
}

// A scene's own hash does not say what the program or the field shows.
Result<std::string> content_of(const Scene& scene, double time,
                               const ImpostorContentOptions& options,
                               const std::vector<Box>& places) {
  const std::string_view shader = options.shader;
  ContentHash hash;
  if (shader == "raytrace") {
    Result<std::string> own = content_hash(scene, time);
    if (!own || !bends(options)) return own;
    hash.add(*own);
    add_deformations(*options.deformations, hash);
    return hash.text();
  }
  if (shader.starts_with("sdf:")) {
    for (const Box& box : places)
      for (int k = 0; k < 3; ++k)
        hash.add(std::to_string(box.min[k]) + ' ' + std::to_string(box.max[k]));
    return hash.text();
  }
  // The program's own bytes, and those of the files that it is given: another version of one of
  // them is another content.
  const Result<std::filesystem::path> program = find_program(std::string(program_named(shader)));
  if (!program) return program.error();
  const Result<std::string> bytes = read_file(*program, kMaxFileBytes);
  if (!bytes) return bytes.error();
  hash.add(*bytes);
  for (const std::string& argument : options.exec.arguments) {
    hash.add(argument);
    std::error_code none;
    if (!std::filesystem::is_regular_file(argument, none)) continue;
    // Of what is large, and may be the scene that the program reads, size and time must do.
    if (const Result<std::string> given = read_file(argument, kMaxArgumentBytes); given) {
      hash.add(*given);
    } else {
      hash.add(std::to_string(std::filesystem::file_size(argument, none)));
      hash.add(std::to_string(
          std::filesystem::last_write_time(argument, none).time_since_epoch().count()));
    }
  }
  return hash.text();
}

std::string shader_of(const ImpostorContentOptions& options) {
  // Changed where the same options make other pictures: they are not in older stores.
  const std::string version = " texel rule";
  if (options.shader != "raytrace") return options.shader + version;
  const TraceOptions& t = options.trace;
  return "raytrace " + std::to_string(t.bounces) + ' ' + std::to_string(t.light_samples) + ' ' +
         std::to_string(t.sun_degrees) + ' ' + std::to_string(t.light_radius) + ' ' +
         std::to_string(t.seed) + version;
}

Box placed_bounds(const Scene& scene, std::uint32_t object, std::span<const glm::mat4> poses) {
  const Model& model = scene.models[std::size_t(scene.objects[object].model)];
  return model.parts.empty() ? Box() : transformed(poses[object], model.bounds);
}

}  // namespace

std::uint64_t ImpostorContent::rendered() const {
  std::uint64_t sum = 0;
  for (const auto& source : sources) sum += source->rendered();
  return sum;
}

std::uint64_t ImpostorContent::found() const {
  std::uint64_t sum = 0;
  for (const auto& source : sources) sum += source->found();
  return sum;
}

Result<std::vector<std::uint32_t>> find_objects(const Scene& scene,
                                                const std::vector<std::string>& names) {
  const auto count = std::uint32_t(scene.objects.size());
  std::vector<bool> named(count, names.empty());
  for (const std::string& name : names) {
    bool found = false;
    for (std::uint32_t i = 0; i < count; ++i)
      if (scene.objects[i].name == name) named[i] = found = true;
    std::uint32_t index = 0;
    const char *begin = name.data() + 1, *end = name.data() + name.size();
    if (!found && name.size() > 1 && name[0] == '#') {
      const auto [at, error] = std::from_chars(begin, end, index);
      if (error == std::errc() && at == end && index < count) named[index] = found = true;
    }
    if (!found)
      return Error{"object '" + name + "'", "is not in the scene, which has " +
                                                std::to_string(count) +
                                                " objects: give the name of one, or #0, #1, ..."};
  }
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < count; ++i)
    if (named[i]) objects.push_back(i);
  return objects;
}

Result<ImpostorContent> make_impostor_content(const Scene& scene, double time,
                                              const ImpostorContentOptions& options) {
  RILIEVO_EXPECTS(options.workers >= 1);
  if (Result<> known = check_shader(options.shader); !known) return known.error();
  const Result<std::vector<std::uint32_t>> objects = find_objects(scene, options.objects);
  if (!objects) return objects.error();
  const bool traces = options.shader == "raytrace", runs = !program_named(options.shader).empty();

  ImpostorContent content;
  Result<RayScene> rays = RayScene::create(scene, time, RayParts::all);
  if (!rays) return rays.error();
  content.rays = std::make_unique<RayScene>(std::move(*rays));
  std::vector<DeformationBounds> bounds;  // by model
  if (traces && bends(options)) bounds = deformation_bounds(scene, *options.deformations);
  std::vector<Box> places;
  for (const std::uint32_t object : *objects) {
    const Box place = placed_bounds(scene, object, content.rays->poses());
    if (runs || place.empty()) continue;
    places.push_back(place);
    ShadedImpostor& impostor = content.impostors.emplace_back();
    impostor.shown.objects = impostor.objects = {object};
    impostor.shown.drawable = traces;
    if (!traces || !bends(options)) continue;
    set_deformation(scene, bounds, time, impostor.shown);
    if (impostor.shown.deforms > 0) impostor.shown.drawable = false;
  }
  if (runs) {
    ShadedImpostor& impostor = content.impostors.emplace_back();
    impostor.shown.drawable = !objects->empty();
    impostor.objects = *objects;
  }

  if (!options.store.empty()) {
    Result<PictureStore> store = PictureStore::open(options.store, options.store_options);
    if (!store) return store.error();
    content.store = std::make_unique<PictureStore>(std::move(*store));
  }
  KeptOptions kept{"", shader_of(options), options.warn};
  if (content.store) {
    Result<std::string> hash = content_of(scene, time, options, places);
    if (!hash) return hash.error();
    kept.content = *std::move(hash);
  }
  for (int worker = 0; worker < options.workers; ++worker) {
    if (options.shader.starts_with("sdf:")) {
      const DistanceField& field = *find_distance_field(options.shader.substr(4));
      auto fields = std::make_unique<PlacedFields>(options.shader);
      for (std::size_t i = 0; i < places.size(); ++i)
        fields->place(content.impostors[i].objects[0], field, look_in(places[i], field));
      content.shaders.push_back(std::move(fields));
    } else if (traces && bends(options)) {
      Result<std::unique_ptr<PosedTracer>> tracer =
          PosedTracer::create(scene, *options.deformations, bounds, time, options.trace);
      if (!tracer) return tracer.error();
      content.shaders.push_back(*std::move(tracer));
    } else {
      ExecOptions exec = options.exec;
      exec.world = scene.world;
      Result<std::unique_ptr<CaptureSource>> shader =
          make_shader(options.shader, {content.rays.get(), options.trace, {}, exec});
      if (!shader) return shader.error();
      content.shaders.push_back(*std::move(shader));
    }
    content.sources.push_back(
        std::make_unique<KeptSource>(*content.shaders.back(), content.store.get(), kept));
    kept.warn = {};  // one warning is enough
  }
  return content;
}

}  // namespace rilievo
