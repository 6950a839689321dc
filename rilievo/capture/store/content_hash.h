// Is this the same content as last time? A hash of 128 bits.
//
// For finding pictures again and for seeing damage; not against somebody who wants a collision. The
// same on all little-endian machines. Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "rilievo/core/random.h"

namespace rilievo {

struct Scene;

// Hashes bytes, piece by piece; the borders of the pieces matter.
class ContentHash {
 public:
  void add(std::span<const std::byte> bytes);
  void add(std::string_view text) { add(std::as_bytes(std::span(text.data(), text.size()))); }
  void add(std::uint64_t word) {
    a_ = scramble(a_ ^ word);
    b_ = scramble(b_ + word + 0x9e3779b97f4a7c15ull);
  }
  // 32 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  std::uint64_t a_ = 0x243f6a8885a308d3ull, b_ = 0x13198a2e03707344ull;
};

// The hash of all that a picture of the scene can show at `time` (seconds): meshes, materials,
// textures, where objects are, lights, sky. Names do not count.
[[nodiscard]] std::string content_hash(const Scene& scene, double time = 0.0);

}  // namespace rilievo
