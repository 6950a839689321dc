// Random numbers for benchmarks, of which the same seed makes the same everywhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace rilievo::bench {

// The same numbers with every compiler and library, if no expression asks for two of them: operands
// and arguments have no order. Not named as rilievo/core/random.h's, which other benchmarks use.
struct SplitMix64 {
  std::uint64_t state;
  double next() {  // [0, 1)
    std::uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * next(); }
  double power(double low, double high) { return low * std::pow(high / low, next()); }
  int below(int count) { return int(next() * count); }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 p{between(-1, 1), between(-1, 1), between(-1, 1)};  // in this order
      const double length = glm::length(p);
      if (length > 1e-3 && length <= 1) return p / length;
    }
  }
  // A vector of this length in any direction.
  glm::dvec3 vector(double length) { return length * direction(); }
};

}  // namespace rilievo::bench
