#include "rilievo/environment_nodes/capture_environment.h"

#include <cmath>
#include <string>

#include "rilievo/render/rays/cast_picture.h"

namespace rilievo {
namespace {

// As capture/scene_shaders.h draws it: a smooth blend over elevation.
glm::vec3 sky_radiance(const Sky& sky, float elevation) {
  const glm::vec3 above =
      glm::mix(sky.horizon, sky.zenith, std::sqrt(glm::clamp(elevation, 0.0f, 1.0f)));
  return glm::mix(sky.ground, above, glm::smoothstep(-0.08f, 0.0f, elevation));
}

}  // namespace

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
    face = cast_picture(scene, cameras[f]);
    face.name = "face" + std::to_string(f);
    if (!options.sky) continue;
    for (int y = 0; y < options.size; ++y)
      for (int x = 0; x < options.size; ++x) {
        if (face.covered(x, y)) continue;
        const glm::dvec3 to = world_from_raster(cameras[f], {x + 0.5, y + 0.5}, 1.0) - eye;
        face.color(x, y) =
            glm::vec4(sky_radiance(scene.scene().sky, float(glm::normalize(to).y)), 1.0f);
      }
  }
  return map;
}

}  // namespace rilievo
