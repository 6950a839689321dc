// How much may a picture lack of what was hidden when it was captured?
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/capture/gl/capture_by.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Of the picture of `objects` that `capturer` has just made; null: that OpenGL has made. Changes
// the bound framebuffer and viewport.
[[nodiscard]] GapTable capture_gaps(SceneRenderer& renderer, CaptureWithoutOpenGL* capturer,
                                    const Camera& camera, std::span<const std::uint32_t> objects);

}  // namespace rilievo
