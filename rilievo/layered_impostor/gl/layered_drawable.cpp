#include "rilievo/layered_impostor/gl/layered_drawable.h"

#include <algorithm>
#include <utility>

#include "rilievo/layered_impostor/error.h"
#include "rilievo/layered_impostor/layered_kind.h"

namespace rilievo {
namespace {

// In triangles, on a software rasteriser with four samples a pixel.
constexpr double kFixed = 3000;
constexpr double kMarchedPixel = 1;      // by the ray march through the surfaces ...
constexpr double kSilhouettePixel = 30;  // ... and this times the silhouette-edge ratio
constexpr double kSlicePixel = 0.02;     // for each slice of a view

struct Terms {
  LayeredErrorStats stats;
  bool sliced = false;
};

double layered_bound_px(const ErrorModel& model, const glm::dmat4& world_from_capture,
                        const Camera& frame) {
  const Terms terms = model.load<Terms>();
  if (!is_served(model.bounds, world_from_capture, frame))
    return std::numeric_limits<double>::infinity();
  return bound_layered_error(terms.stats, terms.sliced, model.bounds, world_from_capture, frame)
      .total_px;
}

// Of the texels that show something, the share at whose edges the surface ends: next to nothing for
// a ball, a tenth for a teapot, a quarter for a tree. The ray march goes on behind each.
double silhouette_edge_ratio(const LayeredImpostor& impostor) {
  std::size_t shown = 0, edges = 0;
  for (const TexelSurface& surface : impostor.surfaces)
    for (const SurfaceTexel& texel : surface.texels.texels()) {
      shown += texel.q != 0;
      edges += texel.q != 0 && texel.links != 0xFF;
    }
  return shown > 0 ? double(edges) / double(shown) : 0;
}

double slices_a_view(const LayeredImpostor& impostor) {
  std::size_t slices = 0;
  for (const std::vector<Slice>& of_view : impostor.slices) slices += of_view.size();
  return std::max(1.0, double(slices / std::max<std::size_t>(1, impostor.slices.size())));
}

// The size of a view's texels where they show the centre, the coarsest view's.
double texel_of(const LayeredImpostor& impostor) {
  const glm::dvec3 center(impostor.bounds.center());
  double texel = 0;
  for (const DepthImage& picture : impostor.pictures) {
    const Camera& c = picture.camera;
    const double eye_z = glm::dot(center - c.position(), c.forward());
    const double w = (c.window.right - c.window.left) / c.width;
    const double h = (c.window.top - c.window.bottom) / c.height;
    texel = std::max(texel, eye_z * std::max(w, h));
  }
  return texel;
}

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
      placed_.push_back({instance.world_from_capture, instance.object});
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
  ErrorModel error;
  error.bound = layered_bound_px;
  error.bounds = impostor.bounds;
  error.texel = texel_of(impostor);
  const bool sliced = options.method == LayeredMethod::slices;
  error.store(Terms{layered_error_stats(impostor), sliced});
  const double per_pixel = sliced
                               ? slices_a_view(impostor) * kSlicePixel
                               : kMarchedPixel + silhouette_edge_ratio(impostor) * kSilhouettePixel;
  Result<LayeredPictures> pictures = LayeredPictures::create(std::move(impostor));
  if (!pictures) return pictures.error();
  pictures->keep_only(options.method);
  return {std::make_unique<LayeredDrawable>(std::move(*pictures), drawer, options, error,
                                            CostTerms{kFixed, per_pixel})};
}

Result<std::unique_ptr<DrawableFactory>> make_layered_drawable_factory() {
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  return {std::make_unique<LayeredFactory>(std::move(*drawer))};
}

}  // namespace rilievo
