#include "apps/rilievo/methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <span>
#include <utility>

#include "apps/rilievo/checks.h"
#include "apps/rilievo/machine.h"
#include "apps/rilievo/progress.h"
#include "rilievo/cache/cpu/memory_cache.h"
#include "rilievo/cache/gl/image_cache.h"
#include "rilievo/cache/gl/impostor_frames.h"
#include "rilievo/cache/gl/picture_frames.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/frame/cpu/software_chosen_frames.h"
#include "rilievo/frame/cpu/software_frames.h"
#include "rilievo/frame/cpu/software_level_frames.h"
#include "rilievo/frame/cpu/software_stored_frames.h"
#include "rilievo/frame/gl/chosen_frames.h"
#include "rilievo/frame/gl/level_frames.h"
#include "rilievo/frame/gl/processor_frames.h"
#include "rilievo/frame/gl/stored_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/raster/raster_renderer.h"
#include "rilievo/render/rays/ray_renderer.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/representation/cpu/software_factories.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

constexpr std::size_t kMegabyte = std::size_t(1) << 20;

// A kind with its options for baking and drawing, and its factory.
struct PreparedKind {
  OptionValues bake, draw;
  std::unique_ptr<DrawableFactory> factory;
};

Result<PreparedKind> prepare(const KindMethod& method, const MethodOptions& options,
                             std::span<const DrawableRow> rows = drawable_rows()) {
  KindOptions values = options.kinds;
  apply(method, values);
  Result<OptionValues> bake = bake_values(*method.kind, values);
  if (!bake) return bake.error();
  Result<OptionValues> draw = draw_values(*method.kind, values);
  if (!draw) return draw.error();
  Result<std::unique_ptr<DrawableFactory>> factory = make_factory(rows, method.kind->name);
  if (!factory) return factory.error();
  return PreparedKind{std::move(*bake), std::move(*draw), std::move(*factory)};
}

// Objects to bake before the first frame.
ObjectDrawablesOptions object_options(const PreparedKind& kind, std::size_t max_bytes,
                                      Progress& progress) {
  ObjectDrawablesOptions objects{kind.bake, kind.draw};
  objects.max_bytes = max_bytes;
  objects.progress = [&](int done, int total) { progress.show(done, total); };
  return objects;
}

// Does a kind of --bake-as stand for what lies around the eyes?
bool surrounds(const std::string& name) {
  return kind_method(name).kind->stands_for == StandsFor::surroundings;
}

// What the cache's alternatives are baked from, and what draws them.
struct BakeFrom {
  const PlacedScene& placed;
  CaptureSource& source;
  std::span<const DrawableRow> rows;
};

// What lies far around the eyes, as one.
template <class Cache>
Result<> add_surroundings(Cache& cache, const KindMethod& method, const MethodOptions& options,
                          const BakeFrom& from) {
  Result<PreparedKind> kind = prepare(method, options, from.rows);
  if (!kind) return kind.error();
  Progress progress("view");
  SurroundingsOptions surroundings{kind->bake, kind->draw, options.eyes};
  surroundings.beyond =
      options.bake_beyond.value_or(0.1 * double(world_bounds(from.placed.scene()).radius()));
  surroundings.progress = [&](int done, int total) { progress.show(done, total); };
  Result<ObjectDrawable> made = bake_surroundings_drawable(from.placed, from.source, *method.kind,
                                                           *kind->factory, surroundings);
  if (!made) return made.error();
  cache.add_surroundings(std::move(made->drawable), std::move(kind->factory),
                         std::move(made->objects));
  return Done{};
}

// The kinds of --bake-as share --bake-mb evenly.
template <class Cache>
Result<> add_alternatives(Cache& cache, const MethodOptions& options, const BakeFrom& from) {
  if (std::count_if(options.bake_as.begin(), options.bake_as.end(), surrounds) > 1)
    return Error{"--bake-as", "names more than one kind of surroundings"};
  if (options.bake_together && (options.bake_as.size() > 1 || surrounds(options.bake_as[0])))
    return Error{"--bake-together", "is for one kind of objects"};
  const std::size_t each = std::size_t(options.bake_mb) * kMegabyte / options.bake_as.size();
  for (const std::string& name : options.bake_as) {
    const KindMethod method = kind_method(name);
    if (surrounds(name)) {
      if (Result<> added = add_surroundings(cache, method, options, from); !added) return added;
      continue;
    }
    Result<PreparedKind> prepared = prepare(method, options, from.rows);
    if (!prepared) return prepared.error();
    Progress progress("view");
    const ObjectDrawablesOptions objects = object_options(*prepared, each, progress);
    if (options.bake_together) {
      Result<ObjectDrawable> one = bake_together_drawable(from.placed, from.source, *method.kind,
                                                          *prepared->factory, objects);
      if (!one) return one.error();
      cache.add_surroundings(std::move(one->drawable), std::move(prepared->factory),
                             std::move(one->objects));
      continue;
    }
    Result<std::vector<ObjectDrawable>> drawables =
        bake_object_drawables(from.placed, from.source, *method.kind, *prepared->factory, objects);
    if (!drawables) return drawables.error();
    cache.add_alternatives(std::move(*drawables), std::move(prepared->factory));
  }
  return Done{};
}

Result<> expect_memory(const MethodOptions& options) {
  if (options.bake_mb < options.memory_mb) return Done{};
  return Error{"--bake-mb", "must be less than --memory-mb, so that pictures get memory, too"};
}

ImageCacheOptions cache_options(const MethodOptions& options, int samples) {
  ImageCacheOptions cache;
  cache.error_px = options.error_px;
  cache.gap_px = options.gap_px;
  cache.max_bytes = std::size_t(options.memory_mb - options.bake_mb) * kMegabyte;
  cache.capture_ms = options.capture_ms;
  cache.max_spike = options.max_spike;
  cache.levels = options.levels;
  if (!options.fade) cache.fade_frames = 1;
  cache.delta_bits = options.delta_bits;
  cache.depth_mode = depth_mode(options);
  cache.samples = samples;
  cache.outlines = options.outlines;
  cache.machine = options.machine;
  return cache;
}

Result<std::unique_ptr<FrameSource>> make_cache(const MethodOptions& options, int samples,
                                                SceneRenderer& renderer) {
  if (Result<> enough = expect_memory(options); !enough) return enough.error();
  Result<ImageCache> made = ImageCache::create(renderer, cache_options(options, samples));
  if (!made && made.error().where == "machine") return Error{"--machine", made.error().reason};
  if (!made && made.error().where == "levels") return Error{"--levels", made.error().reason};
  if (!made) return made.error();
  if (options.bake_mb > 0) {
    OpenGLSource source(renderer);
    const BakeFrom from{renderer.placed(), source, drawable_rows()};
    if (Result<> added = add_alternatives(*made, options, from); !added) return added.error();
  }
  return {std::make_unique<ImageCache>(std::move(*made))};
}

// The same without OpenGL.
Result<std::unique_ptr<FrameSource>> make_software_cache(const MethodOptions& options, int samples,
                                                         const Scene& scene) {
  if (Result<> enough = expect_memory(options); !enough) return enough.error();
  Result<std::unique_ptr<MemoryCache>> made =
      MemoryCache::create(scene, cache_options(options, samples));
  if (!made) return Error{"--memory-mb", made.error().reason};
  if (options.bake_mb > 0) {
    Result<RayScene> rays = RayScene::create(scene);
    if (!rays) return rays.error();
    RaySource source(*rays);
    const PlacedScene placed(scene);
    const BakeFrom from{placed, source, software_drawable_rows()};
    if (Result<> added = add_alternatives(**made, options, from); !added) return added.error();
  }
  return {std::move(*made)};
}

SurroundingFramesOptions surroundings_options(const PreparedKind& kind,
                                              const MethodOptions& options, Progress& progress) {
  return {kind.bake, kind.draw, options.eyes,
          [&](int done, int total) { progress.show(done, total); }};
}

ObjectFramesOptions object_frames_options(const PreparedKind& kind, const MethodOptions& options,
                                          Progress& progress) {
  return {object_options(kind, std::size_t(options.memory_mb) * kMegabyte, progress),
          options.texel_px, options.outlines};
}

// Surroundings: all that stands still by one bake, what moves as polygons. Objects: each heavy one
// by a bake of its own.
Result<std::unique_ptr<FrameSource>> make_kind(const KindMethod& method,
                                               const MethodOptions& options,
                                               SceneRenderer& renderer) {
  Result<PreparedKind> kind = prepare(method, options);
  if (!kind) return kind.error();
  Progress progress("view");
  Result<std::unique_ptr<ChosenFrames>> frames =
      method.kind->stands_for == StandsFor::surroundings
          ? make_surrounding_frames(renderer, *method.kind, std::move(kind->factory),
                                    surroundings_options(*kind, options, progress))
          : make_object_frames(renderer, *method.kind, std::move(kind->factory),
                               object_frames_options(*kind, options, progress));
  if (!frames) return frames.error();
  return {std::move(*frames)};
}

// The same without OpenGL.
Result<std::unique_ptr<FrameSource>> make_software_kind(const KindMethod& method,
                                                        const MethodOptions& options, int samples,
                                                        const Scene& scene) {
  Result<PreparedKind> kind = prepare(method, options, software_drawable_rows());
  if (!kind) return kind.error();
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  RaySource source(*rays);
  Progress progress("view");
  const bool surroundings = method.kind->stands_for == StandsFor::surroundings;
  const auto as_chooser = [](auto made) -> Result<std::unique_ptr<FrameChooser>> {
    if (!made) return made.error();
    return {std::move(*made)};
  };
  Result<std::unique_ptr<SoftwareChosenFrames>> frames = SoftwareChosenFrames::create(
      scene, samples, options.outlines && !surroundings, [&](const PlacedScene& placed) {
        return surroundings ? as_chooser(SurroundingChooser::create(
                                  placed, source, *method.kind, std::move(kind->factory),
                                  surroundings_options(*kind, options, progress)))
                            : as_chooser(ObjectChooser::create(
                                  placed, source, *method.kind, std::move(kind->factory),
                                  object_frames_options(*kind, options, progress)));
      });
  if (!frames) return frames.error();
  return {std::move(*frames)};
}

Result<std::unique_ptr<FrameSource>> make_pictures(DepthMode mode, const MethodOptions& options,
                                                   int samples, SceneRenderer& renderer) {
  PictureFramesOptions pictures;
  pictures.mode = mode;
  pictures.delta_bits = options.delta_bits;
  pictures.max_angle = glm::radians(options.angle_degrees);
  pictures.outlines = options.outlines;
  pictures.max_bytes = std::size_t(options.memory_mb) * kMegabyte;
  pictures.samples = samples;
  Result<PictureFrames> made = PictureFrames::create(renderer, pictures);
  if (!made) return made.error();
  return {std::make_unique<PictureFrames>(std::move(*made))};
}

// All polygons, drawn by processors without OpenGL.
Result<std::unique_ptr<FrameSource>> make_processor(std::unique_ptr<FrameRenderer> processor,
                                                    int samples, SceneRenderer& renderer) {
  Result<std::unique_ptr<ProcessorFrames>> made =
      ProcessorFrames::create(renderer, std::move(processor), samples);
  if (!made) return made.error();
  return {std::move(*made)};
}

// Methods that are no kind's: drawn from pictures that are captured while the eye moves, or from
// none.
struct BuiltinMethod {
  const char* name;
  Result<std::unique_ptr<FrameSource>> (*make)(const MethodOptions&, int samples, SceneRenderer&);
};
constexpr BuiltinMethod kBuiltin[] = {
    {"direct",
     [](const MethodOptions&, int, SceneRenderer& renderer) {
       return Result<std::unique_ptr<FrameSource>>(std::make_unique<DirectFrames>(renderer));
     }},
    {"direct-raster",
     [](const MethodOptions&, int samples, SceneRenderer& renderer) {
       return make_processor(std::make_unique<RasterRenderer>(renderer.scene()), samples, renderer);
     }},
    {"direct-rays",
     [](const MethodOptions&, int samples, SceneRenderer& renderer) {
       Result<std::unique_ptr<RayRenderer>> rays = RayRenderer::create(renderer.scene());
       return rays ? make_processor(std::move(*rays), samples, renderer) : rays.error();
     }},
    {"lod",
     [](const MethodOptions& options, int, SceneRenderer& renderer) {
       Result<std::unique_ptr<LevelFrames>> made =
           LevelFrames::create(make_object_levels(renderer.scene()), options.error_px);
       return made ? Result<std::unique_ptr<FrameSource>>(std::move(*made)) : made.error();
     }},
    {"flat",
     [](const MethodOptions& options, int samples, SceneRenderer& renderer) {
       return make_pictures(DepthMode::flat, options, samples, renderer);
     }},
    {"nailboard",
     [](const MethodOptions& options, int samples, SceneRenderer& renderer) {
       return make_pictures(depth_mode(options), options, samples, renderer);
     }},
    {"cache", make_cache},
    {kReliefImpostorName.data(),
     [](const MethodOptions& options, int, SceneRenderer& renderer) {
       return make_impostor_frames(options.impostors, options.outlines, renderer);
     }},
};

std::vector<std::string_view> surroundings_kinds() {
  std::vector<std::string_view> names;
  for (const Kind* kind : kinds())
    if (kind->stands_for == StandsFor::surroundings) names.push_back(kind->name);
  return names;
}

// The drawable uses the factory's shaders: both in one.
class StoredSource final : public FrameSource {
 public:
  StoredSource(std::unique_ptr<DrawableFactory> factory, std::unique_ptr<Drawable> drawable,
               const Instance& instance, bool outlines, SceneRenderer& sky)
      : factory_(std::move(factory)), frames_(sky, std::move(drawable), {instance}, outlines) {}

  Result<> draw(const Camera& camera, double time) override { return frames_.draw(camera, time); }
  Result<> draw_objects() override { return frames_.draw_objects(); }
  [[nodiscard]] const FrameStats& stats() const override { return frames_.stats(); }

 private:
  std::unique_ptr<DrawableFactory> factory_;
  StoredFrames frames_;
};

}  // namespace

void add_method_options(CLI::App& command, MethodOptions& options) {
  command
      .add_option("--delta-bits", options.delta_bits,
                  "Bits of a picture's depth (Delta) per texel (default 8)")
      ->check(CLI::IsMember({2, 4, 6, 8, 16}));
  command.add_option("--depth", options.depth, "How nailboards write depth (default exact)")
      ->check(CLI::IsMember({"exact", "linear"}));
  command.add_flag("--outlines", options.outlines,
                   "Outline everything that is drawn from a picture");
  command
      .add_option(
          "--draw", options.draw,
          "What draws the frames: opengl, software (without OpenGL: cache, direct-raster, lod, "
          "relief-impostor, kinds, files), or automatic: software where OpenGL runs "
          "on processors or is missing (default)")
      ->check(CLI::IsMember({"opengl", "software", "automatic"}));
  command
      .add_option(
          "--angle", options.angle_degrees,
          "flat, nailboard: capture a picture again after its object has moved by this angle, as "
          "seen from the eye (default 0.7)")
      ->check(in_range(0.0, 90.0))
      ->type_name("DEGREES");
  command
      .add_option("--memory-mb", options.memory_mb,
                  "Limit on the memory for pictures (default 256)")
      ->check(in_range(1, 65536))
      ->type_name("MB");
  command
      .add_option(
          "--error-px", options.error_px,
          "cache, lod: the largest position error of a picture or a level, in pixels (default 1)")
      ->check(in_range(0.01, 100.0))
      ->type_name("E");
  command
      .add_option(
          "--gap-px", options.gap_px,
          "cache: the largest width of a gap where a surface was hidden at capture, in pixels "
          "(default twice --error-px)")
      ->check(in_range(0.01, 1e6))
      ->type_name("E");
  command
      .add_option("--capture-ms", options.capture_ms,
                  "cache: time for captures per frame, in ms; what is late is drawn with a larger "
                  "error (default: a "
                  "budget of triangles instead, which makes runs repeatable)")
      ->check(in_range(0.1, 1000.0))
      ->type_name("T");
  command
      .add_option("--max-spike", options.max_spike,
                  fmt::format("cache: how many times as much as the frames before one may cost, "
                              "by the costs of --machine; after a cut, what costs more is coarse "
                              "for some frames, with a larger error (0: no limit; default {:g})",
                              options.max_spike))
      ->check(in_range(0.0, 1000.0))
      ->type_name("X");
  command
      .add_option(
          "--bake-mb", options.bake_mb,
          "cache: the part of --memory-mb for representations of heavy objects (--bake-as), baked "
          "before the first frame; they carry the light of the bake along (default 0)")
      ->check(in_range(0, 65536))
      ->type_name("MB");
  add_machine_option(command, "cache", options.machine);
  command.add_flag("--levels", options.levels,
                   "cache without OpenGL: draw and capture objects that stand still by levels of "
                   "detail, whose bounded error is part of --error-px");
  command.add_flag("--bake-together", options.bake_together,
                   "cache: bake all objects that stand still as one, a thing of many parts");
  command.add_flag("!--no-fade", options.fade, "cache: new pictures replace old ones at once");
  command
      .add_option("--texel-px", options.texel_px,
                  "Baked kinds: draw an object as polygons if its texels would be larger than this "
                  "(default 4)")
      ->check(in_range(0.01, 10000.0))
      ->type_name("PIXELS");
  command
      .add_option("--bake-as", options.bake_as,
                  fmt::format("cache: the kinds to bake into --bake-mb (default {})",
                              fmt::join(options.bake_as, ",")))
      ->delimiter(',')
      ->check(CLI::Validator(
          [](std::string& name) {
            return kind_method(name).kind
                       ? std::string()
                       : fmt::format("'{}' is no kind: {}", name, fmt::join(kind_names(), ", "));
          },
          ""))
      ->type_name("A,B,...");
  command
      .add_option("--bake-beyond", options.bake_beyond,
                  fmt::format("cache: kinds of surroundings ({}) stand for what lies farther from "
                              "the path than this (default a tenth of the scene's radius)",
                              fmt::join(surroundings_kinds(), ", ")))
      ->check(in_range(0.0, 1e9))
      ->type_name("METRES");
  add_impostor_options(command, options.impostors);
  add_kind_options(command, KindOptionsOf::draw, options.kinds);
  add_kind_options(command, KindOptionsOf::bake, options.kinds);
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const BuiltinMethod& method : kBuiltin) all.emplace_back(method.name);
    for (std::string& name : kind_method_names()) all.push_back(std::move(name));
    return all;
  }();
  return names;
}

bool is_method(const std::string& name) {
  return kind_method(name).kind ||
         std::find(method_names().begin(), method_names().end(), name) != method_names().end();
}

bool bends_by_time(const std::string& method) {
  return method == kReliefImpostorName || method == "direct-raster";
}

CLI::Validator known_method() {
  return CLI::Validator(
      [](std::string& name) {
        return is_method(name)
                   ? std::string()
                   : fmt::format("'{}' is no method: {}", name, fmt::join(method_names(), ", "));
      },
      fmt::format("{{{}}}", fmt::join(method_names(), ",")));
}

Result<> expect_method_of(const Kind& kind, const std::string& method, const std::string& option) {
  if (kind_method(method).kind == &kind) return Done{};
  return Error{option, fmt::format("the file holds {}, which cannot be drawn as {}, only as {}",
                                   kind.name, method, fmt::join(kind_method_names(kind), " or "))};
}

DepthMode depth_mode(const MethodOptions& options) {
  return options.depth == "linear" ? DepthMode::linear : DepthMode::exact;
}

// Why software does not draw a kind with these options.
namespace {
std::optional<std::string> refused(const std::string& method, const MethodOptions& options) {
  const KindMethod named = kind_method(method);
  if (!named.kind) return std::nullopt;
  KindOptions values = options.kinds;
  apply(named, values);
  const Result<OptionValues> draw = draw_values(*named.kind, values);
  const Result<std::unique_ptr<DrawableFactory>> factory =
      make_factory(software_drawable_rows(), named.kind->name);
  if (!factory) return factory.error().reason;
  if (!draw) return std::nullopt;  // the error comes when it is drawn
  const Result<> possible = (*factory)->check(*draw);
  return possible ? std::nullopt : std::optional<std::string>(possible.error().reason);
}
}  // namespace

std::optional<std::string> needs_opengl(const std::string& method, const MethodOptions& options,
                                        int samples) {
  const Kind* kind = kind_method(method).kind;
  if (method != "cache" && method != "direct-raster" && method != "lod" &&
      method != kReliefImpostorName && !kind)
    return fmt::format("{} is drawn by OpenGL only", method);
  if (auto reason = refused(method, options)) return reason;
  if (samples != 1 && samples != 4)
    return "frames drawn without OpenGL have 1 or 4 samples a pixel";
  if (options.bake_mb > 0 && method == "cache")
    for (const std::string& name : options.bake_as)
      if (auto reason = refused(name, options)) return reason;
  return std::nullopt;
}

Result<std::unique_ptr<FrameSource>> make_software_source(const std::string& method,
                                                          const MethodOptions& options, int samples,
                                                          const Scene& scene) {
  if (const auto reason = needs_opengl(method, options, samples)) return Error{"--draw", *reason};
  if (method == "direct-raster")
    return {std::make_unique<SoftwareDirectFrames>(scene, samples, options.impostors.deformations)};
  if (method == "lod")
    return {SoftwareLevelFrames::create(make_object_levels(scene), samples, options.error_px)};
  if (method == kReliefImpostorName)
    return make_software_impostor_frames(options.impostors, options.outlines, samples, scene);
  if (const KindMethod named = kind_method(method); named.kind)
    return make_software_kind(named, options, samples, scene);
  return make_software_cache(options, samples, scene);
}

namespace {

// Does `automatic` draw without OpenGL though there is one? Kinds are baked by it where there is,
// and polygons that are presented by it do not bend.
bool chooses_software(const std::string& method, const MethodOptions& options, int samples) {
  const Deformations* deformations = options.impostors.deformations;
  const bool bends = deformations && !deformations->meshes.empty();
  return options.draw == "automatic" &&
         (gl::is_software() || (bends && method == "direct-raster")) && !kind_method(method).kind &&
         !needs_opengl(method, options, samples);
}

}  // namespace

Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                 const MethodOptions& options, int samples,
                                                 SceneRenderer& renderer) {
  if (options.draw == "software" || chooses_software(method, options, samples))
    return make_software_source(method, options, samples, renderer.scene());
  for (const BuiltinMethod& builtin : kBuiltin)
    if (method == builtin.name) return builtin.make(options, samples, renderer);
  return make_kind(kind_method(method), options, renderer);
}

Result<std::unique_ptr<FrameSource>> make_scene_source(const std::string& method,
                                                       const MethodOptions& options, int samples,
                                                       const Scene& scene,
                                                       std::unique_ptr<gl::Context>& context,
                                                       std::optional<SceneRenderer>& renderer) {
  if (options.draw == "software") return make_software_source(method, options, samples, scene);
  if (!context) {
    Result<std::unique_ptr<gl::Context>> made = gl::Context::create();
    if (!made && options.draw == "automatic" && !needs_opengl(method, options, samples))
      return make_software_source(method, options, samples, scene);
    if (!made) return made.error();
    context = std::move(*made);
  }
  if (chooses_software(method, options, samples))
    return make_software_source(method, options, samples, scene);
  if (!renderer) {
    Result<SceneRenderer> made = SceneRenderer::create(scene);
    if (!made) return made.error();
    renderer.emplace(std::move(*made));
  }
  return make_source(method, options, samples, *renderer);
}

namespace {

// What a file holds, by one of the factories of `rows`, which outlives the drawable.
struct StoredDrawable {
  std::unique_ptr<DrawableFactory> factory;
  std::unique_ptr<Drawable> drawable;
  Instance instance;
};

Result<StoredDrawable> make_stored_drawable(const std::string& method, const MethodOptions& options,
                                            std::span<const DrawableRow> rows,
                                            std::unique_ptr<Representation> representation) {
  const KindMethod named = kind_method(method);
  KindOptions values = options.kinds;
  apply(named, values);
  const Result<OptionValues> draw = draw_values(*named.kind, values);
  if (!draw) return draw.error();
  Result<std::unique_ptr<DrawableFactory>> factory = make_factory(rows, named.kind->name);
  if (!factory) return factory.error();
  const Instance instance{glm::dmat4(1.0), 0, representation->only_object()};
  Result<std::unique_ptr<Drawable>> drawable =
      (*factory)->make_drawable(std::move(representation), *draw);
  if (!drawable) return drawable.error();
  return StoredDrawable{std::move(*factory), std::move(*drawable), instance};
}

}  // namespace

Result<std::unique_ptr<FrameSource>> make_software_stored_source(
    const std::string& method, const MethodOptions& options, int samples,
    std::unique_ptr<Representation> representation, const Scene& sky) {
  Result<StoredDrawable> made =
      make_stored_drawable(method, options, software_drawable_rows(), std::move(representation));
  if (!made) return made.error();
  return {std::make_unique<SoftwareStoredFrames>(sky, samples, std::move(made->drawable),
                                                 std::vector<Instance>{made->instance},
                                                 options.outlines, std::move(made->factory))};
}

Result<bool> draws_by_software(const std::string& method, const MethodOptions& options, int samples,
                               bool has_opengl, const Error& missing) {
  std::optional<std::string> reason = refused(method, options);
  if (samples != 1 && samples != 4)
    reason = "frames drawn without OpenGL have 1 or 4 samples a pixel";
  const bool possible = !reason;
  if (options.draw == "software" && !possible) return Error{"--draw", *reason};
  if (options.draw == "software") return true;
  if (!has_opengl && (options.draw == "opengl" || !possible)) return missing;
  return options.draw == "automatic" && possible && (!has_opengl || gl::is_software());
}

Result<std::unique_ptr<FrameSource>> make_stored_source(
    const std::string& method, const MethodOptions& options,
    std::unique_ptr<Representation> representation, SceneRenderer& sky) {
  Result<StoredDrawable> made =
      make_stored_drawable(method, options, drawable_rows(), std::move(representation));
  if (!made) return made.error();
  return {std::make_unique<StoredSource>(std::move(made->factory), std::move(made->drawable),
                                         made->instance, options.outlines, sky)};
}

}  // namespace rilievo::app
