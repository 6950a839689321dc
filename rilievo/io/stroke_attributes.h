// How large the points and lines are that a file's pictures show (core/stroke_size.h), as an
// attribute of the file (io/exr.h).
//
//   rilievo.file.strokes   "RADIUS TEXELS": of discs, metres, and of what is so many texels wide;
//                          absent where there are neither points nor lines
#pragma once

#include "rilievo/core/stroke_size.h"
#include "rilievo/io/exr.h"

namespace rilievo {

void store_strokes(const StrokeSize& strokes, Attributes& file);
// None where the file says nothing. The error has no file's name.
[[nodiscard]] Result<StrokeSize> strokes_from(const Attributes& file);

}  // namespace rilievo
