// Levels of detail for `auto`: prepared beside the frames, and looked at before anyone sees them.
#pragma once

#include <memory>
#include <optional>

#include "rilievo/method/audition.h"
#include "rilievo/method/levels.h"

namespace rilievo {

// Frames of levels, with what they are drawn from.
struct AutoLevels {
  LeveledBackend* levels = nullptr;  // of the frames, as the chooser
  LevelChooser* chooser = nullptr;
  std::unique_ptr<FrameSource> frames;  // null: of a backend that must make them on its own thread
  double share = 0;                     // of the error that is asked for
  std::optional<ObjectLevels> made;     // what the frames are made of, until there are frames
};

// Makes levels of the scene for frames of so many pixels, on any thread. Of a mesh that has more
// triangles than pictures can pay for none are finer than that: they would take most of the time.
// The levels' error, which simplification only estimates, is half of error_px until
// audition_levels() finds that more is good enough.
[[nodiscard]] AutoLevels prepare_levels(const Backend& backend, const Scene& scene, double pixels,
                                        double error_px);

// Makes the frames, if prepare_levels() did not. Fails where their backend cannot be made.
[[nodiscard]] Result<> finish_levels(const Backend& backend, double error_px, AutoLevels& levels);

// From the next frame on this error is asked for, of which they take their share. Requires frames.
void follow_error(double error_px, AutoLevels& levels);
// From the next frame on they take less of it: they lose excess_db more than they may. Returns
// false if they are the finest already.
[[nodiscard]] bool make_finer(double error_px, double excess_db, AutoLevels& levels);

// Draws a frame of a software backend for the eye of the one that is shown, which touches all of a
// target's memory, too: with all of error_px where that is good enough, else with half of it. Where
// rays do not tell (`loss`, of the same scene, is null, or the objects are small) polygons count as
// the truth.
[[nodiscard]] Audition audition_levels(const ShownFrame& shown, double error_px, double allowed_db,
                                       FrameLoss* loss, AutoLevels& levels);

}  // namespace rilievo
