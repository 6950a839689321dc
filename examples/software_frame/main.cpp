// Draws a frame without OpenGL: each object is captured once, as a picture with depth, and the
// pictures are drawn from where the camera is a quarter of a second later.
//
//   rilievo_software_frame FRAME.png [builtin:NAME]
#include <algorithm>
#include <cmath>
#include <iostream>
#include <list>

#include "rilievo/io/png.h"
#include "rilievo/nailboard/cpu/nailboard_composer.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

int main(int argc, char** argv) {
  using namespace rilievo;
  if (argc < 2) return std::cerr << "usage: " << argv[0] << " FRAME.png [builtin:NAME]\n", 2;
  const Result<BuiltinScene> made = make_builtin(argc > 2 ? argv[2] : "builtin:teapots");
  if (!made) return std::cerr << made.error().message() << "\n", 2;
  const Scene& scene = made->scene;
  const Camera before = camera_at(made->path, 0, 1280, 720);
  const Camera now = camera_at(made->path, 0.25, 1280, 720);

  PictureRasterizer rasterizer(scene);
  std::vector<glm::mat4> poses;
  pose(scene, 0, poses);
  std::list<MemoryNailboard> pictures;  // they stay where they are
  std::vector<MemoryNailboardInstance> instances;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const Box box = transformed(poses[i], scene.models[std::size_t(scene.objects[i].model)].bounds);
    Result<Camera> capture =
        tight_camera(Projection::perspective, before.position(), {0, 1, 0}, box);
    if (!capture || capture->z_near < now.z_near) continue;  // the eye is beside it, or within
    const auto texels = [&](double extent) {
      return std::clamp(int(std::ceil(extent / texel_angle(before))), 8, 2048);
    };
    capture->width = texels(capture->window.right - capture->window.left);
    capture->height = texels(capture->window.top - capture->window.bottom);
    RasterPicture picture;
    AtlasPicture encoded;
    rasterizer.draw(*capture, {&i, 1}, poses, 4, picture);
    encode_picture(picture, 16, encoded);
    pictures.emplace_back().assign(picture.width, picture.height, picture.color, encoded, 16);
    instances.push_back({&pictures.back(), picture_geometry(*capture), glm::dmat4(1), i + 1});
  }

  NailboardComposer composer;
  composer.place(now, DepthMode::exact, instances);
  SoftwareTarget target(now.width, now.height, 4);
  const TileDrawer* drawers[] = {&composer};
  target.draw(now.z_far, drawers, {160, 190, 225, 255});
  if (Result<> saved = save_png(argv[1], target.color()); !saved)
    return std::cerr << saved.error().message() << "\n", 2;
  std::cout << pictures.size() << " of " << scene.objects.size() << " objects\n";
}
