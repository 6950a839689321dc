#include "apps/rilievo/bake_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "apps/rilievo/capture.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/program_scene.h"
#include "apps/rilievo/progress.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/late_source.h"
#include "rilievo/capture/raster_ray_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/exec_source.h"
#include "rilievo/capture/shaders/find_depth_kind.h"
#include "rilievo/capture/shaders/lit_source.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/capture/store/content_hash.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::app {
namespace {

// Is it a scene that we read? Otherwise it may be the program's own.
bool is_our_scene(const std::string& scene) {
  if (is_builtin(scene)) return true;
  std::string extension = std::filesystem::path(scene).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return char(std::tolower(c)); });
  const std::array<std::string_view, 5> known{".glb", ".gltf", ".obj", ".ply", ".stl"};
  return std::ranges::find(known, extension) != known.end();
}

// Adds a file's bytes, of any size.
Result<> add_file(ContentHash& hash, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{path, "cannot be read"};
  std::vector<char> bytes(1 << 20);
  while (file) {
    file.read(bytes.data(), std::streamsize(bytes.size()));
    hash.add(std::string_view(bytes.data(), std::size_t(file.gcount())));
  }
  return Done{};
}

// The objects that the options leave.
Result<std::vector<std::uint32_t>> chosen_objects(const Scene& scene,
                                                  const SourceOptions& options) {
  const bool only = !options.only.empty();
  const std::vector<std::string>& named = only ? options.only : options.without;
  const char* const option = only ? "--only" : "--without";
  std::vector<std::uint32_t> chosen;
  if (named.empty()) return chosen;
  for (const std::string& name : named)
    if (std::ranges::none_of(scene.objects, [&](const Object& of) { return of.name == name; })) {
      std::string known;
      for (std::size_t i = 0; i < std::min<std::size_t>(scene.objects.size(), 8); ++i)
        known += (i > 0 ? ", " : "") + scene.objects[i].name;
      return Error{option, "there is no object \"" + name + "\"; there are " + known +
                               (scene.objects.size() > 8 ? ", ..." : "")};
    }
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
    if ((std::ranges::find(named, scene.objects[i].name) != named.end()) == only)
      chosen.push_back(i);
  if (chosen.empty()) return Error{option, "leaves no object"};
  return chosen;
}

bool blends(const Scene& scene) {
  return std::ranges::any_of(scene.materials, [](const Material& material) {
    return material.alpha_mode == AlphaMode::blend;
  });
}

}  // namespace

struct BakeSource::State {
  OpenedScene opened;
  std::vector<std::uint32_t> objects;
  std::unique_ptr<gl::Context> context;
  std::optional<SceneRenderer> renderer;
  std::optional<PlacedScene> placed;
  std::optional<RayScene> rays, with_glass;
  std::unique_ptr<CaptureSource> geometry;  // of slow sources
  ProgramScene program_scene;
  std::unique_ptr<CaptureSource> light;
  KeptOptions kept;
  std::unique_ptr<KeptSource> keeping;
  LitOptions lit;
  std::unique_ptr<CaptureSource> source;
  CaptureSource* bare = nullptr;  // the source, where it is no other object's
};

BakeSource::BakeSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
BakeSource::BakeSource(BakeSource&&) noexcept = default;
BakeSource& BakeSource::operator=(BakeSource&&) noexcept = default;
BakeSource::~BakeSource() = default;

// The ray tracer, or another program.
Result<> BakeSource::open_slow(State& state, const std::string& scene, const FileLimits& limits,
                               const SourceOptions& options) {
  const bool ours = !state.opened.scene.objects.empty();
  const Scene& own = state.opened.scene;
  state.kept.exact = true;
  state.kept.warn = options.warn;
  if (!options.warn)
    state.kept.warn = [](const std::string& text) { complain("warning: " + text); };
  ContentHash content;
  if (ours) {
    content.add(content_hash(own));
    Result<RayScene> rays = RayScene::create(own);
    if (!rays) return rays.error();
    state.geometry = std::make_unique<RaySource>(state.rays.emplace(std::move(*rays)));
  }
  state.lit.samples = options.samples;
  state.lit.around_samples = options.around_samples;
  if (options.source == "raytrace") {
    const RayScene* seen = &*state.rays;
    if (blends(own)) {
      Result<RayScene> all = RayScene::create(own, 0, RayParts::all);
      if (!all) return all.error();
      seen = &state.with_glass.emplace(std::move(*all));
    }
    state.light = std::make_unique<RayTracer>(*seen);
    state.kept.shader = "raytrace 1";
  } else {
    const std::string program(program_named(options.source));
    ExecOptions exec;
    exec.world = own.world;
    exec.unmix = !ours;
    if (!options.waited_for) {
      // Machines may be cold, and scenes a film's.
      exec.limit_s = 24 * 3600;
      exec.start_limit_s = 3600;
    }
    // A bake shows by itself which picture it waits for.
    if (const auto waits = waiting_for(options.source))
      exec.waits = [waits](std::string_view what, int seconds) {
        if (what == "bounds") waits(what, seconds);
      };
    exec.noise = options.noise;
    for (const Object& object : own.objects) exec.object_names.push_back(object.name);
    exec.warn = [](const std::string& text) { complain("warning: " + text); };
    std::string opens = options.program_scene.empty() ? scene : options.program_scene;
    if (options.program_scene.empty() && ours) {
      Result<ProgramScene> made = ProgramScene::create(scene, limits, own);
      if (!made) return made.error();
      state.program_scene = *std::move(made);
      opens = state.program_scene.file();
    }
    // What is written is `own`, whose hash is there.
    if (!state.program_scene.written())
      if (Result<> read = add_file(content, opens); !read) return read;
    exec.arguments = {opens};
    // A script is part of what its pictures depend on.
    if (program.find('/') != program.npos && std::filesystem::is_regular_file(program))
      if (Result<> read = add_file(content, program); !read) return read;
    if (ours) {
      // Where all pictures are kept, the program need not even be there.
      state.light = std::make_unique<LateSource>(
          options.source, state.geometry->bounds({}), own.world,
          [program, exec]() -> Result<std::unique_ptr<CaptureSource>> {
            Result<std::unique_ptr<ExecSource>> started = ExecSource::create(program, exec);
            if (!started) return started.error();
            return std::unique_ptr<CaptureSource>(*std::move(started));
          });
    } else {
      Result<std::unique_ptr<ExecSource>> started = ExecSource::create(program, exec);
      if (!started) return started.error();
      if (options.depth_kind) {
        (*started)->set_depth_kind(*options.depth_kind);
      } else {
        const Result<DepthKind> kind = find_depth_kind(**started);
        if (!kind) return kind.error();
        (*started)->set_depth_kind(*kind);
      }
      state.light = *std::move(started);
    }
    state.lit.light = LightOf::program;
    state.kept.shader = options.source;
    if (options.noise > 0) state.kept.shader += fmt::format(" noise {}", options.noise);
    if (options.depth_kind)
      state.kept.shader += *options.depth_kind == DepthKind::ray ? " r" : " z";
  }
  state.kept.content = content.text();
  state.keeping = std::make_unique<KeptSource>(*state.light, options.keeper, state.kept);
  if (ours)
    state.source = std::make_unique<LitSource>(*state.geometry, *state.keeping, state.lit);
  else
    state.bare = state.keeping.get();
  return Done{};
}

Result<BakeSource> BakeSource::open(const std::string& scene, const FileLimits& limits,
                                    const SourceOptions& options) {
  auto state = std::make_unique<State>();
  const bool programs_own = !program_named(options.source).empty() && !is_our_scene(scene);
  const bool our_scene = !is_capture(scene) && !programs_own;
  if (!our_scene && !(options.only.empty() && options.without.empty()))
    return Error{options.only.empty() ? "--without" : "--only",
                 "is for scenes whose objects are known, and " + scene + " is none"};
  if (is_capture(scene)) {
    if (!options.source.empty())
      return Error{"--source", "is for scenes, and " + scene + " is a capture of photographs"};
    Result<PhotographSource> source = open_photographs(scene, limits);
    if (!source) return source.error();
    state->source = std::make_unique<PhotographSource>(std::move(*source));
    return BakeSource(std::move(state));
  }
  if (programs_own) {
    if (Result<> none = expect_no_units(scene, limits); !none) return none.error();
    if (Result<> opened = open_slow(*state, scene, limits, options); !opened) return opened.error();
    return BakeSource(std::move(state));
  }
  Result<OpenedScene> opened = open_scene(scene, limits);
  if (!opened) return opened.error();
  state->opened = std::move(*opened);
  const Scene& own = state->opened.scene;
  Result<std::vector<std::uint32_t>> chosen = chosen_objects(own, options);
  if (!chosen) return chosen.error();
  state->objects = *std::move(chosen);
  if (is_slow_source(options.source)) {
    if (Result<> made = open_slow(*state, scene, limits, options); !made) return made.error();
    return BakeSource(std::move(state));
  }
  // Without OpenGL rays take the pictures.
  auto context = options.source.empty() ? gl::Context::create() : Error{"", ""};
  if (context) {
    state->context = std::move(*context);
    Result<SceneRenderer> made = SceneRenderer::create(own);
    if (!made) return made.error();
    state->source = std::make_unique<OpenGLSource>(state->renderer.emplace(std::move(*made)));
    return BakeSource(std::move(state));
  }
  Result<RayScene> made = RayScene::create(own);
  if (!made) return made.error();
  const RayScene& rays = state->rays.emplace(std::move(*made));
  if (options.source == "raster")
    state->source = std::make_unique<RasterRaySource>(state->placed.emplace(own), rays);
  else
    state->source = std::make_unique<RaySource>(rays);
  return BakeSource(std::move(state));
}

CaptureSource& BakeSource::source() { return state_->bare ? *state_->bare : *state_->source; }

const std::vector<std::uint32_t>& BakeSource::objects() const { return state_->objects; }

Box BakeSource::eyes() const {
  const CameraPath* path = walk();
  return path ? eyes_of(*path, frame_count(*path)) : Box{};
}

const CameraPath* BakeSource::walk() const {
  return state_->opened.walk ? &*state_->opened.walk : nullptr;
}

SceneRenderer* BakeSource::renderer() { return state_->renderer ? &*state_->renderer : nullptr; }

std::uint64_t BakeSource::rendered() const {
  return state_->keeping ? state_->keeping->rendered() : 0;
}
std::uint64_t BakeSource::found() const { return state_->keeping ? state_->keeping->found() : 0; }
CaptureSource* BakeSource::light() { return state_->keeping.get(); }
const KeptOptions& BakeSource::kept() const { return state_->kept; }
CaptureSource* BakeSource::geometry() { return state_->geometry.get(); }

void BakeSource::replace_light(CaptureSource& light) {
  if (state_->geometry)
    state_->source = std::make_unique<LitSource>(*state_->geometry, light, state_->lit);
  else
    state_->bare = &light;
}

}  // namespace rilievo::app
