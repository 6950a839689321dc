// Does each pixel show the right object, at the right depth?
//
// Compares a frame with the true frame of the same size, both as images of object identifiers (0 =
// no object: the sky) and of eye_z. Pixels within `margin` pixels, 1 unless said otherwise, of an
// object boundary in the true frame are not counted, that is those whose neighbourhood of 2 margin
// + 1 pixels a side shows more than one identifier there. The other pixels are `counted`.
#pragma once

#include <cstdint>

#include "rilievo/core/image.h"
#include "rilievo/measure/stats.h"

namespace rilievo {

// An object identifier at each pixel; 0 is no object.
using IdImage = Image<std::uint32_t>;

// Numbers of pixels, over one frame or several.
struct Visibility {
  std::uint64_t counted = 0;          // pixels away from boundaries
  std::uint64_t wrong = 0;            // counted pixels whose identifiers differ
  std::uint64_t counted_objects = 0;  // counted pixels that show an object in the true frame
  std::uint64_t uncovered = 0;        // those that show no object in the other frame

  // The shares wrong / counted and uncovered / counted_objects; 0 if nothing is counted.
  [[nodiscard]] double wrong_share() const { return share(wrong, counted); }
  [[nodiscard]] double uncovered_share() const { return share(uncovered, counted_objects); }

 private:
  static double share(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : double(part) / double(whole);
  }
};

// Compares one frame's identifiers with the true frame's.
[[nodiscard]] Visibility compare_visibility(const IdImage& true_ids, const IdImage& ids,
                                            int margin = 1);

// Counts the objects that show `min_counted` or more counted pixels in the true frame and none at
// all in the other frame. What is less than `margin` from the image's border counts for nothing.
// Requires images of one size.
[[nodiscard]] int count_missing_objects(const IdImage& true_ids, const IdImage& ids, int margin = 3,
                                        int min_counted = 16);

// Adds the relative depth error |eye_z - true eye_z| / true eye_z of every counted pixel at which
// both frames show the same object and both depths are positive and finite.
void add_depth_errors(const IdImage& true_ids, const IdImage& ids, const Image<float>& true_eye_z,
                      const Image<float>& eye_z, Histogram& errors);

}  // namespace rilievo
