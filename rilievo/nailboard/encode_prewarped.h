// A pre-warped picture as an atlas of nailboards keeps it: averaged if it is to be seen
// smaller, cut to pieces, with Deltas around its edges, and blocks.
//
// Texels of the result are samples, each there or not; averaged, alpha becomes coverage, so that
// what is far away is antialiased as captures are. Fills the caller's buffers; all cores. No OpenGL
// here.
#pragma once

#include <vector>

#include "rilievo/nailboard/encode_picture.h"
#include "rilievo/nailboard/prewarped.h"

namespace rilievo {

// Averages 2 x 2 texels `level` times: colours and coverage; of Deltas the nearest. The window
// grows to whole texels. `scratch` is for the steps between.
void halve_prewarped(const Prewarped& picture, int level, Prewarped& halved, Prewarped& scratch);
// The same of identifiers in the place of colours: of the nearest texel.
void halve_identifiers(const Prewarped& picture, int level, Prewarped& halved, Prewarped& scratch);

// A rectangle of a picture.
struct PicturePiece {
  int x = 0, y = 0, width = 0, height = 0;  // from the upper left
};
// At most `most` texels a side each, together all of it.
[[nodiscard]] std::vector<PicturePiece> pieces_of(int width, int height, int most);
// The geometry of a piece of a picture.
[[nodiscard]] PictureGeometry geometry_of(const PictureGeometry& whole, const PicturePiece& piece);

// The geometry of a picture that stands in the world; the motion is rigid, or scales evenly.
[[nodiscard]] PictureGeometry placed(PictureGeometry geometry,
                                     const glm::dmat4& world_from_capture);

// The codes of row `y` of a piece, from the top: an empty texel gets the nearest Delta beside it,
// in the piece or around it, or the code of emptiness. `codes` has the piece's width.
void codes_of_row(const Prewarped& picture, const PicturePiece& piece, int y, std::uint16_t* codes);

// A piece as an atlas takes it.
struct EncodedPiece {
  std::vector<glm::u8vec4> color;  // rows from the bottom
  AtlasPicture picture;            // codes16 and blocks
};
void encode_prewarped(const Prewarped& picture, const PicturePiece& piece, EncodedPiece& encoded);

}  // namespace rilievo
