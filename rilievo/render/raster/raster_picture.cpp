#include "rilievo/render/raster/raster_picture.h"

#include "rilievo/core/expects.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

struct PictureRasterizer::State {
  const Scene& scene;
  SurfaceMaterials materials;
  SampleRaster raster;
  std::vector<PlacedMesh> placed;
  std::vector<RasterInstance> instances;  // the same
  std::vector<RasterMask> masks;          // the same
  std::vector<Light> lights;
  PictureShader shader;

  explicit State(const Scene& scene) : scene(scene), materials(scene) {}
};

std::size_t PictureRasterizer::bytes(int size, int samples) {
  constexpr std::size_t kTexel = sizeof(RasterPicture::color[0]) + sizeof(RasterPicture::depth[0]);
  return SampleRaster::bytes(size, samples) + std::size_t(size) * std::size_t(size) * kTexel;
}

PictureRasterizer::PictureRasterizer(const Scene& scene) : state_(new State(scene)) {}
PictureRasterizer::PictureRasterizer(PictureRasterizer&&) noexcept = default;
PictureRasterizer& PictureRasterizer::operator=(PictureRasterizer&&) noexcept = default;
PictureRasterizer::~PictureRasterizer() = default;

void PictureRasterizer::draw_farthest(const Camera& camera, std::span<const std::uint32_t> objects,
                                      std::span<const glm::mat4> poses, std::vector<float>& depth) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  State& s = *state_;
  place_meshes(s.scene, s.materials, camera.position(), objects, poses, s.placed);
  make_instances(camera, s.placed, s.instances, s.masks);
  for (RasterInstance& instance : s.instances) {
    instance.front = instance.back = true;
    instance.row_z = instance.row_w - instance.row_z;  // 1 - window_z: the farthest is the nearest
  }
  s.raster.begin(camera.width, camera.height, 1);
  s.raster.draw(s.instances);
  depth.resize(std::size_t(camera.width) * std::size_t(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    const float* from = s.raster.seen().depths(y);
    float* to = depth.data() + std::size_t(y) * std::size_t(camera.width);
    for (int x = 0; x < camera.width; ++x) to[x] = from[x] < 1 ? 1 - from[x] : 1;
  }
}

void PictureRasterizer::draw_objects(const Camera& camera, std::span<const std::uint32_t> objects,
                                     std::span<const glm::mat4> poses, ObjectPicture& picture) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  State& s = *state_;
  place_meshes(s.scene, s.materials, camera.position(), objects, poses, s.placed);
  make_instances(camera, s.placed, s.instances, s.masks);
  s.raster.begin(camera.width, camera.height, 1);
  s.raster.draw(s.instances);
  identify(s.raster.seen(), s.placed, picture);
}

std::size_t PictureRasterizer::texture_bytes() const { return state_->materials.bytes(); }

void PictureRasterizer::draw(const Camera& camera, std::span<const std::uint32_t> objects,
                             std::span<const glm::mat4> poses, int samples,
                             RasterPicture& picture) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  State& s = *state_;
  place_meshes(s.scene, s.materials, camera.position(), objects, poses, s.placed);
  make_instances(camera, s.placed, s.instances, s.masks);
  s.raster.begin(camera.width, camera.height, samples);
  s.raster.draw(s.instances);
  s.shader.shade({s.raster.seen(), s.placed, picture_rays(camera),
                  surface_lights(s.scene, camera.position(), s.lights)},
                 picture);
}

}  // namespace rilievo
