#include "rilievo/layered_impostor/drawable_terms.h"

#include <algorithm>

#include "rilievo/layered_impostor/error.h"

namespace rilievo {
namespace {

// In triangles, on a software rasteriser with four samples a pixel.
constexpr double kFixed = 3000;
constexpr double kMarchedPixel = 1;      // by the ray march through the surfaces ...
constexpr double kSilhouettePixel = 30;  // ... and this times the silhouette-edge ratio
constexpr double kSlicePixel = 0.02;     // for each slice of a view

double layered_bound_px(const ErrorModel& model, const glm::dmat4& world_from_capture,
                        const Camera& frame) {
  const auto stats = model.load<LayeredErrorStats>();
  return bound_layered_error(stats, model.bounds, world_from_capture, frame).total_px;
}

// Of the texels that show something, the share at whose edges the surface ends: next to nothing for
// a ball, a tenth for a teapot, a quarter for a tree. The ray march goes on behind each.
double silhouette_edge_ratio(const LayeredImpostor& impostor) {
  constexpr unsigned kBeside = 0b01010101;  // not across corners: rays pass those by
  std::size_t shown = 0, edges = 0;
  for (const TexelSurface& surface : impostor.surfaces)
    for (const SurfaceTexel& texel : surface.texels.texels()) {
      shown += texel.q != 0;
      edges += texel.q != 0 && (texel.links & kBeside) != kBeside;
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

}  // namespace

ErrorModel layered_error_model(const LayeredImpostor& impostor, const LayeredOptions& options) {
  ErrorModel error;
  error.bound = layered_bound_px;
  error.bounds = impostor.bounds;
  error.texel = texel_of(impostor);
  error.store(layered_error_stats(impostor, options));
  return error;
}

CostTerms layered_cost_terms(const LayeredImpostor& impostor, LayeredMethod method) {
  return {kFixed, method == LayeredMethod::slices
                      ? slices_a_view(impostor) * kSlicePixel
                      : kMarchedPixel + silhouette_edge_ratio(impostor) * kSilhouettePixel};
}

}  // namespace rilievo
