// Which objects are pictures of objects tried on?
//
// Six that need no file: round, angular, concave, thin, hollow and leafy ones.
#pragma once

#include <string>
#include <vector>

#include "rilievo/scene/scene.h"

namespace rilievo::bench {

struct BenchObject {
  std::string name;  // as figures have it
  std::string what;  // in a few words
  Scene scene;       // of that object alone, finished
};

// The teapot is the first. `triangles` each, to a few percent.
[[nodiscard]] std::vector<BenchObject> bench_objects(int triangles);

}  // namespace rilievo::bench
