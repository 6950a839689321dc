// Which channels of a foreign OpenEXR part are the picture, whatever its layers are called?
// Internal to io.
//
// R G B (A) and Z without a layer come first. Else colours are those of a layer "Combined"
// (Blender: ViewLayer.Combined.R), or of the only layer that has R, G and B; depth is "Depth.Z"
// beside it (ViewLayer.Depth.Z), or the only depth there is.
#pragma once

#include <ImfChannelList.h>

#include <array>
#include <string>

#include "rilievo/core/result.h"

namespace rilievo::exr {

// The channels of a picture.
struct PictureChannels {
  std::array<std::string, 4> color{"R", "G", "B", "A"};  // the last need not exist
  std::string depth = "Z", object = "id";
};

// Finds them; the error says what is missing and what there is.
[[nodiscard]] Result<PictureChannels> picture_channels(const Imf::ChannelList& channels);

// "; it has A, B, Z": ends a message about a channel that is missing.
[[nodiscard]] std::string but_it_has(const Imf::ChannelList& channels);

}  // namespace rilievo::exr
