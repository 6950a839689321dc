// What does a camera see of a Scene, by rays?
//
// The pictures that the rasterisers take, without OpenGL: the same surfaces, depths, object
// identifiers and shading (shading_model.inl). Blended parts and the sky are left out. All cores;
// same bytes for any number of threads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// One ray a texel: eye_z, linear light. Requires a valid camera.
[[nodiscard]] DepthImage cast_picture(const RayScene& scene, const Camera& camera);

// As PictureRasterizer draws: a ray through each sample.
class PictureCaster {
 public:
  // `scene` must outlive it.
  explicit PictureCaster(const RayScene& scene);
  PictureCaster(PictureCaster&&) noexcept;
  PictureCaster& operator=(PictureCaster&&) noexcept;
  ~PictureCaster();

  // What the camera, of any kind, sees of `objects` (none: of all), with 1 or 4 samples a texel.
  // What lies before the near plane is not seen. Depth is window_z; of a back-perspective picture,
  // which keeps the farthest, 1 - window_z.
  void draw(const Camera& camera, std::span<const std::uint32_t> objects, int samples,
            RasterPicture& picture);

 private:
  friend DepthImage cast_picture(const RayScene& scene, const Camera& camera);
  struct State;
  std::unique_ptr<State> state_;
};

// Shades what single rays of a picture meet as cast_picture does. Any thread.
class HitShader {
 public:
  // `scene` must outlive it.
  HitShader(const RayScene& scene, const Camera& camera);
  HitShader(const HitShader&) = delete;  // its lights lie in itself
  HitShader& operator=(const HitShader&) = delete;
  // Linear, opaque. Of the ray through the middle of texel (x, y), y from the top; where a
  // single-sided surface is met from behind, the light of its front as a mirror behind it shows it.
  [[nodiscard]] glm::vec4 shade(const RayHit& hit, int x, int y) const;

 private:
  const RayScene& scene_;
  PictureRays rays_;
  int height_;
  std::vector<Light> storage_;
  SurfaceLights lights_;
};

// The ray of a raster position, from where the camera stops looking towards where it would rather
// see: an ordinary camera looks from its near plane, a back-perspective one from its far plane
// towards the apex, so that the first hit is the farthest from the apex (S2.1). `eye_z` along it is
// eye_z_start + t * eye_z_step for t in [0, 1].
struct CameraRay {
  glm::dvec3 origin, direction;
  double eye_z_start = 0, eye_z_step = 0;
};
[[nodiscard]] CameraRay camera_ray(const Camera& camera, const glm::dvec2& raster);

}  // namespace rilievo
