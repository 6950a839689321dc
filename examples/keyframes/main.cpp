// Draws frames while a ray tracer, which takes long, makes pictures of the whole view beside them,
// and saves the last one:   rilievo_keyframes FRAME.png [builtin:NAME] [FRAMES] [SOURCE]
#include <rilievo/frame/software/software_backend.h>
#include <rilievo/io/png.h>
#include <rilievo/method/method.h>
#include <rilievo/scene/builtin/builtin.h>

#include <cstdio>
#include <cstdlib>

using namespace rilievo;

Result<> walk(const char* file, const char* spec, int frames, const char* source) {
  const auto made = make_builtin(spec);  // or load_scene("house.glb")
  if (!made) return made.error();
  const auto backend = SoftwareBackend::create(made->scene, 4);  // samples a pixel
  if (!backend) return backend.error();
  MethodOptions options;
  options.source = source;  // or exec:PROGRAM
  const auto keyframes = make_method("keyframes", options, **backend);
  if (!keyframes) return keyframes.error();
  const auto target = (*backend)->make_target(640, 360);
  if (!target) return target.error();
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame_time(made->path, frame);
    const Camera camera = camera_at(made->path, time, 640, 360);
    if (auto drawn = (*target)->draw(*keyframes->frames, camera, time); !drawn) return drawn;
  }
  const FrameStats& stats = keyframes->frames->stats();
  std::printf("the last frame: from %d keyframes, %d of them coarse; %.1f %% filled by rays\n",
              stats.count("keyframe"), stats.late, 100 * stats.filled_share);
  return save_png(file, (*target)->color());
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s FRAME.png [SCENE]...\n", argv[0]), 2;
  const auto done = walk(argv[1], argc > 2 ? argv[2] : "builtin:stonehenge",
                         argc > 3 ? std::atoi(argv[3]) : 48, argc > 4 ? argv[4] : "raytrace");
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 2;
}
