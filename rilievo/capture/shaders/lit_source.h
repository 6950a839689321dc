// The geometry of one source under the light of another.
//
// Path tracers make the best colours, but not the best depths: that of Cycles is the depth of one
// sample somewhere in the texel. Here depths and objects are those of `geometry` (rays), to the
// bit, and colours those of `light` (the ray tracer, another program), by the texel rule
// (core/texel_rule.h):
//
//   light of the scene   its samples are known: a texel has its light; where only a thin surface in
//                        front is the texel's, that of the neighbours that show this surface
//   light of a program   its texels mix both sides of edges: they are unmixed by the depths of
//                        `geometry` (warp/unmix_edges.h)
//   the sky              behind the light's coverage; a program may have a sky of its own
//   glass that bends     is opaque to eyes: its depth is the light's
//
// A program knows only what a perspective or parallel camera sees first. What a back-perspective
// picture (S2.1) or layers (S4.1) show besides has the colours of pictures taken around the
// bounds: that of those who see the place along the nearest direction; what nobody sees has the
// colour of `geometry`. One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Whose light it is.
enum class LightOf {
  scene,    // the same scene's: it captures whatever `geometry` does, but no sky
  program,  // another program's, which knows perspective and parallel pictures of everything
};

// How light is taken.
struct LitOptions {
  LightOf light = LightOf::scene;
  int samples = 0;  // of the light, a texel; 0: as many as are asked for
  // Otherwise a capture fails if the light shows nothing at more than half of the surfaces' texels.
  bool may_miss = false;
  // Of a program's pictures from all around, which show what a picture's own side does not see; 0:
  // as many as of that.
  int around_samples = 0;
};

// Two sources as one.
class LitSource final : public CaptureSource {
 public:
  // Both must outlive it. `geometry` is a source of a scene.
  LitSource(CaptureSource& geometry, CaptureSource& light, const LitOptions& options);

  [[nodiscard]] std::string_view name() const override { return geometry_.name(); }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Fails where one of the sources does, by its name, and where the light shows nothing at most of
  // the surfaces: then it is another scene's.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;
  [[nodiscard]] const Scene* scene() const override { return geometry_.scene(); }

 private:
  // The samples of the light where so many are asked for.
  [[nodiscard]] int light_samples(int asked) const {
    return options_.samples > 0 ? options_.samples : asked;
  }
  [[nodiscard]] Result<CapturedPicture> lit(const CaptureRequest& request, int samples);
  // Of these objects (empty: all), by as many texels and samples.
  [[nodiscard]] Result<const DepthImage*> around(const glm::dvec3& direction,
                                                 std::span<const std::uint32_t> objects, int size,
                                                 int samples);
  [[nodiscard]] Result<std::vector<const DepthImage*>> all_around(
      const glm::dvec3& direction, std::span<const std::uint32_t> objects, int size, int samples);

  CaptureSource& geometry_;
  CaptureSource& light_;
  LitOptions options_;
  std::vector<bool> bends_;  // light; for each identifier of an object
  // What was taken around the bounds, to be found again.
  struct Around {
    glm::dvec3 direction;
    std::vector<std::uint32_t> objects;
    int size, samples;
    std::unique_ptr<DepthImage> picture;
  };
  std::vector<Around> around_;
};

}  // namespace rilievo
