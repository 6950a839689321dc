// For tests of baked nodes: baked of a scene by any source, drawn without OpenGL.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/environment_nodes/bake_nodes.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/method/test_source_test_helpers.h"

namespace rilievo::test_baked_nodes {

// Two nodes beside each other, at a person's height in the middle of the scene.
inline std::vector<glm::dvec3> places(CaptureSource& source) {
  const Box bounds = source.bounds({});
  const glm::dvec3 middle(bounds.center());
  return {{middle.x - 0.4, bounds.min.y + 1.6, middle.z},
          {middle.x + 0.4, bounds.min.y + 1.6, middle.z}};
}

inline EnvironmentNodes bake(CaptureSource& source) {
  NodeBakeOptions options;
  options.at = places(source);
  options.face = 96;
  Result<NodeBake> baked = bake_nodes(source, options);
  EXPECT_TRUE(baked.ok()) << baked.error().message();
  return baked.ok() ? std::move(baked->nodes) : EnvironmentNodes{};
}

// A camera at `eye` that looks around in some steps.
inline Camera camera_at(const glm::dvec3& eye, int step) {
  const double angle = 0.3 + 1.3 * step;
  return look_at(eye, eye + glm::dvec3(std::cos(angle), 0.1, std::sin(angle)), {0, 1, 0}, 0.8, 128,
                 96, 0.05, 2000);
}

// The frames of cameras, drawn into memory.
inline std::vector<Rgba8Image> draw(const EnvironmentNodes& nodes, const Scene& sky,
                                    const std::vector<Camera>& cameras) {
  auto factory = make_environment_tiles_factory();
  EXPECT_TRUE(factory.ok());
  auto drawable = (*factory)->make_drawable(std::make_unique<EnvironmentRepresentation>(nodes),
                                            OptionValues(environment_nodes_kind().draw_options));
  EXPECT_TRUE(drawable.ok());
  TestSource frames = software_stored(sky, 4, std::move(*drawable), {Instance{}}, false);
  std::vector<Rgba8Image> drawn;
  for (const Camera& camera : cameras) {
    EXPECT_TRUE(frames.draw(camera, 0).ok());
    drawn.push_back(frames.software_target()->color());
  }
  return drawn;
}

// Do two bakes of one scene show the same? Their silhouettes may differ by a texel.
inline void expect_alike(const EnvironmentNodes& a, const EnvironmentNodes& b, const Scene& scene,
                         const std::vector<Camera>& cameras) {
  const std::vector<Rgba8Image> first = draw(a, scene, cameras), second = draw(b, scene, cameras);
  std::size_t pixels = 0, alike = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t k = 0; k < first[i].texels().size(); ++k) {
      const glm::ivec4 difference =
          glm::abs(glm::ivec4(first[i].texels()[k]) - glm::ivec4(second[i].texels()[k]));
      ++pixels;
      alike += std::max({difference.r, difference.g, difference.b}) <= 4;
    }
  testing::Test::RecordProperty("alike", std::to_string(double(alike) / double(pixels)));
  EXPECT_GT(double(alike), 0.97 * double(pixels));
}

}  // namespace rilievo::test_baked_nodes
