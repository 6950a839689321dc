// Any bytes, taken for each kind of scene they could be: a valid scene or an Error with a reason,
// within the bound on memory. tools/fuzz runs it.
#include <cstdlib>
#include <cstring>

#include "rilievo/scene/files/load_scene.h"

namespace {

void load(const std::uint8_t* data, std::size_t size, const char* name) {
  rilievo::LoadOptions options;
  options.time = 0.3;
  options.max_bytes = 256u << 20;
  options.deformations = true;
  const auto loaded = rilievo::load_scene({data, size}, name, options);
  if (loaded && !rilievo::validate(loaded->scene)) std::abort();
  // What bends by time, at another time.
  if (loaded && !loaded->deformations.meshes.empty()) {
    (void)rilievo::deformation_bounds(loaded->scene, loaded->deformations);
    (void)rilievo::pose_at(loaded->scene, loaded->deformations, 0.7);
  }
  if (!loaded && (loaded.error().reason.empty() || loaded.error().reason.ends_with(": ")))
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  load(data, size, "fuzz");
  // OBJ has no first bytes of its own, and STL none that are sure.
  const bool known = size > 0 && (data[0] == '{' || data[0] == 'g' || data[0] == 'p');
  if (known) return 0;
  load(data, size, "fuzz.obj");
  if (size >= 6 && std::memcmp(data, "solid ", 6) != 0) load(data, size, "fuzz.stl");
  return 0;
}
