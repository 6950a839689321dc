// Draws a scene's frames without OpenGL: the cache captures pictures with depth while the camera
// moves, and draws the frames from them. Saves the last one.
//
//   rilievo_software_frame FRAME.png [builtin:NAME] [FRAMES]
#include <cstdlib>
#include <iostream>

#include "rilievo/cache/software/software_cache.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/io/png.h"
#include "rilievo/scene/builtin/builtin.h"

int main(int argc, char** argv) {
  using namespace rilievo;
  if (argc < 2)
    return std::cerr << "usage: " << argv[0] << " FRAME.png [builtin:NAME] [FRAMES]\n", 2;
  const Result<BuiltinScene> made = make_builtin(argc > 2 ? argv[2] : "builtin:forest");
  if (!made) return std::cerr << made.error().message() << "\n", 2;
  const int frames = argc > 3 ? std::atoi(argv[3]) : 24;

  Result<std::unique_ptr<SoftwareCache>> cache = SoftwareCache::create(made->scene, {});
  if (!cache) return std::cerr << cache.error().message() << "\n", 2;
  double last_ms = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame_time(made->path, frame);
    const Stopwatch watch;
    if (Result<> drawn = (*cache)->draw(camera_at(made->path, time, 1280, 720), time); !drawn)
      return std::cerr << drawn.error().message() << "\n", 2;
    last_ms = watch.ms();
  }
  const SoftwareTarget& target = *(*cache)->software_target();
  if (Result<> saved = save_png(argv[1], target.color()); !saved)
    return std::cerr << saved.error().message() << "\n", 2;
  const FrameStats& stats = (*cache)->stats();
  std::cout << "the last frame took " << last_ms
            << " ms: " << stats.groups + stats.count("nailboard") << " pictures, " << stats.polygons
            << " of " << made->scene.objects.size() << " objects as polygons\n";
}
