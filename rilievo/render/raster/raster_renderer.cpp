#include "rilievo/render/raster/raster_renderer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/render/draw_list.h"
#include "rilievo/render/raster/near_clip.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/raster/sample_raster.h"

namespace rilievo {

struct RasterRenderer::State {
  const Scene& scene;
  SurfaceMaterials materials;
  double time = NAN;
  std::vector<glm::mat4> poses;
  std::vector<Box> bounds;
  std::vector<std::pair<double, std::uint32_t>> visible;  // nearest first
  std::vector<std::uint32_t> objects;
  std::vector<PlacedMesh> placed;
  std::vector<RasterInstance> instances;
  std::vector<RasterMask> masks;
  std::vector<Light> lights;
  NearClip near_clip;
  SampleRaster raster;
  PictureShader shader;

  explicit State(const Scene& scene) : scene(scene), materials(scene) {}
  void cull(const Camera& camera);
  Result<> rasterize(const Camera& camera, int samples);
};

// Near objects first: what they hide is written less often.
void RasterRenderer::State::cull(const Camera& camera) {
  const Frustum frustum = frustum_of(camera);
  visible.clear();
  for (std::uint32_t i = 0; i < bounds.size(); ++i)
    if (may_touch(frustum, bounds[i]))
      visible.emplace_back(glm::length(glm::dvec3(bounds[i].center()) - camera.position()), i);
  std::sort(visible.begin(), visible.end());
  objects.clear();
  for (const auto& [distance, object] : visible) objects.push_back(object);
}

Result<> RasterRenderer::State::rasterize(const Camera& camera, int samples) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  if (std::max(camera.width, camera.height) > SampleRaster::kMaxSize)
    return Error{"direct-raster", "frames have at most " + std::to_string(SampleRaster::kMaxSize) +
                                      " pixels a side"};
  cull(camera);
  place_meshes(scene, materials, camera.position(), objects, poses, placed);
  make_instances(camera, placed, instances, masks);
  const std::uint32_t triangles =
      placed.empty() ? 0 : placed.back().first_triangle + placed.back().triangles;
  near_clip.clear(triangles);
  const float z_near = float(camera.z_near);
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (NearClip::crosses(instances[i], placed[i].mesh->bounds, z_near))
      near_clip.cut(*placed[i].mesh, camera.width, camera.height, z_near, instances[i]);
  instances.insert(instances.end(), near_clip.instances().begin(), near_clip.instances().end());
  raster.begin(camera.width, camera.height, samples);
  raster.draw(instances);
  raster.renumber(triangles, near_clip.numbers());
  return Done{};
}

RasterRenderer::RasterRenderer(const Scene& scene) : state_(new State(scene)) {
  static_cast<void>(RasterRenderer::set_time(0));
}
RasterRenderer::~RasterRenderer() = default;

Result<> RasterRenderer::set_time(double time) {
  State& s = *state_;
  if (time == s.time || (!s.poses.empty() && s.scene.channels.empty())) return Done{};
  s.time = time;
  pose(s.scene, time, s.poses);
  s.bounds.resize(s.poses.size());
  for (std::size_t i = 0; i < s.poses.size(); ++i)
    s.bounds[i] =
        transformed(s.poses[i], s.scene.models[std::size_t(s.scene.objects[i].model)].bounds);
  return Done{};
}

Result<> RasterRenderer::draw(const Camera& camera, int samples, RasterPicture& picture) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, samples); !done) return done;
  s.shader.shade({s.raster.seen(), s.placed, picture_rays(camera),
                  surface_lights(s.scene, camera.position(), s.lights)},
                 picture);
  return Done{};
}

Result<> RasterRenderer::draw_objects(const Camera& camera, ObjectPicture& picture) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, 1); !done) return done;
  identify(s.raster.seen(), s.placed, picture);
  return Done{};
}

}  // namespace rilievo
