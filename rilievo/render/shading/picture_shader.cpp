#include "rilievo/render/shading/picture_shader.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/shading_model.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo {

void place_meshes(const Scene& scene, const SurfaceMaterials& materials, const glm::dvec3& eye,
                  std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses,
                  std::vector<PlacedMesh>& placed) {
  placed.clear();
  std::uint64_t triangles = 0;
  for (const std::uint32_t object : objects) {
    const glm::mat4 relative_from_model = relative_to(eye, poses[object]);
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts) {
      const SurfaceMaterial& material = materials.of_mesh(part.mesh);
      if (material.blended) continue;
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      placed.push_back({&mesh,
                        place_surface(mesh, material, relative_from_model * part.model_from_mesh),
                        std::uint32_t(triangles), std::uint32_t(mesh.primitives()), object});
      triangles += mesh.primitives();
    }
  }
  RILIEVO_EXPECTS(triangles < 0xFFFFFFFFu);
}

SurfaceLights surface_lights(const Scene& scene, const glm::dvec3& eye,
                             std::vector<Light>& storage) {
  storage = scene.lights;
  if (storage.empty()) storage.push_back(default_sun());
  return {storage, eye, scene.sky};
}

namespace {

// Calls write(x, depth, mesh) for the texels of a row that show something.
template <class Write>
void for_each_seen(const SampleBuffer& samples, std::span<const PlacedMesh> meshes, int row,
                   const Write& write) {
  const float* depths = samples.depths(row);
  const std::uint32_t* triangles = samples.triangles(row);
  const PlacedMesh* mesh = nullptr;  // of the last triangle, and mostly of the next one
  for (int x = 0; x < samples.width; ++x) {
    if (depths[x] >= 1) continue;
    if (!mesh || triangles[x] - mesh->first_triangle >= mesh->triangles)
      mesh = &meshes[mesh_of_triangle(meshes, triangles[x])];
    write(x, depths[x], *mesh);
  }
}

}  // namespace

void identify(const SampleBuffer& samples, std::span<const PlacedMesh> meshes,
              ObjectPicture& picture) {
  RILIEVO_EXPECTS(samples.samples == 1);
  picture.width = samples.width, picture.height = samples.height;
  const std::size_t texels = std::size_t(picture.width) * std::size_t(picture.height);
  picture.object.assign(texels, kNoObject);
  picture.depth.assign(texels, 1.0f);
  parallel_for(0, samples.height, [&](int y) {
    for_each_seen(samples, meshes, y, [&](int x, float depth, const PlacedMesh& mesh) {
      const std::size_t at = std::size_t(y) * std::size_t(picture.width) + std::size_t(x);
      picture.object[at] = mesh.object + 1;
      picture.depth[at] = depth;
    });
  });
}

void identify(const SampleBuffer& samples, std::span<const PlacedMesh> meshes, int first,
              DepthImage& picture) {
  RILIEVO_EXPECTS(samples.samples == 1);
  const Camera& camera = picture.camera;
  const double near = 1 / camera.z_near, per_z = 1 / camera.z_near - 1 / camera.z_far;
  picture.depth.resize(samples.width, camera.height);
  picture.object.resize(samples.width, camera.height);
  parallel_for(0, camera.height, [&](int y) {
    std::ranges::fill(picture.depth.row(y), kNoDepth);
    std::ranges::fill(picture.object.row(y), kNoObject);
    const int row = first + camera.height - 1 - y;
    for_each_seen(samples, meshes, row, [&](int x, float depth, const PlacedMesh& mesh) {
      picture.depth(x, y) = float(1 / (near - double(depth) * per_z));
      picture.object(x, y) = mesh.object + 1;
    });
  });
}

struct PictureShader::State {
  tbb::enumerable_thread_specific<BandShader> shaders;
};

PictureShader::PictureShader() : state_(new State) {}
PictureShader::PictureShader(PictureShader&&) noexcept = default;
PictureShader& PictureShader::operator=(PictureShader&&) noexcept = default;
PictureShader::~PictureShader() = default;

void PictureShader::shade(
    const PictureView& view, int first, int last,
    const std::function<void(const BandShader& shaded, int from, int to)>& write) {
  constexpr int kBand = BandShader::kBand;
  parallel_for(0, (last - first + kBand - 1) / kBand, [&](int band) {
    const int from = first + band * kBand, to = std::min(from + kBand, last);
    BandShader& shader = state_->shaders.local();
    shader.shade(view, from, to);
    write(shader, from, to);
  });
}

void PictureShader::shade(const PictureView& view, RasterPicture& picture) {
  RILIEVO_EXPECTS(view.scene.scale == ColorScale::srgb);
  picture.width = view.samples.width, picture.height = view.samples.height;
  const std::size_t width = std::size_t(picture.width),
                    texels = width * std::size_t(picture.height);
  picture.color.resize(texels);
  picture.depth.resize(texels);
  const int samples = view.samples.samples;
  const float scale = 255.0f / float(samples);
  shade(view, [&](const BandShader& shaded, int from, int /*to*/) {
    const std::size_t first = std::size_t(from) * width;
    const std::span<const glm::vec3> sums = shaded.color_sums();
    for (std::size_t i = 0; i < sums.size(); ++i)
      picture.color[first + i] = {
          glm::u8vec3(sums[i] * scale + 0.5f),
          std::uint8_t((510 * int(shaded.covered()[i]) + samples) / (2 * samples))};
    std::copy(shaded.nearest().begin(), shaded.nearest().end(),
              picture.depth.begin() + std::ptrdiff_t(first));
  });
}

void PictureShader::shade(const PictureView& view, DepthImage& picture, bool with_sky, int first) {
  RILIEVO_EXPECTS(view.scene.scale == ColorScale::linear);
  const int columns = view.samples.width, height = picture.camera.height;
  picture.color.resize(columns, height);
  const std::size_t width = std::size_t(columns);
  const float share = 1.0f / float(view.samples.samples);
  const SkyRays sky(picture.camera);
  shade(view, first, first + height, [&](const BandShader& shaded, int from, int to) {
    for (int row = from; row < to; ++row) {
      const int y = first + height - 1 - row;  // rows from the top
      for (int x = 0; x < columns; ++x) {
        const std::size_t i = std::size_t(row - from) * width + std::size_t(x);
        glm::vec4& color = picture.color(x, y);
        color = glm::vec4(0);
        if (!with_sky && !picture.covered(x, y)) continue;
        color = share * glm::vec4(shaded.color_sums()[i], float(shaded.covered()[i]));
        if (with_sky && color.a < 1)
          color = glm::vec4(glm::vec3(color) +
                                (1 - color.a) * sky.radiance(view.scene.lights.sky, x, row - first),
                            1.0f);
      }
    }
  });
}

}  // namespace rilievo
