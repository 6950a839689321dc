// The texel rule as every method draws it: no outline of what is in front stays on what is behind,
// and thin things stay in one piece.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "rilievo/capture/plate_test_helpers.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kWidth = 160, kHeight = 120;

Camera camera_at(const glm::dvec3& eye) {
  return look_at(eye, {0, 0, 0.5}, {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 50);
}

// Methods that draw from pictures, with small ones.
std::vector<std::pair<std::string, MethodOptions>> picture_methods(const Box& eyes) {
  std::vector<std::pair<std::string, MethodOptions>> made;
  for (const std::string& name : method_names()) {
    if (name.starts_with("direct") || name == "lod") continue;
    MethodOptions options;
    options.texel_px = 100;  // baked objects are drawn, however coarse
    options.angle_degrees = 20;
    options.eyes = eyes;
    if (const KindMethod baked = kind_method(name); baked.kind) {
      if (baked.variant) continue;
      for (const auto& [option, value] :
           {std::pair{"views", "12"}, {"size", "128"}, {"textures", "6"}, {"face", "128"}})
        if (find_option(options_of(*baked.kind, KindOptionsOf::bake), option))
          options.kinds.bake[option] = value;
    }
    made.emplace_back(name, options);
  }
  return made;
}

// Are both seen within two pixels?
bool at_an_edge(const Rgba8Image& truth, int x, int y) {
  bool red = false, green = false;
  for (int v = std::max(y - 2, 0); v <= std::min(y + 2, kHeight - 1); ++v)
    for (int u = std::max(x - 2, 0); u <= std::min(x + 2, kWidth - 1); ++u)
      red |= truth(u, v).r > 128, green |= truth(u, v).g > 128;
  return red && green;
}

TEST(PlateMethods, nothing_is_mixed_but_where_both_are_seen) {
  Random random(51);
  const Scene scene = test_plate::plate(random, false);
  Box eyes;
  eyes.add(glm::vec3(-0.4f, -0.2f, 3.0f)), eyes.add(glm::vec3(0.5f, 0.3f, 3.4f));
  SoftwareBackend backend(scene, 1);
  Result<Method> direct = make_method("direct", {}, backend);
  ASSERT_TRUE(direct.ok());
  for (const auto& [name, options] : picture_methods(eyes)) {
    SCOPED_TRACE(name);
    SoftwareBackend by(scene, 1);
    Result<Method> method = make_method(name, options, by);
    ASSERT_TRUE(method.ok()) << method.error().message();
    int mixed = 0, edge = 0;
    for (int i = 0; i < 6; ++i) {
      const Camera camera = camera_at({-0.4 + 0.16 * i, -0.2 + 0.1 * (i % 4), 3.0 + 0.08 * i});
      ASSERT_TRUE(direct->frames->draw(camera, 0).ok());
      // After a jump keyframes are coarse; these are whole in 16 frames, the next one in 16 more.
      for (int frame = 0; frame < (name == "keyframes" ? 40 : 1); ++frame)
        ASSERT_TRUE(method->frames->draw(camera, 0).ok());
      const Rgba8Image& truth = direct->frames->software_target()->color();
      const Rgba8Image& frame = method->frames->software_target()->color();
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          if (at_an_edge(truth, x, y)) {
            ++edge;
            continue;
          }
          // Neither wholly red nor wholly green, by 10 of 255 for rounding of shares.
          const glm::u8vec4 c = frame(x, y);
          mixed += std::min(std::max(255 - c.r, int(c.g)), std::max(255 - c.g, int(c.r))) > 10;
        }
    }
    EXPECT_GT(edge, 1000);
    // Nodes: where skins join what no node saw between, 0.16 % of the pixels.
    EXPECT_LE(mixed, name == "environment-nodes" ? 250 : 0);
  }
}

}  // namespace
}  // namespace rilievo
