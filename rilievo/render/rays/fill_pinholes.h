// Which texels of a coarse picture show something through a hole that the frame hardly has?
//
// A ray that passes between two leaves finds what is behind them. In a frame's own picture that is
// a pixel; in a picture of fewer texels it is as large as several, and most gaps that rays meet are
// narrower. Internal to render/rays.
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
  // A pinhole is a texel, not on the picture's border, of whose eight neighbours at most one shows
  // the same object, or nothing as it does, and all others show one object in front of it. It then
  // shows the triangle of one of them, at its depth: left, right, below or above, the first that
  // does. Requires one sample per texel, and meshes in the order of their triangles.
  void fill(std::span<const PlacedMesh> meshes, SampleBuffer& samples);

 private:
  struct Filled {
    std::size_t to, from;  // samples
  };
  ObjectPicture objects_;
  std::vector<std::vector<Filled>> rows_;
};

}  // namespace rilievo
