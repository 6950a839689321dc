// The shaders of keyframes/gl/keyframe_warper.h. Internal: not a stable interface.
#pragma once

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// At most so many keyframes are warped at once.
inline constexpr int kMostWarped = 3;

// Texture units, one for each keyframe; storage blocks; and the uniform block of what is known of
// keyframes.
inline constexpr int kColorUnit = 0, kDepthUnit = kMostWarped, kCoverUnit = 2 * kMostWarped;
inline constexpr int kDepthBlock = 0, kPixelBlock = 1, kSourceBlock = 0;

// Forward: one invocation for each texel of a keyframe.
inline constexpr int kSplatGroup = 64;  // texels of a row
[[nodiscard]] Result<gl::Program> make_splat_program();
// Backward: colours and depths of a frame whose first row is at the top.
[[nodiscard]] Result<gl::Program> make_lookup_program();
// Pixels that were filled: three vertices each.
[[nodiscard]] Result<gl::Program> make_fill_program();
// Shows a frame with its depth: colours, or identifiers.
[[nodiscard]] Result<gl::Program> make_show_program(bool objects);

}  // namespace rilievo::shader
