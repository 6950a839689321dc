// The meshes of a picture and the colours of its texels, for the rasteriser and for
// rays.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/shading/band_shader.h"
#include "rilievo/render/shading/surface_materials.h"

namespace rilievo {

// Places the opaque and masked parts of `objects` (indices into Scene::objects) by `poses` (of all
// objects) relative to `eye`, in this order. Requires fewer than 2^32 triangles.
void place_meshes(const Scene& scene, const SurfaceMaterials& materials, const glm::dvec3& eye,
                  std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses,
                  std::vector<PlacedMesh>& placed);

// The lights of a scene, or the default sun, which is then stored in `storage`.
[[nodiscard]] SurfaceLights surface_lights(const Scene& scene, const glm::dvec3& eye,
                                           std::vector<Light>& storage);

// A picture with rows from the bottom, as in OpenGL.
struct RasterPicture {
  int width = 0, height = 0;
  std::vector<glm::u8vec4> color;  // sRGB, premultiplied; alpha is the share of covered samples
  std::vector<float> depth;        // window_z of the nearest sample; 1: nothing
};

// Object identifiers and depths of a picture with one sample per texel; rows from the bottom.
struct ObjectPicture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> object;  // index into Scene::objects + 1; kNoObject: nothing
  std::vector<float> depth;           // window_z; 1: nothing
};
// Fills the picture. Requires one sample per texel, and meshes in the order of their triangles.
void identify(const SampleBuffer& samples, std::span<const PlacedMesh> meshes,
              ObjectPicture& picture);

// Sets depths (eye_z) and objects of a picture whose rows are those of the samples from row `first`
// on, rows from the bottom. Requires the picture's camera, which is a perspective one, and one
// sample per texel.
void identify(const SampleBuffer& samples, std::span<const PlacedMesh> meshes, int first,
              DepthImage& picture);

// Shades pictures on all cores. Keeps its buffers.
class PictureShader {
 public:
  PictureShader();
  PictureShader(PictureShader&&) noexcept;
  PictureShader& operator=(PictureShader&&) noexcept;
  ~PictureShader();

  // Calls write(shaded, from, to) for bands of rows [from, to), by any thread, in any order.
  void shade(const PictureView& view,
             const std::function<void(const BandShader& shaded, int from, int to)>& write) {
    shade(view, 0, view.samples.height, write);
  }
  // Of rows [first, last) only.
  void shade(const PictureView& view, int first, int last,
             const std::function<void(const BandShader& shaded, int from, int to)>& write);
  // Fills the picture. Requires ColorScale::srgb.
  void shade(const PictureView& view, RasterPicture& picture);
  // Sets the colours: coverage in alpha; 0 where the depth, which must be there, is kNoDepth. Or,
  // `with_sky`: whatever no surface covers of a texel shows the sky of view.lights, and alpha is 1.
  // Requires ColorScale::linear, and the picture's camera. The picture's rows are those of the
  // samples from row `first` on, rows from the bottom.
  void shade(const PictureView& view, DepthImage& picture, bool with_sky = false, int first = 0);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
