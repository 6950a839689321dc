#include "rilievo/layered_impostor/gl/layered_drawable.h"

#include <algorithm>
#include <utility>

#include "rilievo/layered_impostor/drawable_terms.h"
#include "rilievo/layered_impostor/layered_kind.h"

namespace rilievo {
namespace {

class LayeredDrawable final : public Drawable {
 public:
  LayeredDrawable(LayeredPictures pictures, LayeredDrawer& drawer, const LayeredOptions& options,
                  const ErrorModel& error, const CostTerms& cost)
      : pictures_(std::move(pictures)),
        drawer_(drawer),
        options_(options),
        error_(error),
        cost_(cost) {}

  [[nodiscard]] std::string_view kind() const override { return kLayeredImpostorName; }

  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override {
    place(instances);
    if (output == Output::color)
      drawer_.draw(pictures_, frame, placed_, options_);
    else
      drawer_.draw_objects(pictures_, frame, placed_, options_);
  }
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override {
    place(instances);
    drawer_.draw_outlines(pictures_, frame, placed_);
  }

  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override { return error_; }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override { return cost_; }
  [[nodiscard]] std::size_t bytes() const override { return pictures_.bytes(); }

 private:
  void place(std::span<const Instance> instances) {
    placed_.clear();
    for (const Instance& instance : instances)
      placed_.push_back(
          {instance.world_from_capture, object_of(instance, pictures_.only_object())});
  }

  LayeredPictures pictures_;
  LayeredDrawer& drawer_;
  LayeredOptions options_;
  ErrorModel error_;
  CostTerms cost_;
  std::vector<LayeredInstance> placed_;  // kept, so that drawing does not allocate
};

class LayeredFactory final : public DrawableFactory {
 public:
  explicit LayeredFactory(LayeredDrawer drawer) : drawer_(std::move(drawer)) {}

  [[nodiscard]] std::size_t expected_bytes(const OptionValues& bake,
                                           const OptionValues& draw) const override {
    const BakeOptions options = layered_bake_options(bake);
    const int views = int(make_view_set(options.views).directions.size());
    return layered_texture_bytes(views, options.camera.size, options.camera.size,
                                 layered_draw_options(draw).method);
  }
  void spare(OptionValues& bake, const OptionValues& draw) const override {
    if (layered_draw_options(draw).method != LayeredMethod::slices)
      (void)bake.set("no-fills", "on");
  }
  [[nodiscard]] Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) override {
    auto& layered = dynamic_cast<LayeredRepresentation&>(*representation);
    return make_layered_drawable(std::move(layered.impostor), drawer_, layered_draw_options(draw));
  }

 private:
  LayeredDrawer drawer_;
};

}  // namespace

Result<std::unique_ptr<Drawable>> make_layered_drawable(LayeredImpostor impostor,
                                                        LayeredDrawer& drawer,
                                                        const LayeredOptions& options) {
  const ErrorModel error = layered_error_model(impostor, options);
  const CostTerms cost = layered_cost_terms(impostor, options.method);
  Result<LayeredPictures> pictures = LayeredPictures::create(std::move(impostor));
  if (!pictures) return pictures.error();
  pictures->keep_only(options.method);
  return {std::make_unique<LayeredDrawable>(std::move(*pictures), drawer, options, error, cost)};
}

Result<std::unique_ptr<DrawableFactory>> make_layered_drawable_factory() {
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  return {std::make_unique<LayeredFactory>(std::move(*drawer))};
}

}  // namespace rilievo
