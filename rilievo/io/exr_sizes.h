// Do the sizes that an OpenEXR header states fit into its file?
//
// OpenEXR allocates an attribute as large as it says before it reads it, so that four wrong bytes
// cost two gigabytes. Walks the header's bytes: magic and version (4 bytes each), then per part
// attributes (name 0, type 0, int32 size, value) up to an empty name; a multi-part file ends with
// an empty part. Values are not looked at.
#pragma once

#include <string_view>

#include "rilievo/core/result.h"

namespace rilievo {

[[nodiscard]] Result<> check_exr_sizes(std::string_view file);

}  // namespace rilievo
