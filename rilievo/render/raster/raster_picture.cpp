#include "rilievo/render/raster/raster_picture.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/raster/band_shader.h"

namespace rilievo {
namespace {

const Material kDefaultMaterial;

const Material& material_of(const Scene& scene, const Mesh& mesh) {
  return mesh.material < 0 ? kDefaultMaterial : scene.materials[std::size_t(mesh.material)];
}

}  // namespace

struct PictureRasterizer::State {
  const Scene& scene;
  SampleRaster raster;
  std::vector<RasterInstance> instances;
  std::vector<PlacedMesh> placed;  // the same
  std::vector<Light> lights;
  tbb::enumerable_thread_specific<BandShader> shaders;

  void place(const Camera& camera, std::span<const std::uint32_t> objects,
             std::span<const glm::mat4> poses);
};

void PictureRasterizer::State::place(const Camera& camera, std::span<const std::uint32_t> objects,
                                     std::span<const glm::mat4> poses) {
  instances.clear();
  placed.clear();
  const glm::dmat4 clip = glm::transpose(clip_from_relative(camera));
  // The rows of raster_from_relative, before the division.
  const glm::dvec4 x = 0.5 * camera.width * (clip[0] + clip[3]),
                   y = 0.5 * camera.height * (clip[1] + clip[3]), z = 0.5 * (clip[2] + clip[3]);
  std::uint32_t name = 0;
  for (const std::uint32_t object : objects) {
    const glm::mat4 relative_from_model = relative_to(camera.position(), poses[object]);
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      const Material& material = material_of(scene, mesh);
      if (material.alpha_mode == AlphaMode::blend) continue;
      const glm::mat4 m = relative_from_model * part.model_from_mesh;
      // The cofactor matrix carries normals through any linear map; to which side they point then
      // is found out with the triangle (surface_points.h).
      SurfacePlacement surface;
      surface.relative_from_mesh = m;
      surface.normal_from_mesh = {glm::cross(glm::vec3(m[1]), glm::vec3(m[2])),
                                  glm::cross(glm::vec3(m[2]), glm::vec3(m[0])),
                                  glm::cross(glm::vec3(m[0]), glm::vec3(m[1]))};
      surface.has_normals = !mesh.normals.empty();
      surface.has_colors = !mesh.colors.empty();
      surface.base_color = glm::vec3(material.base_color);
      surface.emissive = material.emissive;
      surface.roughness = material.roughness, surface.metallic = material.metallic;
      surface.unlit = material.unlit;
      placed.push_back({&mesh, surface});
      const glm::dmat4 by(m);
      RasterInstance instance;
      instance.positions = mesh.positions.data();
      instance.indices = mesh.indices.data();
      instance.triangles = std::uint32_t(mesh.triangles());
      instance.first_name = name;
      instance.row_x = glm::vec4(x * by), instance.row_y = glm::vec4(y * by);
      instance.row_z = glm::vec4(z * by), instance.row_w = glm::vec4(clip[3] * by);
      const bool mirrored = glm::determinant(glm::mat3(m)) < 0;
      instance.front = material.double_sided || !mirrored;
      instance.back = material.double_sided || mirrored;
      instances.push_back(instance);
      name += instance.triangles;
    }
  }
}

bool PictureRasterizer::supports(const Scene& scene) {
  return std::all_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
    if (m.alpha_mode == AlphaMode::blend) return true;
    return m.alpha_mode == AlphaMode::opaque && m.base_color_texture.texture < 0 &&
           m.metallic_roughness_texture.texture < 0 && m.normal_texture.texture < 0 &&
           m.occlusion_texture.texture < 0 && m.emissive_texture.texture < 0;
  });
}

std::size_t PictureRasterizer::bytes(int size, int samples) {
  constexpr std::size_t kTexel = sizeof(RasterPicture::color[0]) + sizeof(RasterPicture::depth[0]);
  return SampleRaster::bytes(size, samples) + std::size_t(size) * std::size_t(size) * kTexel;
}

PictureRasterizer::PictureRasterizer(const Scene& scene) : state_(new State{scene}) {
  RILIEVO_EXPECTS(supports(scene));
}
PictureRasterizer::PictureRasterizer(PictureRasterizer&&) noexcept = default;
PictureRasterizer& PictureRasterizer::operator=(PictureRasterizer&&) noexcept = default;
PictureRasterizer::~PictureRasterizer() = default;

void PictureRasterizer::draw(const Camera& camera, std::span<const std::uint32_t> objects,
                             std::span<const glm::mat4> poses, int samples,
                             RasterPicture& picture) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  State& s = *state_;
  s.place(camera, objects, poses);
  s.raster.begin(camera.width, camera.height, samples);
  s.raster.draw(s.instances);

  picture.width = camera.width, picture.height = camera.height;
  const std::size_t texels = std::size_t(camera.width) * std::size_t(camera.height);
  picture.color.resize(texels);
  picture.depth.resize(texels);
  s.lights = s.scene.lights;
  if (s.lights.empty()) s.lights.push_back(default_sun());
  const glm::dmat3 axes(camera.world_from_eye);
  const ImageWindow& w = camera.window;
  const glm::dvec3 per_x = (w.right - w.left) / camera.width * axes[0];
  const glm::dvec3 per_y = (w.top - w.bottom) / camera.height * axes[1];
  const glm::dvec3 corner = axes * glm::dvec3(w.left, w.bottom, -1);
  const PictureView view{s.raster,
                         s.instances,
                         s.placed,
                         glm::vec3(corner + 0.5 * (per_x + per_y)),
                         glm::vec3(per_x),
                         glm::vec3(per_y),
                         {s.lights, camera.position(), s.scene.sky}};
  constexpr int kBand = BandShader::kBand;
  parallel_for(0, (camera.height + kBand - 1) / kBand, [&](int band) {
    s.shaders.local().shade(view, band * kBand, std::min((band + 1) * kBand, camera.height),
                            picture);
  });
}

}  // namespace rilievo
