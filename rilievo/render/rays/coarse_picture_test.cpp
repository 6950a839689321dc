#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "rilievo/core/color.h"
#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/render/rays/box_test_helpers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/fill_pinholes.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {
namespace {

namespace model = shading_model;

// A texel of a SampleBuffer; nothing at depth 1.
struct Seen {
  std::uint32_t triangle = 0;
  float depth = 1;
};

// Three objects of two triangles each.
std::uint32_t object_of(const Seen& seen) { return seen.depth < 1 ? seen.triangle / 2 + 1 : 0; }

// What the comment says, texel by texel.
Seen filled_by_definition(const Image<Seen>& picture, int x, int y) {
  const Seen own = picture(x, y);
  if (x == 0 || y == 0 || x == picture.width() - 1 || y == picture.height() - 1) return own;
  std::map<std::uint32_t, int> shown;  // by how many neighbours
  bool in_front = true;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      if (i == 0 && j == 0) continue;
      const Seen& other = picture(x + i, y + j);
      ++shown[object_of(other)];
      if (object_of(other) != object_of(own)) in_front &= other.depth < own.depth;
    }
  const int alike = shown[object_of(own)];
  shown.erase(object_of(own));
  if (alike > 1 || shown.size() != 1 || shown.count(0) == 1 || !in_front) return own;
  for (const glm::ivec2 side : {glm::ivec2(-1, 0), {1, 0}, {0, -1}, {0, 1}})
    if (object_of(picture(x + side.x, y + side.y)) != object_of(own))
      return picture(x + side.x, y + side.y);
  ADD_FAILURE() << "a pinhole without a cover";
  return own;
}

TEST(PinholeFiller, fills_what_the_definition_calls_pinholes) {
  std::mt19937 rng(31);
  std::uniform_real_distribution<float> u(0, 1);
  std::vector<PlacedMesh> meshes(3);
  for (std::uint32_t m = 0; m < 3; ++m)
    meshes[m].first_triangle = 2 * m, meshes[m].triangles = 2, meshes[m].object = m;
  PinholeFiller filler;
  int filled = 0, kept = 0;
  for (int run = 0; run < sanitized_cases(300); ++run) {
    const int width = 1 + int(rng() % 24), height = 1 + int(rng() % 16);
    // Mostly one object, or the lower half another one, with specks of all kinds.
    const bool halves = rng() % 2;
    const float specks = 0.02f + 0.1f * u(rng);
    Image<Seen> picture(width, height);
    SampleBuffer samples;
    samples.begin(width, height, 1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::uint32_t object = halves && y < height / 2 ? 2 : 1;
        if (u(rng) < specks) object = std::uint32_t(rng() % 4);
        Seen& seen = picture(x, y);
        if (object > 0)
          seen = {2 * (object - 1) + std::uint32_t(rng() % 2),
                  std::min(0.99f, 0.3f * float(object) + 0.2f * u(rng))};
        samples.depth[samples.row(y) + std::size_t(x)] = seen.depth;
        samples.triangle[samples.row(y) + std::size_t(x)] = seen.triangle;
      }
    filler.fill(meshes, samples);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Seen expected = filled_by_definition(picture, x, y), own = picture(x, y);
        EXPECT_EQ(samples.depths(y)[x], expected.depth);
        if (expected.depth < 1) {
          EXPECT_EQ(samples.triangles(y)[x], expected.triangle);
        }
        (expected.depth == own.depth ? kept : filled) += object_of(own) != 1;
      }
  }
  EXPECT_GT(filled, sanitized_cases(600));
  EXPECT_GT(kept, sanitized_cases(600));
}

// A square that fills the view, with noise on it.
Scene noise(int texels) {
  std::mt19937 rng(32);
  Scene scene;
  Rgba8Image& image = scene.images.emplace_back(texels, texels, glm::u8vec4(255));
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x)
      image(x, y) = {std::uint8_t(rng()), std::uint8_t(rng()), std::uint8_t(rng()), 255};
  scene.textures.emplace_back();
  Material material;
  material.unlit = true;
  material.base_color_texture.texture = 0;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.material = 0;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  Model& quad = scene.models.emplace_back();
  quad.parts.push_back({0, glm::mat4(1)});
  scene.objects.emplace_back();
  finish(scene);
  return scene;
}

TEST(CoarsePicture, textures_are_as_sharp_as_in_the_frame) {
  constexpr int kTexels = 200, kWidth = 50;
  const Scene scene = noise(kTexels);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PictureCaster caster(*rays);
  const Camera camera =
      look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1.0), kWidth, kWidth, 0.5, 2);
  const SurfaceMaterials materials(scene);
  const SurfaceTexture& texture = *materials.of_mesh(0).base;
  std::vector<glm::u8vec4> last;
  for (const double pixel : {1.0, 0.5, 0.25}) {
    RasterPicture picture;
    caster.draw_coarse(camera, float(pixel), picture);
    // The level whose texels are as large as the frame's pixels.
    const double level = std::log2(kTexels / (kWidth / pixel));
    for (int y = 0; y < kWidth; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const model::Vec4<double> expected =
            model::sample_texture<double>(texture.levels, {(x + 0.5) / kWidth, (y + 0.5) / kWidth},
                                          level, model::DecodeColor<double>{texture.levels.srgb});
        const glm::u8vec4 found = picture.color[std::size_t(y) * kWidth + std::size_t(x)];
        // Floats place a texel of the texture within some thousandths of one, and bytes are
        // rounded.
        EXPECT_NEAR(found.r, 255 * srgb_from_linear(expected.x), 1.5);
        EXPECT_NEAR(found.g, 255 * srgb_from_linear(expected.y), 1.5);
        EXPECT_NEAR(found.b, 255 * srgb_from_linear(expected.z), 1.5);
      }
    EXPECT_NE(picture.color, last);
    last = picture.color;
  }
}

}  // namespace
}  // namespace rilievo
