#include "rilievo/relief_impostor/impostor_motion.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {

void set_deformation(const Scene& scene, std::span<const DeformationBounds> bounds, double placed,
                     ImpostorObject& object) {
  RILIEVO_EXPECTS(bounds.size() == scene.models.size());
  std::vector<glm::mat4> poses;
  pose(scene, placed, poses);
  const auto add = [&](std::uint32_t index) {
    const DeformationBounds& of = bounds[std::size_t(scene.objects[index].model)];
    const double scale = stretch_at_most(poses[index]);
    object.deforms = std::max(object.deforms, scale * of.speed);
    object.jump = std::max(object.jump, scale * of.jump);
    if (of.speed > 0) object.period = of.period;
  };
  for (const std::uint32_t index : object.objects) add(index);
  if (object.objects.empty())
    for (std::uint32_t index = 0; index < scene.objects.size(); ++index) add(index);
}

}  // namespace rilievo
