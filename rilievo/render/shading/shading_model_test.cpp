// Textures against their definition in OpenGL 4.5 (8.14), lanes against single numbers.
#include "rilievo/render/shading/shading_model.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "rilievo/core/color.h"
#include "rilievo/render/shading/shading_scenes_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"
#include "rilievo/render/shading/surface_points.h"

namespace rilievo {
namespace {

namespace model = shading_model;

Rgba8Image random_texels(std::mt19937& rng, int width, int height) {
  Rgba8Image texels(width, height);
  for (glm::u8vec4& c : texels.texels()) c = glm::u8vec4(rng(), rng(), rng(), rng());
  return texels;
}

glm::dvec4 linear(const glm::u8vec4& c, bool srgb) {
  const auto part = [&](std::uint8_t b) {
    return srgb ? double(linear_from_srgb(float(b) / 255)) : b / 255.0;
  };
  return {part(c.r), part(c.g), part(c.b), c.a / 255.0};
}

// As textures are sampled: by a curve that has a test of its own.
glm::dvec4 decoded(const glm::u8vec4& c, bool srgb) {
  glm::dvec4 part = glm::dvec4(c) / 255.0;
  if (srgb)
    for (int k = 0; k < 3; ++k) part[k] = model::linear_from_srgb_byte(part[k]);
  return part;
}

int wrapped_by_definition(Wrap wrap, int i, int n) {
  const int period = wrap == Wrap::mirrored_repeat ? 2 * n : n;
  const int k = ((i % period) + period) % period;
  if (wrap == Wrap::clamp_to_edge) return std::clamp(i, 0, n - 1);
  return k < n ? k : period - 1 - k;
}

// Level by level: texels as a function of whole numbers, mixed by their distances.
glm::dvec4 sample_by_definition(const std::vector<Rgba8Image>& levels, const Texture& t, bool srgb,
                                const glm::dvec2& uv, double level) {
  const double clamped = std::clamp(level, 0.0, double(levels.size() - 1));
  glm::dvec4 sum(0.0);
  for (int l = 0; l < int(levels.size()); ++l) {
    const double weight = std::max(0.0, 1 - std::abs(clamped - l));
    if (weight == 0) continue;
    const Rgba8Image& texels = levels[std::size_t(l)];
    const auto texel = [&](int x, int y) {
      return decoded(texels(wrapped_by_definition(t.wrap_u, x, texels.width()),
                            wrapped_by_definition(t.wrap_v, y, texels.height())),
                     srgb);
    };
    glm::dvec2 at = uv * glm::dvec2(texels.width(), texels.height());
    if (t.nearest && level <= 0) {
      sum += weight * texel(int(std::floor(at.x)), int(std::floor(at.y)));
      continue;
    }
    at -= 0.5;
    const glm::dvec2 cell = glm::floor(at), f = at - cell;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i)
        sum += weight * (i ? f.x : 1 - f.x) * (j ? f.y : 1 - f.y) *
               texel(int(cell.x) + i, int(cell.y) + j);
  }
  return sum;
}

std::vector<Rgba8Image> all_levels(const Rgba8Image& texture, const MipChain& chain) {
  std::vector<Rgba8Image> levels{texture};
  for (std::size_t l = 1; l < chain.levels.size(); ++l) {
    const MipChain::Level& level = chain.levels[l];
    Rgba8Image& image = levels.emplace_back(level.width, level.height);
    std::copy_n(chain.texels.begin() + std::ptrdiff_t(level.offset), image.texels().size(),
                image.texels().begin());
  }
  return levels;
}

TEST(ShadingModel, samples_textures_as_opengl_defines) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(-2.5, 2.5), v(-1.5, 5.5);
  for (int round = 0; round < 200; ++round) {
    Scene scene;
    Texture& t = scene.textures.emplace_back();
    const Rgba8Image& texels =
        scene.images.emplace_back(random_texels(rng, 1 + int(rng() % 20), 1 + int(rng() % 20)));
    t.wrap_u = Wrap(rng() % 3), t.wrap_v = Wrap(rng() % 3);
    t.nearest = rng() % 3 == 0;
    Material& m = scene.materials.emplace_back();
    const bool srgb = rng() % 2;
    (srgb ? m.base_color_texture : m.normal_texture).texture = 0;
    scene.meshes.emplace_back().material = 0;
    const SurfaceMaterials materials(scene);
    const SurfaceMaterial& material = materials.of_mesh(0);
    const SurfaceTexture& texture = srgb ? *material.base : *material.normal;
    const std::vector<Rgba8Image> levels = all_levels(texels, build_mip_chain(texels, srgb));
    for (int i = 0; i < 50; ++i) {
      const glm::dvec2 uv(u(rng), u(rng));
      // Where a texel ends, rounding decides which one is the nearest.
      const glm::dvec2 at = uv * glm::dvec2(texels.width(), texels.height());
      const glm::dvec2 to_edge = glm::abs(at - glm::round(at));
      if (t.nearest && std::min(to_edge.x, to_edge.y) < 1e-4) continue;
      const double level = v(rng);
      const glm::dvec4 expected = sample_by_definition(levels, t, srgb, uv, level);
      const model::DecodeColor<double> decode{srgb};
      const auto found = model::sample_texture<double>(texture.levels, {uv.x, uv.y}, level, decode);
      // Constants are floats.
      EXPECT_LE(glm::length(glm::dvec4(found.x, found.y, found.z, found.w) - expected), 1e-6);
      const model::DecodeColor<float> decode_float{srgb};
      const auto single = model::sample_texture<float>(texture.levels, {float(uv.x), float(uv.y)},
                                                       float(level), decode_float);
      // A float's place, times the steepest slope there is: a whole step from texel to texel.
      EXPECT_LE(glm::length(glm::dvec4(single.x, single.y, single.z, single.w) - expected), 5e-5);
    }
  }
}

TEST(ShadingModel, linear_from_srgb_byte_is_a_hundredth_of_a_byte_off) {
  double last = -1;
  for (int byte = 0; byte < 256; ++byte) {
    const double exact = linear_of_srgb_bytes()[std::size_t(byte)];
    const auto light = double(model::linear_from_srgb_byte(float(byte) * (1.0f / 255.0f)));
    EXPECT_GT(light, last);
    last = light;
    // By how much a byte's light differs from the next one's.
    const double step = byte < 255 ? linear_of_srgb_bytes()[std::size_t(byte) + 1] - exact
                                   : exact - linear_of_srgb_bytes()[254];
    EXPECT_LE(std::abs(light - exact), 0.013 * step) << byte;
  }
}

TEST(ShadingModel, smaller_levels_are_averages_in_linear_light) {
  std::mt19937 rng(4);
  for (int round = 0; round < 60; ++round) {
    const bool srgb = round % 2;
    const Rgba8Image texels = random_texels(rng, 1 + int(rng() % 33), 1 + int(rng() % 33));
    const MipChain chain = build_mip_chain(texels, srgb);
    const std::vector<Rgba8Image> levels = all_levels(texels, chain);
    EXPECT_EQ(levels.back().width() * levels.back().height(), 1);
    for (std::size_t l = 1; l < levels.size(); ++l) {
      const Rgba8Image &above = levels[l - 1], &level = levels[l];
      ASSERT_EQ(level.width(), std::max(1, above.width() / 2));
      ASSERT_EQ(level.height(), std::max(1, above.height() / 2));
      const double wide = double(above.width()) / level.width(),
                   high = double(above.height()) / level.height();
      const auto overlap = [](double a, double b, int k) {
        return std::max(0.0, std::min(b, k + 1.0) - std::max(a, double(k)));
      };
      for (int y = 0; y < level.height(); ++y)
        for (int x = 0; x < level.width(); ++x) {
          glm::dvec4 sum(0.0);
          for (int j = 0; j < above.height(); ++j)
            for (int i = 0; i < above.width(); ++i)
              sum += overlap(x * wide, (x + 1) * wide, i) * overlap(y * high, (y + 1) * high, j) *
                     linear(above(i, j), srgb);
          sum /= wide * high;
          for (int k = 0; k < 4; ++k) {
            const double encoded =
                255 * (srgb && k < 3 ? double(srgb_from_linear(float(sum[k]))) : sum[k]);
            // Rounding, and that of the floats before it.
            ASSERT_LE(std::abs(level(x, y)[k] - encoded), 0.5 + 1e-3) << x << " " << y;
          }
        }
    }
  }
}

// Rays through a square and a sphere with every texture there is.
TEST(ShadingModel, lanes_give_the_bytes_of_single_numbers) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> u(-1, 1);
  int compared = 0;
  for (const ShadingScene& shown : shading_scenes()) {
    const Scene& scene = shown.scene;
    const SurfaceMaterials materials(scene);
    const Mesh& mesh = scene.meshes[0];
    const SurfacePlacement placement =
        place_surface(mesh, materials.of_mesh(0),
                      relative_to(shown.camera.position(), scene.objects[0].placement));
    const PictureRays rays = picture_rays(shown.camera);
    auto in = std::make_unique<TriangleRays>();  // zeros
    in->count = 37;
    std::vector<model::Corners<float>> corners(in->count);
    for (std::size_t i = 0; i < in->count; ++i) {
      const glm::vec3 ray = rays.through(48 + 20 * u(rng), 48 + 20 * u(rng));
      for (int axis = 0; axis < 3; ++axis) in->ray[axis][i] = ray[axis];
      const std::uint32_t* at = &mesh.indices[3 * (rng() % mesh.triangles())];
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 p = mesh.positions[at[k]], n = mesh.normals[at[k]];
        const glm::vec3 c = mesh.colors.empty() ? glm::vec3(0) : glm::vec3(mesh.colors[at[k]]);
        for (int axis = 0; axis < 3; ++axis) {
          in->position[k][axis][i] = p[axis], in->normal[k][axis][i] = n[axis];
          in->color[k][axis][i] = c[axis];
        }
        corners[i].position[k] = p, corners[i].normal[k] = n, corners[i].color[k] = c;
        for (int set = 0; set < 2; ++set) {
          const glm::vec2 uv = mesh.uv[set][at[k]];
          in->uv[set][k][0][i] = uv.x, in->uv[set][k][1][i] = uv.y;
          corners[i].uv[set][k] = {uv.x, uv.y};
        }
      }
    }
    for_each_instruction_set([&](const char* name) {
      auto out = std::make_unique<Surfaces>();
      auto colors = std::make_unique<SurfaceColors>();
      append_surfaces(*in, rays, placement, *out);
      const SurfaceLights lights{scene.lights, shown.camera.position(), scene.sky};
      shade_surfaces(lights, *out, ColorScale::linear, *colors);
      for (std::size_t i = 0; i < in->count; ++i) {
        const auto point = model::surface_at<float>(
            rays, placement, {in->ray[0][i], in->ray[1][i], in->ray[2][i]}, corners[i]);
        const auto light = model::shade_point(lights, point);
        const float expected[] = {point.base.x,    point.normal.y,  point.emissive.z,
                                  point.roughness, point.occlusion, light.x,
                                  light.y,         light.z};
        const float found[] = {out->field[Surfaces::base_r][i],
                               out->field[Surfaces::normal_y][i],
                               out->field[Surfaces::emissive_b][i],
                               out->field[Surfaces::roughness][i],
                               out->field[Surfaces::occlusion][i],
                               colors->rgb[0][i],
                               colors->rgb[1][i],
                               colors->rgb[2][i]};
        ASSERT_EQ(std::memcmp(expected, found, sizeof found), 0)
            << name << ", " << shown.name << ", ray " << i;
        ++compared;
      }
    });
  }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace rilievo
