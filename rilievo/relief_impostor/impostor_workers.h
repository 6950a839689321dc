// Who warps and renders relief impostors while frames are drawn? (S5.1, S5.5)
//
// One thread warps; as many as there are sources render pictures, the worst impostor first, coarse
// pictures first. The frame's thread tells each frame's eye and takes what is ready: it never
// waits, never allocates and never holds a lock. Orders and results are handed over by triple
// buffers; what comes too late is overwritten by what is newer. An object that moved or turned is
// seen by an eye that moved the opposite way: eyes are in the space of the object at capture.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/nailboard/encode_prewarped.h"
#include "rilievo/relief_impostor/impostor_eye.h"
#include "rilievo/relief_impostor/impostor_state.h"

namespace rilievo {

// An object that is shown by an impostor.
struct ImpostorObject {
  std::vector<std::uint32_t> objects;  // of the sources; empty: all
  bool drawable = true;                // can the frame draw it without an impostor?
  // How fast its surface deforms at most, metres per second of ImpostorEye::time, besides its rigid
  // motion; 0: not at all.
  double deforms = 0;
  // It begins again after `period` seconds (0: never), when its surface jumps by at most `jump`
  // metres.
  double jump = 0, period = 0;
};

// How pictures are made, and when.
struct WorkerOptions {
  ImpostorLimits limits;
  // The most texels of a picture's longer side. A picture has texels_per_px texels a pixel where
  // that is fewer, so that its size follows its object's in the frame. A board has room for 1024.
  int size = 1024;
  double texels_per_px = 1;
  int samples = 4;         // of a picture
  int regions = 8;         // for the critical points
  double predict_s = 1.0;  // pictures are made for where the eye is when the next one is done, as
                           // it moves now, but at most so long ahead
  bool alone = false;      // shows the newest picture alone, never merged with the one before it
  // The workers run only on cores that no other thread wants, and between frames (frame_gate.h)
  // where they are told when these are drawn.
  bool gives_way = false;
};

// The camera of the picture of what lies within `bounds`, for an eye: with texels on the frame's
// pixels where the eye says where these are and the picture is then within options.size, otherwise
// straight at the bounds. Fails if they reach behind the eye.
[[nodiscard]] Result<Camera> impostor_camera(const Box& bounds, const ImpostorEye& eye,
                                             const WorkerOptions& options);

// What a frame shows of an object.
struct ImpostorFrame {
  ImpostorShown shown = ImpostorShown::object;
  // The nailboard; of fresh and stale. Valid until the next call for this object.
  const Prewarped* board = nullptr;
  const EncodedPiece* encoded = nullptr;  // the same as an atlas takes it
  bool changed = false;                   // since the last call
  std::uint64_t board_number = 0;         // another one where the board is another one
  double stretch = 0;                     // of the picture
  double moved_px = 0;                    // of the warp
  double deformed_px = 0;                 // what it shows has deformed since: an upper bound
  double interpolated = 0;                // share of the warp's texels
  std::uint64_t picture = 0;              // counts the pictures that were published; 0: none yet
  bool final = false;  // is the newest picture of full resolution and all samples?
  bool warping = false, rendering = false;  // is something ordered, or being made?
  double age_ms = 0;                        // since the picture that is shown was made
  double latency_ms = 0;  // of the frame that shows a picture first: since one was needed; else 0
};

// What the workers did.
struct WorkerStats {
  std::uint64_t warps = 0, pictures = 0, coarse = 0, cancelled = 0, failed = 0;
  double warp_ms = 0, render_ms = 0;  // all together
};

// The workers and what they make.
class ImpostorWorkers {
 public:
  // `sources`: one for each rendering worker, which must outlive the object; all show the same.
  ImpostorWorkers(std::vector<CaptureSource*> sources, std::vector<ImpostorObject> objects,
                  const WorkerOptions& options = {});
  // Stops what is being rendered.
  ~ImpostorWorkers();

  // Called by the frame's thread when it begins and ends to draw a frame. Meanwhile workers that
  // give way wait, for a limited time.
  void begin_frame();
  void end_frame();
  [[nodiscard]] bool drawing_frame() const;
  // The frame's thread: orders what `object` needs and says what to draw.
  [[nodiscard]] ImpostorFrame frame(std::size_t object, const ImpostorEye& eye);
  // The world at capture: what the pictures of `object` can show.
  [[nodiscard]] const Box& bounds(std::size_t object) const;
  // Waits until nothing is ordered or being made; for benches and tests.
  void wait_until_idle();
  [[nodiscard]] WorkerStats stats() const;
  // The error of the last picture that failed; empty if none did.
  [[nodiscard]] std::string last_error() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
