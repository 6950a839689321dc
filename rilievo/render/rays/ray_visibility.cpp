#include "rilievo/render/rays/ray_visibility.h"

#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/render/rays/stroke_hits.h"

namespace rilievo {

Result<std::unique_ptr<RayVisibility>> RayVisibility::create(const Scene& scene) {
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  return {std::unique_ptr<RayVisibility>(new RayVisibility(std::move(*rays)))};
}

Result<> RayVisibility::find_visible(const Camera& camera, int samples, const PlacedScene& placed,
                                     std::span<const std::uint32_t>,
                                     [[maybe_unused]] std::span<const CrossFade> fading) {
  RILIEVO_EXPECTS(&placed.scene() == &rays_.scene() && fading.empty());
  if (Result<> fits = strokes_fit(rays_.scene(), camera); !fits) return fits;
  if (Result<> done = rays_.set_time(placed.time()); !done) return done;
  caster_.cast(camera, samples);
  return Done{};
}

}  // namespace rilievo
