#include "rilievo/render/raster/raster_picture.h"

#include <algorithm>

#include "rilievo/core/expects.h"
#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/shading/texel_shader.h"

namespace rilievo {

struct PictureRasterizer::State {
  FrameRaster raster;
  PictureShader shader;
  std::vector<float> farthest;

  explicit State(const Scene& scene) : raster(scene) {}
  // Of what is placed.
  void draw(const Camera& camera, int samples, RasterPicture& picture);
  void draw_farthest(const Camera& camera, NearPlane near_plane, std::vector<float>& depth);
};

Image<float> eye_z_from_window_z(std::span<const float> window_z, const Camera& camera) {
  Image<float> eye_z(camera.width, camera.height);
  const double near = 1 / camera.z_near, per_z = 1 / camera.z_near - 1 / camera.z_far;
  for (int y = 0; y < camera.height; ++y) {
    const float* from =
        window_z.data() + std::size_t(camera.height - 1 - y) * std::size_t(camera.width);
    float* to = eye_z.row(y).data();
    for (int x = 0; x < camera.width; ++x)
      to[x] = from[x] < 1 ? float(1 / (near - double(from[x]) * per_z)) : kNoDepth;
  }
  return eye_z;
}

std::size_t PictureRasterizer::bytes(int size, int samples) {
  constexpr std::size_t kTexel = sizeof(RasterPicture::color[0]) + sizeof(RasterPicture::depth[0]);
  return SampleRaster::bytes(size, samples) + std::size_t(size) * std::size_t(size) * kTexel;
}

PictureRasterizer::PictureRasterizer(const Scene& scene) : state_(new State(scene)) {}
PictureRasterizer::PictureRasterizer(PictureRasterizer&&) noexcept = default;
PictureRasterizer& PictureRasterizer::operator=(PictureRasterizer&&) noexcept = default;
PictureRasterizer::~PictureRasterizer() = default;

void PictureRasterizer::State::draw(const Camera& camera, int samples, RasterPicture& picture) {
  raster.fill(camera, samples, NearPlane::clamps);
  shader.shade(raster.view(camera), picture);
}

void PictureRasterizer::State::draw_farthest(const Camera& camera, NearPlane near_plane,
                                             std::vector<float>& depth) {
  raster.keep_farthest();
  raster.fill(camera, 1, near_plane);
  depth.resize(std::size_t(camera.width) * std::size_t(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    const float* from = raster.seen().depths(y);
    float* to = depth.data() + std::size_t(y) * std::size_t(camera.width);
    for (int x = 0; x < camera.width; ++x) to[x] = from[x] < 1 ? 1 - from[x] : 1;
  }
}

void PictureRasterizer::draw_farthest(const Camera& camera, std::span<const std::uint32_t> objects,
                                      std::span<const glm::mat4> poses, std::vector<float>& depth) {
  state_->raster.place(camera, objects, poses);
  state_->draw_farthest(camera, NearPlane::clamps, depth);
}

void PictureRasterizer::draw_farthest(const Camera& camera, std::span<const PlacedMesh> placed,
                                      std::vector<float>& depth) {
  state_->raster.place(camera, placed);
  state_->draw_farthest(camera, NearPlane::clamps, depth);
}

Image<float> PictureRasterizer::capture_farthest(const Camera& camera,
                                                 std::span<const std::uint32_t> objects,
                                                 std::span<const glm::mat4> poses) {
  state_->raster.place(camera, objects, poses);
  state_->draw_farthest(camera, NearPlane::cuts, state_->farthest);
  return eye_z_from_window_z(state_->farthest, camera);
}

void PictureRasterizer::draw_objects(const Camera& camera, std::span<const std::uint32_t> objects,
                                     std::span<const glm::mat4> poses, ObjectPicture& picture) {
  FrameRaster& raster = state_->raster;
  raster.place(camera, objects, poses);
  raster.fill(camera, 1, NearPlane::clamps);
  identify(raster.seen(), raster.meshes(), picture);
}

const std::shared_ptr<const SurfaceMaterials>& PictureRasterizer::materials() const {
  return state_->raster.materials();
}

void PictureRasterizer::draw(const Camera& camera, std::span<const std::uint32_t> objects,
                             std::span<const glm::mat4> poses, int samples,
                             RasterPicture& picture) {
  state_->raster.place(camera, objects, poses);
  state_->draw(camera, samples, picture);
}

void PictureRasterizer::place(const Camera& camera, std::span<const std::uint32_t> objects,
                              std::span<const glm::mat4> poses,
                              std::vector<PlacedMesh>& placed) const {
  state_->raster.find_places(camera, objects, poses, placed);
}

void PictureRasterizer::draw(const Camera& camera, std::span<const PlacedMesh> placed, int samples,
                             RasterPicture& picture) {
  state_->raster.place(camera, placed);
  state_->draw(camera, samples, picture);
}

DepthImage PictureRasterizer::capture(const Camera& camera, std::span<const std::uint32_t> objects,
                                      std::span<const glm::mat4> poses, int samples, bool with_sky,
                                      bool staggered) {
  RILIEVO_EXPECTS(samples == 1 || !staggered);
  FrameRaster& raster = state_->raster;
  // Depth and identifiers at the texels' samples, where they mean one surface ...
  raster.place(camera, objects, poses);
  raster.fill(camera, 1, NearPlane::cuts, staggered);
  DepthImage picture;
  picture.camera = camera;
  identify(raster.seen(), raster.meshes(), 0, picture);
  // ... and the colour of that surface, averaged over the texel.
  const auto linear_view = [&] {
    PictureView view = raster.view(camera);
    view.scene.scale = ColorScale::linear;
    return view;
  };
  if (samples == 1) {
    state_->shader.shade(linear_view(), picture, with_sky);
    return picture;
  }
  const CenterTexels of_centers = centers_of(raster.seen());
  raster.fill(camera, samples, NearPlane::cuts);
  const ShownTexels shown = choose_texels(of_centers, raster.seen(), raster.meshes(), picture);
  shade_texels(linear_view(), shown, picture, with_sky);
  return picture;
}

}  // namespace rilievo
