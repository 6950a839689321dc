#include "apps/rilievo/stored_sources.h"

#include <span>
#include <utility>
#include <vector>

#include "rilievo/frame/gl/stored_frames.h"
#include "rilievo/frame/software/software_stored_frames.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo::app {
namespace {

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

Result<std::unique_ptr<FrameSource>> make_stored_source(
    const std::string& method, const MethodOptions& options,
    std::unique_ptr<Representation> representation, SceneRenderer& sky) {
  Result<StoredDrawable> made =
      make_stored_drawable(method, options, drawable_rows(), std::move(representation));
  if (!made) return made.error();
  return {std::make_unique<StoredSource>(std::move(made->factory), std::move(made->drawable),
                                         made->instance, options.outlines, sky)};
}

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

}  // namespace rilievo::app
