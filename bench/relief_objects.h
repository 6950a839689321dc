// The objects that benches of layered reliefs share: those of [Parilov, Stuerzlinger 2002].
#pragma once

#include <memory>
#include <optional>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/scene/scene.h"

namespace rilievo::bench {

struct ReliefObject {
  const char* name;
  std::unique_ptr<Scene> scene;  // where `rays` looks for it
  std::optional<RayScene> rays;
};

// fern, fish, cube.
[[nodiscard]] Result<ReliefObject> relief_object(const char* name);

// How reliefs of it are framed so that they have 140 000 to 250 000 samples at 512 x 512, as the
// paper's: ReliefBakeOptions::ball. A cube would fill a frame that fits it, with 524 288.
[[nodiscard]] double paper_ball(const ReliefObject& object);

// Parallel, size x size, from `direction` (towards the viewer), framed as the paper's; surfaces
// within a hundredth of a texel of each other merged.
[[nodiscard]] Result<LayeredDepthImage> relief_layers(const ReliefObject& object, int size,
                                                      const glm::dvec3& direction);

}  // namespace rilievo::bench
