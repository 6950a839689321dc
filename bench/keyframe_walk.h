// One walk in real time by keyframes, measured, beside the other ways to draw it.
#pragma once

#include <string>
#include <vector>

#include "rilievo/core/camera_path.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {

// What to measure.
struct KeyframeWalkOptions {
  int width = 1280, height = 720;
  double seconds = 8;
  int places = 6;      // of the walk, at each of which two frames are compared
  int reference = 36;  // samples of a pixel of the true frames
  KeyframeFramesOptions keyframes;
  // The eye moves by a sixtieth of a second a frame, however long frames take; beside keyframes
  // only direct-raster draws. What frames look like does then not depend on the machine's speed,
  // if keyframes have no limit of time.
  bool each_frame = false;
  // Where true frames are kept, and what tells the scene from others; by the clock none is kept.
  std::string reference_folder, scene;
};

// Another way to draw the same.
struct KeyframeRival {
  std::string name;
  double p50_ms = 0, busy_p50_ms = 0;
  double psnr_db = 0;  // mean, against the true frames
  double shimmer = 0;  // as flicker(); 0: not measured
};

struct KeyframeWalk {
  int frames = 0;
  double first_frame_ms = 0;
  Summary frame_ms;        // of all after the first
  double busy_p50_ms = 0;  // processor time, of all threads
  double polygons_ms = 0;
  double warp_ms = 0, fill_ms = 0, tiles_ms = 0, keyframe_ms = 0;  // medians
  int keyframes = 0, coarse = 0;                                   // that were completed
  double filled_share = 0, filled_share_max = 0, live_share = 0;
  Summary psnr_db;
  // Of the squared differences, those within a pixel of a silhouette, and those of pixels that show
  // a wrong object: shares.
  double lost_at_edges = 0, lost_as_wrong = 0;
  double wrong_share = 0, wrong_share_max = 0, uncovered_share = 0;
  double wrong_share_direct = 0;  // of direct-raster with samples a quarter of a pixel beside
  int missing = 0;
  double shimmer = 0;
  std::vector<KeyframeRival> rivals;  // direct-raster first
  Rgba8Image truth, shown;            // the last frame compared

  // The fastest of those whose PSNR is not lower; of none: that with the highest.
  [[nodiscard]] const KeyframeRival& fastest_as_good() const;
};

// Walks, and draws what was compared by every rival. `backend` is the scene's, without OpenGL.
[[nodiscard]] Result<KeyframeWalk> walk_by_keyframes(SoftwareBackend& backend,
                                                     const CameraPath& path,
                                                     const KeyframeWalkOptions& options);

}  // namespace rilievo::bench
