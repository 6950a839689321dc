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

// Parallel, size x size, from `direction` (towards the viewer), the window `margin` times as wide
// as the object; surfaces within a hundredth of a texel of each other merged.
[[nodiscard]] Result<LayeredDepthImage> relief_layers(const ReliefObject& object, int size,
                                                      const glm::dvec3& direction, double margin);

}  // namespace rilievo::bench
