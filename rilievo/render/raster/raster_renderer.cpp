#include "rilievo/render/raster/raster_renderer.h"

#include <vector>

#include "rilievo/render/raster/frame_raster.h"

namespace rilievo {

struct RasterRenderer::State {
  PlacedScene placed;
  FrameRaster raster;
  std::vector<std::uint32_t> visible;
  PictureShader shader;

  explicit State(const Scene& scene) : placed(scene), raster(scene) {}
  Result<> rasterize(const Camera& camera, int samples) {
    visible.clear();
    placed.cull(camera, visible);
    return raster.find_visible(camera, samples, placed, visible, {});
  }
};

RasterRenderer::RasterRenderer(const Scene& scene) : state_(new State(scene)) {}
RasterRenderer::~RasterRenderer() = default;

Result<> RasterRenderer::set_time(double time) {
  state_->placed.set_time(time);
  return Done{};
}

Result<> RasterRenderer::draw(const Camera& camera, int samples, RasterPicture& picture) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, samples); !done) return done;
  s.shader.shade(s.raster.view(camera), picture);
  return Done{};
}

Result<> RasterRenderer::draw_objects(const Camera& camera, ObjectPicture& picture) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, 1); !done) return done;
  identify(s.raster.seen(), s.raster.meshes(), picture);
  return Done{};
}

}  // namespace rilievo
