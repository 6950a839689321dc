// Against the formulas as appendix B of the glTF 2.0 specification writes them.
#include "rilievo/render/shading/surface_shading.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "rilievo/core/color.h"
#include "rilievo/render/shading/shading_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

struct SurfaceCase {
  std::vector<Light> lights;
  SurfaceLights seen_by;
  Surfaces surfaces;
  Material materials[Surfaces::kMaxCount];
  glm::vec3 normal[Surfaces::kMaxCount], relative[Surfaces::kMaxCount];
};

std::unique_ptr<SurfaceCase> random_case(unsigned seed, std::size_t count) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  const auto direction = [&] {
    std::normal_distribution<float> n;
    return glm::normalize(glm::vec3(n(rng), n(rng), n(rng)));
  };
  auto c = std::make_unique<SurfaceCase>();
  c->seen_by.eye = {100, -20, 7};
  for (unsigned i = 0; i < 1 + seed % 3; ++i) {
    Light light;
    light.kind = Light::Kind(rng() % 3);
    light.direction = direction();
    light.intensity = 2.0f * glm::vec3(u(rng), u(rng), u(rng));
    light.position = glm::vec3(c->seen_by.eye) + 4.0f * direction();
    light.range = i % 2 ? 0.0f : 8.0f;
    light.inner_cone = 0.2f, light.outer_cone = 1.4f;
    c->lights.push_back(light);
  }
  c->seen_by.lights = c->lights;
  c->seen_by.sky.zenith = {u(rng), u(rng), u(rng)};
  c->surfaces.count = count;
  for (std::size_t i = 0; i < count; ++i) {
    Material& m = c->materials[i];
    m.base_color = {u(rng), u(rng), u(rng), 1};
    m.roughness = 0.2f + 0.8f * u(rng);  // what is smoother mirrors the sun in a point
    m.metallic = rng() % 2 ? u(rng) : 0.0f;
    if (rng() % 3 == 0) m.emissive = {0.1f * u(rng), 0, 0.1f * u(rng)};
    m.unlit = rng() % 8 == 0;
    c->relative[i] = 6.0f * u(rng) * direction();
    // A surface that is seen turns towards the eye.
    c->normal[i] = direction();
    if (glm::dot(c->normal[i], c->relative[i]) > 0) c->normal[i] = -c->normal[i];
    const auto set = [&](Surfaces::Field first, const glm::vec3& v) {
      for (int k = 0; k < 3; ++k) c->surfaces.field[first + k][i] = v[k];
    };
    set(Surfaces::base_r, glm::vec3(m.base_color));
    set(Surfaces::normal_x, (0.1f + u(rng)) * c->normal[i]);
    set(Surfaces::relative_x, c->relative[i]);
    set(Surfaces::view_x, -glm::normalize(c->relative[i]));
    set(Surfaces::emissive_r, m.emissive);
    set(Surfaces::roughness, {m.roughness, m.metallic, 1});
    c->surfaces.field[Surfaces::lit][i] = m.unlit ? 0.0f : 1.0f;
  }
  return c;
}

TEST(SurfaceShading, shades_as_the_specification_says) {
  for_each_instruction_set([](const char* name) {
    auto colors = std::make_unique<SurfaceColors>();
    int lit_by_lights = 0, compared = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      const auto c = random_case(seed, 1 + 37 * seed % Surfaces::kMaxCount);
      shade_surfaces(c->seen_by, c->surfaces, ColorScale::srgb, *colors);
      for (std::size_t i = 0; i < c->surfaces.count; ++i) {
        const Material& m = c->materials[i];
        std::vector<Incident> incident;
        for (const Light& light : c->lights) {
          incident.push_back(
              incident_by_definition(light, c->seen_by.eye + glm::dvec3(c->relative[i])));
          lit_by_lights += glm::dot(incident.back().towards, glm::dvec3(c->normal[i])) > 0 &&
                           incident.back().intensity.x > 1e-3;
        }
        const glm::dvec3 expected =
            m.unlit ? glm::dvec3(m.base_color)
                    : shade_by_definition(m, incident, c->seen_by.sky,
                                          glm::normalize(glm::dvec3(c->normal[i])),
                                          -glm::normalize(glm::dvec3(c->relative[i])));
        for (int k = 0; k < 3; ++k) {
          ++compared;
          // A fifth of a byte of the sRGB curve's polynomial; floats in the lobe of the smoothest
          // material.
          ASSERT_NEAR(colors->rgb[k][i], srgb_from_linear(std::min(float(expected[k]), 1.0f)),
                      0.25 / 255 + 2e-4)
              << name << ", case " << seed << ", surface " << i;
        }
      }
    }
    EXPECT_GT(compared, 10'000);
    EXPECT_GT(lit_by_lights, compared / 10);
  });
}

// What nothing is reflected by is black: less than that would darken what lights give it.
TEST(SurfaceShading, a_rough_black_metal_is_black) {
  Light none;
  none.intensity = glm::vec3(0);
  const SurfaceLights lights{{&none, 1}, {}, {}};
  Material black;
  black.base_color = {0, 0, 0, 1}, black.metallic = 1, black.roughness = 1;
  auto surfaces = std::make_unique<Surfaces>();
  auto colors = std::make_unique<SurfaceColors>();
  surfaces->count = 1;
  surfaces->field[Surfaces::normal_z][0] = 1, surfaces->field[Surfaces::relative_z][0] = -1;
  surfaces->field[Surfaces::roughness][0] = surfaces->field[Surfaces::metallic][0] = 1;
  surfaces->field[Surfaces::lit][0] = 1;
  shade_surfaces(lights, *surfaces, ColorScale::linear, *colors);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(colors->rgb[k][0], 0);
    EXPECT_EQ(shade_by_definition(black, {}, {}, {0, 0, 1}, {0, 0, 1})[k], 0);
  }
}

TEST(SurfaceShading, gives_the_same_bytes_on_every_instruction_set) {
  const auto c = random_case(2, Surfaces::kMaxCount);
  const auto expected = std::make_unique<SurfaceColors>(),
             colors = std::make_unique<SurfaceColors>();
  shade_surfaces(c->seen_by, c->surfaces, ColorScale::srgb, *expected);
  for_each_instruction_set([&](const char* name) {
    std::memset(colors.get(), 0, sizeof *colors);
    shade_surfaces(c->seen_by, c->surfaces, ColorScale::srgb, *colors);
    EXPECT_EQ(std::memcmp(colors.get(), expected.get(), sizeof *colors), 0) << name;
  });
}

}  // namespace
}  // namespace rilievo
