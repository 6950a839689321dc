#include "rilievo/environment_nodes/capture_environment.h"

#include <string>

#include "rilievo/render/rays/cast_picture.h"

namespace rilievo {
Result<EnvironmentMap> capture_environment(const RayScene& scene, const glm::dvec3& eye,
                                           const EnvironmentOptions& options) {
  if (options.size < 2 || options.size > 4096)
    return Error{"node",
                 "faces must be 2 to 4096 texels wide, not " + std::to_string(options.size)};
  EnvironmentMap map;
  map.name = scene.scene().name;
  const std::array<Camera, 6> cameras =
      environment_cameras(eye, options.size, options.z_near, options.z_far);
  for (std::size_t f = 0; f < 6; ++f) {
    if (Result<> valid = validate(cameras[f]); !valid) return valid.error();
    DepthImage& face = map.faces[f];
    face = cast_picture(scene, cameras[f], {.sky = options.sky});
    face.name = "face" + std::to_string(f);
  }
  return map;
}

}  // namespace rilievo
