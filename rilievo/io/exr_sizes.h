// Do the sizes that an OpenEXR header states fit into its file? Internal.
//
// OpenEXR allocates an attribute's stated size before it reads it, so that four wrong bytes cost
// two gigabytes. This check steps through the header: magic and version (4 bytes each), then for
// each part its attributes (name 0, type 0, int32 size, value) up to an empty name. A multi-part
// file ends with an empty part. OpenEXR reads some types without a look at the stated size; these
// must state the size of their type; otherwise OpenEXR and this check parse what follows
// differently.
#pragma once

#include <string_view>

#include "rilievo/core/result.h"

namespace rilievo {

// Fails if an attribute's size exceeds the rest of `file`, or is not that of its type.
[[nodiscard]] Result<> check_exr_sizes(std::string_view file);

}  // namespace rilievo
