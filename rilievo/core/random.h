// Which random numbers are the same on every machine? And noise made from them.
//
// Independent of the standard library's distributions. Pure; any thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace rilievo {

// A bijection of 64 bits in which each input bit changes about half of the output bits (the
// finaliser of SplitMix64, [Steele, Lea, Flood 2014]).
[[nodiscard]] constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// A key that depends on several numbers and on their order.
template <class... Rest>
[[nodiscard]] constexpr std::uint64_t combine(std::uint64_t first, Rest... rest) {
  std::uint64_t key = scramble(first + 0x9e3779b97f4a7c15ull);
  ((key = scramble(key ^ (std::uint64_t(rest) + 0x9e3779b97f4a7c15ull))), ...);
  return key;
}

// A number in [0, 1) from the upper 24 bits, which a float holds exactly.
[[nodiscard]] constexpr float unit_float(std::uint64_t bits) {
  return float(bits >> 40) * (1.0f / 16777216.0f);
}

// A sequence of random numbers; the seed determines it.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() { return scramble(state_ += 0x9e3779b97f4a7c15ull); }
  float unit() { return unit_float(next()); }                                        // [0, 1)
  float between(float low, float high) { return low + (high - low) * unit(); }       // [low, high)
  int below(int count) { return int((next() >> 32) * std::uint64_t(count) >> 32); }  // [0, count)

 private:
  std::uint64_t state_;
};

// Smooth noise in [-1, 1] with features of size 1: random values at integer points, interpolated.
[[nodiscard]] inline float noise(const glm::vec3& p, std::uint64_t seed) {
  const glm::vec3 cell = glm::floor(p), f = p - cell, w = f * f * (3.0f - 2.0f * f);
  const auto corner = [&](int x, int y, int z) {
    return 2.0f * unit_float(combine(seed, std::int64_t(cell.x) + x, std::int64_t(cell.y) + y,
                                     std::int64_t(cell.z) + z)) -
           1.0f;
  };
  const auto edge = [&](int y, int z) { return glm::mix(corner(0, y, z), corner(1, y, z), w.x); };
  return glm::mix(glm::mix(edge(0, 0), edge(1, 0), w.y), glm::mix(edge(0, 1), edge(1, 1), w.y),
                  w.z);
}

}  // namespace rilievo
