#include "rilievo/method/kinds.h"

#include <string>
#include <utility>

#include "rilievo/method/objects.h"
#include "rilievo/method/relief_impostors.h"
#include "rilievo/method/stored.h"
#include "rilievo/method/surroundings.h"

namespace rilievo {
namespace {

// How far programs that shade in the background give way to frames, as of nice(1).
constexpr int kGiveWay = 10;

Result<std::unique_ptr<FrameChooser>> make_chooser(const KindMethod& method,
                                                   const MethodOptions& options, Backend& backend) {
  Result<PreparedKind> kind = prepare(method, options.kinds, backend.drawables());
  if (!kind) return kind.error();
  Result<std::unique_ptr<CaptureSource>> source = backend.make_capture_source();
  if (!source) return source.error();
  if (method.kind->stands_for == StandsFor::surroundings) {
    auto made = SurroundingChooser::create(backend.placed(), **source, *method.kind,
                                           std::move(kind->factory),
                                           {kind->bake, kind->draw, options.eyes, options.eye_path,
                                            options.outlines, options.progress, options.note});
    if (!made) return made.error();
    return {std::move(*made)};
  }
  const std::size_t bytes = std::size_t(options.memory_mb) << 20;
  auto made = ObjectChooser::create(
      backend.placed(), **source, *method.kind, std::move(kind->factory),
      {object_options(*kind, bytes, options.progress), options.texel_px, options.outlines});
  if (!made) return made.error();
  return {std::move(*made)};
}

Result<Method> make_stored(Backend& backend, std::unique_ptr<StoredChooser> chooser) {
  Result<std::unique_ptr<FrameSource>> frames = backend.make_frames(std::move(chooser));
  if (!frames) return frames.error();
  Method made;
  made.frames = std::move(*frames);
  return made;
}

// A drawable with what made it.
struct ReadyContent {
  std::unique_ptr<DrawableFactory> factory;
  PictureSet set;
};

// Placed in the space of `origin`.
Result<ReadyContent> make_ready(std::string_view name, const MethodOptions& options,
                                Backend& backend, std::unique_ptr<Representation> representation,
                                const glm::dvec3& origin) {
  const KindMethod named = kind_method(name);
  if (!named.kind) return Error{std::string(name), "is no method of a kind"};
  KindOptions values = options.kinds;
  apply(named, values);
  const Result<OptionValues> draw = draw_values(*named.kind, values);
  if (!draw) return draw.error();
  Result<std::unique_ptr<DrawableFactory>> factory =
      make_factory(backend.drawables(), named.kind->name);
  if (!factory) return factory.error();
  Instance instance{glm::dmat4(1.0), 0, representation->only_object()};
  instance.world_from_capture[3] += glm::dvec4(representation->world.origin - origin, 0);
  Result<std::unique_ptr<Drawable>> drawable =
      (*factory)->make_drawable(std::move(representation), *draw);
  if (!drawable) return drawable.error();
  return ReadyContent{std::move(*factory), PictureSet{std::move(*drawable), {instance}}};
}

}  // namespace

ObjectDrawablesOptions object_options(const PreparedKind& kind, std::size_t max_bytes,
                                      const Progress& progress) {
  ObjectDrawablesOptions objects{kind.bake, kind.draw};
  objects.max_bytes = max_bytes;
  objects.progress = progress;
  return objects;
}

Result<Method> make_kind_method(const KindMethod& method, const MethodOptions& options,
                                Backend& backend) {
  Result<std::unique_ptr<FrameChooser>> chooser = make_chooser(method, options, backend);
  if (!chooser) return chooser.error();
  Result<std::unique_ptr<FrameSource>> frames = backend.make_frames(std::move(*chooser));
  if (!frames) return frames.error();
  Method made;
  made.frames = std::move(*frames);
  return made;
}

Result<Method> make_stored_method(std::string_view name, const MethodOptions& options,
                                  Backend& backend, std::unique_ptr<Representation> representation,
                                  std::vector<StoredBeside> beside) {
  const glm::dvec3 origin = representation->world.origin;
  Result<ReadyContent> first =
      make_ready(name, options, backend, std::move(representation), origin);
  if (!first) return first.error();
  auto chooser = std::make_unique<StoredChooser>(std::move(first->set),
                                                 StoredOptions{options.outlines, options.sky},
                                                 std::move(first->factory));
  for (StoredBeside& other : beside) {
    Result<ReadyContent> made =
        make_ready(other.kind->name, options, backend, std::move(other.representation), origin);
    if (!made) return made.error();
    chooser->add(std::move(made->set), std::move(made->factory));
  }
  return make_stored(backend, std::move(chooser));
}

Result<Method> make_stored_method(std::span<const DepthImage> pictures, int delta_bits,
                                  const MethodOptions& options, Backend& backend) {
  Result<PictureSet> set = backend.make_pictures(pictures, options.depth_mode, delta_bits);
  if (!set) return set.error();
  return make_stored(backend, std::make_unique<StoredChooser>(
                                  std::move(*set), StoredOptions{options.outlines, options.sky}));
}

Result<Method> make_relief_impostors(const MethodOptions& options, Backend& backend) {
  const ReliefImpostorOptions& given = options.impostors;
  ImpostorContentOptions with;
  with.shader = given.shader;
  with.objects = given.objects;
  with.workers = given.workers;
  with.store = given.store;
  with.store_options.max_bytes = std::uint64_t(given.store_mb) << 20;
  with.exec.warn = options.warn;
  if (given.background) with.exec.nice = kGiveWay;
  with.warn = options.warn;
  with.deformations = backend.deformations();
  backend.set_time(0.0);
  Result<ImpostorContent> content = make_impostor_content(backend.given_scene(), 0.0, with);
  if (!content) return content.error();

  ImpostorFramesOptions frames;
  frames.workers.size = given.texels;
  frames.workers.samples = given.samples;
  frames.background = given.background;
  frames.workers.gives_way = given.background;
  frames.outlines = options.outlines;
  Result<ImpostorFrames> made = make_impostor_frames(backend, std::move(*content), frames);
  if (!made) return made.error();
  Method method;
  method.frames = std::move(made->frames);
  method.impostors = [chooser = made->chooser] { return chooser->statuses(); };
  return method;
}

}  // namespace rilievo
