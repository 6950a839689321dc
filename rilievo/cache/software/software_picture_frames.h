// How are flat impostors and nailboards drawn without OpenGL that are used in the plain way (S1.5)?
//
// cache/picture_chooser.h says which pictures are captured when; the rasteriser captures.
#pragma once

#include <memory>

#include "rilievo/cache/picture_chooser.h"
#include "rilievo/frame/software/software_chosen_frames.h"

namespace rilievo {

// A frame source with one picture for each heavy object, in memory. `scene` must be valid and
// outlive it. Fails as SoftwareCache::create() does.
[[nodiscard]] Result<std::unique_ptr<SoftwareChosenFrames>> make_software_picture_frames(
    const Scene& scene, const PictureFramesOptions& options);

}  // namespace rilievo
