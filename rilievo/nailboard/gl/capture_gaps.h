// How wide is the strip that a picture is missing because it was hidden at capture?
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/capture/gl/capture_by.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// The gap table of the picture of `objects` that `capturer` has just made (null: OpenGL has).
// Changes the bound framebuffer and viewport.
[[nodiscard]] GapTable capture_gaps(SceneRenderer& renderer, CaptureWithoutOpenGL* capturer,
                                    const Camera& camera, std::span<const std::uint32_t> objects);

}  // namespace rilievo
