// Uses rilievo::core as an engine without OpenGL would: a picture with depth, made by hand.
#include <cstdio>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"

int main() {
  rilievo::DepthImage picture;
  picture.name = "wall";
  picture.camera = rilievo::look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.8, 32, 24, 0.1, 10.0);
  picture.color = rilievo::ColorImage(32, 24, {0.5f, 0.4f, 0.3f, 1.0f});
  picture.depth = rilievo::Image<float>(32, 24, 3.0f);
  if (const auto valid = rilievo::validate(picture); !valid) {
    std::fprintf(stderr, "%s\n", valid.error().message().c_str());
    return 1;
  }
  const glm::dvec3 center = rilievo::raster_from_world(picture.camera, {0, 0, 0});
  std::printf("The origin is seen at %.1f %.1f, %.1f m away\n", center.x, center.y, center.z);
  return center == glm::dvec3(16, 12, 3) ? 0 : 1;
}
