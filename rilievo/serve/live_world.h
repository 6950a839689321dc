// The core of a live walk's server: what does each client hold, whose view is worst, and what is
// made for it next?
//
// Clients' sessions tell poses and take messages; one picture after the other is made, for the
// client whose view is worst. A client's next picture waits in one place, where a newer one
// replaces it. Pictures that were made are kept within a limit of memory: a client whose view one
// of them shows gets that one. Time is passed in, in seconds.
//
// Sessions are used by one thread (session.h); work() by another one, or by the same.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/serve/session.h"

namespace rilievo {

struct MadePicture;
struct Sky;

// What is walked through.
struct LiveScene {
  std::string name;  // at most 255 bytes are sent
  Box bounds;
  Camera start;  // where a walk begins, and the clipping planes of all pictures
  glm::dvec3 up{0, 1, 0};
  double metres_per_unit = 1;
  // Drawn behind what a source captures that draws none of its own; null: the source draws it.
  const Sky* sky = nullptr;
  // Seconds at which the scene is shown.
  double time = 0;
};

struct LiveWorldOptions {
  // The eye's distance from a keyframe's after which there is another one; 0: where things seen
  // have moved by a fifteenth of the frame's height.
  double cell = 0;
  double error_px = 0.25;  // of depths
  double margin = 1.25;    // of a picture's sides over the frame's; where looks are uncertain, more
  int quality = 85;        // of JPEG, the best; a slow client gets less
  std::size_t kept_bytes = std::size_t(256) << 20;
  int most_lines = 1080;  // of a frame for which pictures are made
  // Seconds of a picture with this margin, more for a wider one, and of a coarse one or a face of
  // the surround, for work(): so that nothing depends on time. 0: as measured; coarse as fine.
  double work_s = 0, coarse_work_s = 0;
  bool keep_objects = false;  // MadePicture::objects, for measures
};

// What was done so far.
struct LiveWorldStats {
  int clients = 0;
  std::uint64_t made = 0, coarse = 0, surround = 0;  // pictures; coarse views and faces are part
  std::uint64_t shared = 0;                          // that were sent and not made anew
  std::uint64_t replaced = 0;                        // before they were sent
  std::uint64_t failed = 0;                          // captures
  std::size_t kept_bytes = 0;
  double busy_s = 0;
};

// A scene, its source, and its clients.
class LiveWorld {
 public:
  // The sources must outlive it and are used by work() alone; `quick` makes coarse pictures.
  LiveWorld(CaptureSource& source, CaptureSource& quick, const LiveScene& scene,
            const LiveWorldOptions& options = {});
  // Waits for what is being made. Sessions may outlive it.
  ~LiveWorld();

  // A new client. Its first message is a welcome.
  [[nodiscard]] std::unique_ptr<LiveSession> connect();

  // Makes pictures in the background from now on, whenever a client needs one. `clock` gives the
  // time that sessions get, too; `ready` is called on any thread when next() may have something.
  void start(std::function<double()> clock, std::function<void()> ready);

  // Without start(): makes the most urgent picture. Returns the seconds that it took by the
  // processor time of all threads, over two cores; next() has it after as long. 0: there is none.
  double work(double now);

  [[nodiscard]] LiveWorldStats stats() const;
  // A picture that is kept; null if it is not. For measures.
  [[nodiscard]] std::shared_ptr<const MadePicture> picture(std::uint64_t id) const;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace rilievo
