// Does each pixel show the right object, at the right depth?
//
// Compared are images of object identifiers (0 = no object: the sky) and of eye_z, of a true frame
// and of another one of the same size. Pixels within 1 pixel of an object boundary in the true
// frame are not counted: those whose 3 x 3 neighbourhood (as far as it lies in the image) shows
// more than one identifier there. What is left is `counted`.
#pragma once

#include <cstdint>

#include "rilievo/core/image.h"
#include "rilievo/measure/stats.h"

namespace rilievo {

using IdImage = Image<std::uint32_t>;

struct Visibility {
  std::uint64_t counted = 0;          // pixels away from boundaries
  std::uint64_t wrong = 0;            // counted, and the identifiers differ
  std::uint64_t counted_objects = 0;  // counted, and the true frame shows an object
  std::uint64_t uncovered = 0;        // of these, the other frame shows none

  // wrong / counted and uncovered / counted_objects; 0 where nothing is counted.
  [[nodiscard]] double wrong_share() const { return share(wrong, counted); }
  [[nodiscard]] double uncovered_share() const { return share(uncovered, counted_objects); }

 private:
  static double share(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : double(part) / double(whole);
  }
};

[[nodiscard]] Visibility compare_visibility(const IdImage& true_ids, const IdImage& ids);

// Adds |eye_z - true eye_z| / true eye_z of every counted pixel where both frames show the same
// object and both depths are positive and finite.
void add_depth_errors(const IdImage& true_ids, const IdImage& ids, const Image<float>& true_eye_z,
                      const Image<float>& eye_z, Histogram& errors);

}  // namespace rilievo
