// How do pictures that OpenGL wrote get their first row on top?
#pragma once

#include <algorithm>

#include "rilievo/core/image.h"

namespace rilievo::gl {

// Reverses the order of the rows: OpenGL's start at the bottom.
template <class T>
void flip_rows(Image<T>& image) {
  for (int y = 0; y < image.height() / 2; ++y)
    std::swap_ranges(image.row(y).begin(), image.row(y).end(),
                     image.row(image.height() - 1 - y).begin());
}

}  // namespace rilievo::gl
