#include <rilievo/frame/gl/opengl_backend.h>
#include <rilievo/gl/context.h>
#include <rilievo/io/png.h>
#include <rilievo/method/method.h>
#include <rilievo/render/opengl/frame_target.h>
#include <rilievo/scene/builtin/builtin.h>

#include <cstdio>

using namespace rilievo;

// Walks through a scene whose heavy objects are drawn from pictures with depth.
Result<> walk(const char* spec, const char* file) {
  auto context = gl::Context::create();  // or make your own window's context current
  if (!context) return context.error();
  auto made = make_builtin(spec);  // or load_scene("house.glb")
  if (!made) return made.error();
  auto backend = OpenGLBackend::create(made->scene, 4);
  if (!backend) return backend.error();
  auto method = make_method("nailboard", {}, **backend);
  if (!method) return method.error();
  auto target = FrameTarget::create(640, 360, 4);
  if (!target) return target.error();
  for (int frame = 0; frame < 10; ++frame) {
    const double time = frame_time(made->path, frame);
    target->begin();
    if (auto drawn = method->frames->draw(camera_at(made->path, time, 640, 360), time); !drawn)
      return drawn.error();
    target->resolve();
    const FrameStats& done = method->frames->stats();
    std::printf("frame %d: %d objects as polygons, %d as pictures, %d of them new\n", frame,
                done.polygons, done.count("nailboard"), done.captures);
  }
  return save_png(file, target->read());
}

int main() {
  const auto done = walk("builtin:teapots?triangles=100000", "teapots.png");
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 1;
}
