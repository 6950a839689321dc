// A baked file in my own OpenGL window, among my own polygons:   rilievo_window FILE.exr [SHOT.ppm]
#include <rilievo/frame/gl/host_frames.h>
#include <rilievo/frame/gl/opengl_backend.h>
#include <rilievo/method/open_baked.h>

#include <cstdio>

#include "my_engine.h"  // opens the window, draws a triangle, saves what is on the screen

using namespace rilievo;

Result<> show(MyEngine& engine, const char* file) {
  const Scene nothing;
  auto backend = OpenGLBackend::create(nothing, engine.samples);
  if (!backend) return backend.error();
  auto baked = open_baked(file, **backend);
  if (!baked) return baked.error();
  auto host = HostFrames::create(*baked->frames, {engine.samples});
  if (!host) return host.error();
  while (engine.begin_frame(baked->bounds.center(), baked->bounds.radius())) {
    auto camera = camera_from(engine.view, engine.projection, engine.width, engine.height,
                              ClipRange::zero_to_one);
    if (!camera) return camera.error();
    engine.draw_triangle();  // before or after: they share the z-buffer, here a reversed one
    if (auto drawn = (*host)->draw(*camera, 0); !drawn) return drawn;
  }
  return Done{};
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s FILE.exr [SHOT.ppm]\n", argv[0]), 2;
  MyEngine engine(argc > 2 ? argv[2] : nullptr);
  const auto done = show(engine, argv[1]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 1;
}
