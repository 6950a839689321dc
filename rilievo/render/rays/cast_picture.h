// A camera's picture of a Scene, by ray casting.
//
// Gives the pictures of the rasterisers without OpenGL: the same surfaces, depths, object
// identifiers and shading (shading_model.inl). Blended parts are left out: pictures require a
// RayScene of RayParts::opaque. Uses all cores; the result does not depend on the number of
// threads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

class StrokeHits;

// Options of cast_picture.
struct CastOptions {
  std::span<const std::uint32_t> objects = {};  // indices into Scene::objects; empty: all
  int samples = 1;                              // rays of a texel for its colour: 1 or 4
  bool sky = false;                             // behind what covers a texel in part or not at all
  bool staggered = false;  // with one ray: at staggered_position() (sample_buffer.h)
};

// Casts a ray through each texel's sample: eye_z, object, and linear light. With 4 samples colours
// are averaged over other rays, and alpha is coverage; where the centre shows nothing, so does the
// texel, unless there is a sky: then every texel has a colour, and is opaque. Requires a valid
// camera.
[[nodiscard]] DepthImage cast_picture(const RayScene& scene, const Camera& camera,
                                      const CastOptions& options = {});

// Draws like PictureRasterizer, with a ray through each sample.
class PictureCaster {
 public:
  // `scene` must outlive the object, and be of RayParts::opaque.
  explicit PictureCaster(const RayScene& scene);
  PictureCaster(PictureCaster&&) noexcept;
  PictureCaster& operator=(PictureCaster&&) noexcept;
  ~PictureCaster();

  // Draws `objects` (empty: all) as seen by a camera of any kind, with 1 or 4 samples per texel.
  // Parts in front of the near plane are invisible. Depth is window_z, or 1 - window_z for a
  // back-perspective camera, which keeps the farthest surface.
  void draw(const Camera& camera, std::span<const std::uint32_t> objects, int samples,
            RasterPicture& picture);
  // Finds 1 or 4 samples a texel of all objects: seen() and meshes() are what was found,
  // view() is ready to be shaded. Valid until the next call.
  void cast(const Camera& camera, int samples);
  [[nodiscard]] PictureView view(const Camera& camera);
  [[nodiscard]] const SampleBuffer& seen() const;
  [[nodiscard]] std::span<const PlacedMesh> meshes() const;
  // Draws the identifiers and depths of all objects, with a ray through each pixel's centre.
  void draw_objects(const Camera& camera, ObjectPicture& picture);
  // Draws all objects, with one sample per texel, for a frame whose pixels are smaller than the
  // camera's texels: `pixel` texels wide. Textures are filtered for the frame's pixels, and
  // pinholes are filled (fill_pinholes.h).
  void draw_coarse(const Camera& camera, float pixel, RasterPicture& picture);
  // Draws the identifiers and depths of that picture.
  void draw_coarse_objects(const Camera& camera, float pixel, ObjectPicture& picture);

 private:
  friend DepthImage cast_picture(const RayScene& scene, const Camera& camera,
                                 const CastOptions& options);
  struct State;
  std::unique_ptr<State> state_;
};

// eye_z of the last surface along the ray of a raster position, back faces included; kNoDepth:
// none. `strokes`: of this camera, and of the objects that count.
[[nodiscard]] float farthest_eye_z(const RayScene& scene, const Camera& camera,
                                   const glm::dvec2& raster, const StrokeHits& strokes);

// Shades hits of single rays as cast_picture does. Any thread.
class HitShader {
 public:
  // `scene` must outlive the object. `least_roughness`: as CastLayersOptions has it.
  HitShader(const RayScene& scene, const Camera& camera, float least_roughness = 0);
  HitShader(const HitShader&) = delete;  // its lights lie in itself
  HitShader& operator=(const HitShader&) = delete;
  // The linear, opaque colour of a hit of the ray through the centre of texel (x, y), y from the
  // top. The back of a single-sided surface has the light of its front, mirrored.
  [[nodiscard]] glm::vec4 shade(const RayHit& hit, int x, int y) const;

 private:
  const RayScene& scene_;
  PictureRays rays_;
  int height_;
  float least_roughness_;
  std::vector<Light> storage_;
  SurfaceLights lights_;
};

// The ray of a raster position, in the direction in which the camera looks for its sample. An
// ordinary camera's ray starts at its near plane. A back-perspective camera's ray starts at the far
// plane and goes towards the apex, so that its first hit is the farthest from the apex (S2.1).
// eye_z along the ray is eye_z_start + t * eye_z_step for t in [0, 1].
struct CameraRay {
  glm::dvec3 origin, direction;
  double eye_z_start = 0, eye_z_step = 0;
};
// The ray of a raster position.
[[nodiscard]] CameraRay camera_ray(const Camera& camera, const glm::dvec2& raster);

}  // namespace rilievo
