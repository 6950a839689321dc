// Environment nodes as files for browsers (web_walk/walk.h).
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// Writes all nodes, in two resolutions if their faces are larger than options.coarse_face, and
// their sketches, and adds them to `manifest`. Nodes are loaded one at a time on each thread.
[[nodiscard]] Result<> add_nodes(const EnvironmentNodes& nodes, WalkWriter& writer,
                                 WalkManifest& manifest, const WalkOptions& options);

// The same pictures with `factor` times fewer texels a side: a texel has the mean colour of those
// that it covers, and depth and identifier of the one nearest to its middle. Requires faces that
// `factor` divides.
[[nodiscard]] EnvironmentMap coarser(const EnvironmentMap& map, int factor);

// The faces' colours side by side, 3 x 2, each with its bottom row first, as cube maps of OpenGL
// have them. What shows nothing has the colours of what is nearest beside it, so that none of its
// own bleeds into edges.
[[nodiscard]] Rgba8Image face_sheet(const EnvironmentMap& map);

}  // namespace rilievo
