// Draws frames into memory without OpenGL, from pictures with depth that are captured while the
// camera moves, and saves the last one:   rilievo_software_frame FRAME.png [builtin:NAME] [FRAMES]
#include <rilievo/frame/software/software_backend.h>
#include <rilievo/io/png.h>
#include <rilievo/method/method.h>
#include <rilievo/scene/builtin/builtin.h>

#include <cstdio>
#include <cstdlib>

using namespace rilievo;

Result<> walk(const char* file, const char* spec, int frames) {
  const auto made = make_builtin(spec);  // or load_scene("house.glb")
  if (!made) return made.error();
  const auto backend = SoftwareBackend::create(made->scene, 4);  // samples a pixel
  if (!backend) return backend.error();
  const auto cache = make_method("cache", {.error_px = 1}, **backend);
  if (!cache) return cache.error();
  const auto target = (*backend)->make_target(1280, 720);
  if (!target) return target.error();
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame_time(made->path, frame);
    const Camera camera = camera_at(made->path, time, 1280, 720);
    if (auto drawn = (*target)->draw(*cache->frames, camera, time); !drawn) return drawn;
  }
  const FrameStats& stats = cache->frames->stats();
  std::printf("the last frame: %d pictures, %d objects as polygons\n",
              stats.groups + stats.count("nailboard"), stats.polygons);
  return save_png(file, (*target)->color());  // or save_pictures(): linear light, with depths
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s FRAME.png [SCENE] [FRAMES]\n", argv[0]), 2;
  const auto done =
      walk(argv[1], argc > 2 ? argv[2] : "builtin:forest", argc > 3 ? std::atoi(argv[3]) : 24);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 2;
}
