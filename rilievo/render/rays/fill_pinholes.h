// How are pinholes of a coarse picture filled?
//
// A ray that passes between two leaves hits what is behind them, and the whole texel shows that. A
// coarse picture's texel is as large as several pixels of the frame, but most of the gaps that rays
// pass through are narrower than one. Internal to render/rays.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/render/shading/sample_buffer.h"

namespace rilievo {

// Fills pinholes. Keeps its buffers.
class PinholeFiller {
 public:
  // A pinhole is a texel inside the picture's border. At most one of its eight neighbours shows the
  // same object as it does (or nothing, as it does); all others show one object in front of it. It
  // gets the triangle and the depth of the first of them: left, right, below, above. Requires one
  // sample per texel, and meshes in the order of their triangles.
  void fill(std::span<const PlacedMesh> meshes, SampleBuffer& samples);

 private:
  struct Filled {
    std::size_t to, from;  // samples
  };
  ObjectPicture objects_;
  std::vector<std::vector<Filled>> rows_;
};

}  // namespace rilievo
