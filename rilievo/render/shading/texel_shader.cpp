#include "rilievo/render/shading/texel_shader.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/texel_rule.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo {
namespace {

// The object of a triangle, which mostly is that of the last one.
class ObjectFinder {
 public:
  explicit ObjectFinder(std::span<const PlacedMesh> meshes) : meshes_(meshes) {}
  [[nodiscard]] std::uint32_t object(std::uint32_t triangle) {
    if (!mesh_ || triangle - mesh_->first_triangle >= mesh_->triangles)
      mesh_ = &meshes_[mesh_of_triangle(meshes_, triangle)];
    return mesh_->object + 1;
  }

 private:
  std::span<const PlacedMesh> meshes_;
  const PlacedMesh* mesh_ = nullptr;
};

}  // namespace

CenterTexels centers_of(const SampleBuffer& samples) {
  RILIEVO_EXPECTS(samples.samples == 1);
  CenterTexels centers{Image<float>(samples.width, samples.height),
                       Image<std::uint32_t>(samples.width, samples.height)};
  parallel_for(0, samples.height, [&](int y) {
    const float* depths = samples.depths(y);
    const std::uint32_t* triangles = samples.triangles(y);
    for (int x = 0; x < samples.width; ++x) {
      centers.depth(x, y) = depths[x];
      centers.triangle(x, y) = depths[x] < 1.0f ? triangles[x] : ShownTexels::kNothing;
    }
  });
  return centers;
}

ShownTexels choose_texels(const CenterTexels& centers, const SampleBuffer& samples,
                          std::span<const PlacedMesh> meshes, DepthImage& picture) {
  const int width = samples.width, height = samples.height, count = samples.samples;
  std::vector<glm::vec2> places;
  for (int s = 0; s < count; ++s) places.push_back(sample_position(s, count) - 0.5f);
  TexelSamples texels(picture.camera, places);
  // Back-perspective cameras have 1 - window_z in their buffers.
  const bool flipped = picture.camera.keeps_farthest();
  const auto nearness = [&](float depth) {
    return depth < 1.0f ? texels.nearness.of_window_z(flipped ? 1.0f - depth : depth) : kNoNearness;
  };
  parallel_for(0, height, [&](int y) {
    ObjectFinder finder(meshes);
    const float* depths = samples.depths(y);
    const std::uint32_t* triangles = samples.triangles(y);
    for (int x = 0; x < width; ++x) {
      texels.center(x, y) = nearness(centers.depth(x, y));
      if (texels.center(x, y) != kNoNearness)
        texels.center_object(x, y) = finder.object(centers.triangle(x, y));
      const std::size_t first = texels.first(x, y), from = std::size_t(x) * std::size_t(count);
      for (std::size_t s = 0; s < std::size_t(count); ++s) {
        if (!(depths[from + s] < 1.0f)) continue;
        texels.sample[first + s] = nearness(depths[from + s]);
        texels.sample_object[first + s] = finder.object(triangles[from + s]);
      }
    }
  });
  ShownSamples shown = choose_samples(texels);
  for (const ThinTexel& thin : shown.thin) {
    picture.depth(thin.x, height - 1 - thin.y) = float(texels.nearness.eye_z(thin.nearness));
    picture.object(thin.x, height - 1 - thin.y) = thin.object;
  }
  return {std::move(shown.mask), centers.triangle};
}

namespace {

constexpr int kTexelBand = 8;  // rows

// What of a texel's samples is to be shaded: each triangle once, with the samples that show it.
void add_texel(const PictureView& view, const ShownTexels& shown, int x, int y,
               SeenTriangles& seen) {
  const int samples = view.samples.samples;
  const unsigned all = (1u << samples) - 1, mask = shown.mask(x, y);
  const auto add = [&](std::uint32_t triangle, unsigned set) {
    seen.add(view.scene.meshes, {triangle, std::uint16_t(x), std::uint16_t(y), std::uint16_t(set)});
  };
  if (mask == 0) {
    // All samples together: that is the centre.
    if (shown.center_triangle(x, y) != ShownTexels::kNothing) add(shown.center_triangle(x, y), all);
    return;
  }
  const std::uint32_t* triangles = view.samples.triangles(y) + std::ptrdiff_t(x) * samples;
  for (int s = 0; s < samples; ++s) {
    if (!(mask >> s & 1)) continue;
    unsigned same = 0;
    for (int k = 0; k < samples; ++k)
      same |= unsigned((mask >> k & 1) && triangles[k] == triangles[s]) << k;
    if (same >> s << s == same) add(triangles[s], same);  // s is the first
  }
}

}  // namespace

void shade_texels(const PictureView& view, const ShownTexels& shown, DepthImage& picture,
                  bool with_sky) {
  RILIEVO_EXPECTS(view.scene.scale == ColorScale::linear);
  const int width = view.samples.width, height = view.samples.height;
  const int samples = view.samples.samples, last = height - 1;  // rows from the top
  picture.color = ColorImage(width, height);
  const SkyRays sky(picture.camera);
  tbb::enumerable_thread_specific<SeenTriangles> seen_by_thread;
  parallel_for(0, (height + kTexelBand - 1) / kTexelBand, [&](int band) {
    const int from = band * kTexelBand, to = std::min(from + kTexelBand, height);
    SeenTriangles& seen = seen_by_thread.local();
    for (int y = from; y < to; ++y)
      for (int x = 0; x < width; ++x)
        if (picture.covered(x, last - y)) add_texel(view, shown, x, y, seen);
    seen.shade(view.scene, [&](const SeenTriangles::Shaded& shaded) {
      const auto& rgb = shaded.colors.rgb;
      for (std::size_t i = 0; i < shaded.pixels.size(); ++i) {
        const SeenTriangles::Pixel& pixel = shaded.pixels[i];
        picture.color(pixel.x, last - pixel.y) +=
            float(std::popcount(pixel.samples)) * glm::vec4(rgb[0][i], rgb[1][i], rgb[2][i], 1.0f);
      }
    });
    for (int y = from; y < to; ++y) {
      const float* depths = view.samples.depths(y);
      for (int x = 0; x < width; ++x) {
        glm::vec4& color = picture.color(x, last - y);
        if (!picture.covered(x, last - y)) {
          if (with_sky) color = glm::vec4(sky.radiance(view.scene.lights.sky, x, y), 1.0f);
          continue;
        }
        const float* depth = depths + std::ptrdiff_t(x) * samples;
        const auto covered = std::count_if(depth, depth + samples, [](float z) { return z < 1; });
        // What only the centre shows is at least as large as one sample's part.
        const float alpha = with_sky ? 1.0f : float(std::max(int(covered), 1)) / float(samples);
        glm::vec3 own = glm::vec3(color) / color.a;
        // A sky is behind what covers a texel in part.
        if (with_sky && covered > 0 && covered < samples)
          own = glm::mix(sky.radiance(view.scene.lights.sky, x, y), own,
                         float(covered) / float(samples));
        color = alpha * glm::vec4(own, 1.0f);
      }
    }
  });
}

}  // namespace rilievo
