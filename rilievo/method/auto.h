// `auto`: each frame by the cheapest method that is good enough.
//
//   direct      polygons, by the backend                                           exact
//   rays        polygons, found by rays: their time hardly depends on the scene    exact
//   cache       pictures of groups, within error_px                                a bound
//   lod         levels of detail, within error_px as they state it, or less        estimated
//   keyframes   whole frames from keyframes                                        measured
//
// Where it can be measured they lose at most loss_db, or as much as the cache, but at most
// twice loss_db (method/good_enough.h).
//
// method/auto_decision.h decides. A frame's time is measured by the clock, or counted
// (MethodOptions::by_clock); only direct drawing and the cache are counted, and then the same input
// gives the same frames.
//
// A scene that has few triangles for the frame's pixels is drawn directly, and nothing else is
// made. The cache and direct drawing are one chooser's. Where keyframes promise much the first
// frame makes the first one, and they draw from then on if it is certainly good enough. Everything
// else is prepared by parts of frames, or beside the frames, which do not wait for it, and not
// before it may pay. Where another method begins to draw the frames before fade out.
#pragma once

#include <string_view>

#include "rilievo/method/method.h"

namespace rilievo {

inline constexpr std::string_view kAutoName = "auto";

// Makes the frames. Deforming scenes are drawn directly.
[[nodiscard]] Result<Method> make_auto(const MethodOptions& options, Backend& backend);

}  // namespace rilievo
