// Do all methods show points and lines as frames of the scene itself do?
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// A ball of coloured points within a cage of lines.
Scene ball_in_a_cage() {
  Scene scene;
  scene.name = "ball";
  Mesh ball;
  ball.primitive = Primitive::points;
  ball.width = 0.06f;
  constexpr int kPoints = 6000;
  for (int i = 0; i < kPoints; ++i) {
    const float y = 1 - (2 * float(i) + 1) / kPoints, r = std::sqrt(1 - y * y);
    const float angle = 2 * std::numbers::pi_v<float> * float(i) / std::numbers::phi_v<float>;
    const glm::vec3 p(r * std::cos(angle), y, r * std::sin(angle));
    ball.positions.push_back(p);
    ball.colors.push_back({0.5f + 0.4f * y, 0.5f + 0.3f * std::sin(6 * p.x), 0.3f, 1});
    ball.indices.push_back(std::uint32_t(i));
  }
  Mesh cage;
  cage.primitive = Primitive::lines;
  for (int k = 0; k < 8; ++k)
    cage.positions.push_back(1.2f * glm::vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  cage.colors.assign(8, glm::vec4(0.9f, 0.1f, 0.1f, 1));
  for (std::uint32_t k = 0; k < 8; ++k)
    for (const std::uint32_t bit : {1u, 2u, 4u})
      if (!(k & bit)) cage.indices.insert(cage.indices.end(), {k, k | bit});
  // Nodes are placed by what they see of surfaces: without any there is nothing to choose by.
  Mesh floor;
  floor.positions = {{-1, -1.3f, -1}, {-1, -1.3f, 1}, {1, -1.3f, 1}, {1, -1.3f, -1}};
  floor.normals.assign(4, glm::vec3(0, 1, 0));
  floor.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes = {ball, cage, floor};
  scene.models.emplace_back().parts = {Part{0}, Part{1}, Part{2}};
  scene.objects.emplace_back().name = "ball";
  finish(scene);
  return scene;
}

TEST(StrokesMethods, all_show_points_and_lines) {
  const Scene scene = ball_in_a_cage();
  Scene empty = scene;  // what a method shows is far nearer to the truth than nothing is
  empty.objects.clear();
  const auto eye = [](double angle) {
    return look_at({5 * std::sin(angle), 1.5, 5 * std::cos(angle)}, {0, 0, 0}, {0, 1, 0}, 0.8, 160,
                   120, 0.1, 50);
  };
  SoftwareBackend backend(scene, 4), of_nothing(empty, 4);
  Result<Method> direct = make_method("direct", {}, backend),
                 nothing = make_method("direct", {}, of_nothing);
  ASSERT_TRUE(direct.ok() && nothing.ok());
  MethodOptions options;
  options.texel_px = 100;  // baked objects are drawn, however coarse
  options.eyes = Box{glm::vec3(0.2f, 1.2f, 4.6f), glm::vec3(1.2f, 1.8f, 5.2f)};
  for (const std::string& name : method_names()) {
    SCOPED_TRACE(name);
    // Kinds by their own names, and small: a bake takes no longer than a frame of the others.
    MethodOptions of_method = options;
    if (const KindMethod baked = kind_method(name); baked.kind) {
      if (baked.variant) continue;
      for (const auto& [option, value] :
           {std::pair{"views", "12"}, {"size", "96"}, {"textures", "6"}, {"face", "96"}})
        if (find_option(options_of(*baked.kind, KindOptionsOf::bake), option))
          of_method.kinds.bake[option] = value;
    }
    SoftwareBackend by(scene, 4);
    Result<Method> method = make_method(name, of_method, by);
    ASSERT_TRUE(method.ok()) << method.error().message();
    double least = INFINITY;
    for (const double angle : {0.1, 0.14, 0.2}) {
      const Camera camera = eye(angle);
      ASSERT_TRUE(direct->frames->draw(camera, 0).ok());
      ASSERT_TRUE(nothing->frames->draw(camera, 0).ok());
      const Result<> drawn = method->frames->draw(camera, 0);
      ASSERT_TRUE(drawn.ok()) << drawn.error().message();
      const Rgba8Image& truth = direct->frames->software_target()->color();
      const double alike = psnr_db(method->frames->software_target()->color(), truth);
      least = std::min(least, alike);
      EXPECT_GT(alike, psnr_db(nothing->frames->software_target()->color(), truth) + 3) << angle;
    }
    // Flat impostors slide by pixels; baked kinds have textures of their own size.
    if (name == "direct-raster" || name == "lod") {
      EXPECT_EQ(least, INFINITY);
    }
    if (name == "direct-rays") {
      EXPECT_GT(least, 45);  // samples on edges
    }
    if (name == "nailboard" || name == "cache") {
      EXPECT_GT(least, 25);
    }
  }
}

}  // namespace
}  // namespace rilievo
