#include "rilievo/render/shading/sample_buffer.h"

#include <algorithm>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr std::size_t kLongestVector = 16;

}  // namespace

glm::vec2 sample_position(int sample, int samples) {
  if (samples == 1) return {0.5f, 0.5f};
  constexpr glm::vec2 kFour[] = {
      {0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}};
  return kFour[sample];
}

std::size_t SampleBuffer::bytes(int size, int samples) {
  return std::size_t(size) * std::size_t(size) * std::size_t(samples) *
         (sizeof(float) + sizeof(std::uint32_t));
}

void SampleBuffer::begin(int new_width, int new_height, int new_samples, bool new_staggered) {
  RILIEVO_EXPECTS(0 < new_width && 0 < new_height);
  RILIEVO_EXPECTS(new_samples == 1 || (new_samples == 4 && !new_staggered));
  width = new_width, height = new_height, samples = new_samples;
  staggered = new_staggered;
  // Rows are read and written in whole vectors.
  stride = (std::size_t(width) * std::size_t(samples) + kLongestVector - 1) / kLongestVector *
           kLongestVector;
  const std::size_t size = stride * std::size_t(height);
  depth.require(size), triangle.require(size);
  parallel_for(0, (height + 63) / 64, [&](int i) {
    const int end = std::min(height, 64 * (i + 1));
    std::fill(depth.data() + row(64 * i), depth.data() + row(end), 1.0f);
  });
}

}  // namespace rilievo
