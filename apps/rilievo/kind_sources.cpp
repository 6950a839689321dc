#include "apps/rilievo/kind_sources.h"

#include <utility>

#include "apps/rilievo/prepared_kind.h"
#include "apps/rilievo/progress.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/frame/gl/chosen_frames.h"
#include "rilievo/frame/software/software_chosen_frames.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo::app {
namespace {

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

}  // namespace

Result<std::unique_ptr<FrameSource>> make_kind(const KindMethod& method,
                                               const MethodOptions& options,
                                               SceneRenderer& renderer) {
  Result<PreparedKind> kind = prepare(method, options.kinds, drawable_rows());
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

Result<std::unique_ptr<FrameSource>> make_software_kind(const KindMethod& method,
                                                        const MethodOptions& options, int samples,
                                                        const Scene& scene) {
  Result<PreparedKind> kind = prepare(method, options.kinds, software_drawable_rows());
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

}  // namespace rilievo::app
