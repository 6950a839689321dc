// True frames with many samples a pixel, against which every method is compared, direct drawing
// with its few samples too.
//
// A frame of four samples a pixel is itself 30 dB (leaves) to 46 dB from a picture that more
// samples would change no more; compared with it, a method is punished for its aliasing. Here a
// frame is drawn in k x k parts, each a k-th as wide and high and as large as the frame, and every
// k x k pixels are averaged as displayed bytes, as a frame averages its samples. Textures are read
// as sharply as the small pixels are. A frame takes k x k times as long as the source's own: they
// can be kept as PNG files.
#pragma once

#include <filesystem>
#include <string>

#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/result.h"

namespace rilievo {

// How many samples, and where frames are kept.
struct ReferenceOptions {
  int samples = 64;              // of a pixel: those of the source times 1, 4, 9 or 16
  std::filesystem::path folder;  // of kept frames; made when needed; empty: none is kept
  std::string scene;             // tells scenes apart in the folder
};

// Can a source with so many samples a pixel make a reference with that many?
[[nodiscard]] bool can_reference(int samples, int source_samples);

// The means of parts x parts pixels of `part`, as displayed bytes, into those of `frame` from
// (x0, y0) on.
void average_into(const Rgba8Image& part, int parts, int x0, int y0, Rgba8Image& frame);

// Makes true frames.
class ReferenceFrames {
 public:
  // `source` draws without OpenGL (software_target()), and must outlive the object. Requires
  // can_reference().
  ReferenceFrames(FrameSource& source, int source_samples, ReferenceOptions options);

  // The true frame, as kept or drawn anew; a perspective camera. Fails where the source does, and
  // where the frame cannot be kept.
  [[nodiscard]] Result<Rgba8Image> frame(const WalkFrame& walk);
  // The number of frames that were drawn, not found.
  [[nodiscard]] int drawn() const { return drawn_; }

 private:
  [[nodiscard]] Result<Rgba8Image> draw(const WalkFrame& walk);
  [[nodiscard]] std::filesystem::path file_of(const WalkFrame& walk) const;

  FrameSource& source_;
  int parts_ = 1;  // on each side
  ReferenceOptions options_;
  int drawn_ = 0;
};

}  // namespace rilievo
