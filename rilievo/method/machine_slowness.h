// How slow this machine is beside the one of FrameLoad's models (frame_load.h), by what frames took
// over what was counted for them. Internal: not a stable interface.
//
// Counts are off, too, by what is in view and who draws: on one machine polygons took 0.45 to 1.3
// times what was counted for them along twelve walks, and the cache 0.5 to 2.7 times. So what one
// of them says at first is believed in part, and both together more: the mean of the posterior
// where the logarithms of the machine's slowness and of both counts' errors are normal. Later, what
// changes in one is the machine.
#pragma once

#include <array>

namespace rilievo {

class MachineSlowness {
 public:
  // Who drew a frame.
  enum Source { polygons, cache, kSources };

  // Between which it is taken to lie: a frame that shows next to nothing, or triangles behind
  // others, says little.
  static constexpr double kFastest = 0.6, kSlowest = 10;
  // After so many frames it is known what is usual of who draws.
  static constexpr int kFew = 10;

  // A frame took `times` what was counted for it, > 0; `at_most`: or less, since it did what is not
  // counted. Returns by how much the estimate grew since more is known, not since the machine
  // became slower: what was measured before was as slow then.
  double add(Source source, double times, bool at_most = false);

  // Times as slow.
  [[nodiscard]] double value() const { return value_; }

  // Who draws now says nothing of the machine, for a frame: what may have been other programs' work
  // is forgotten, by and by.
  void forget();

 private:
  struct Of {
    double mean = 0;  // logarithm of the times
    int frames = 0;
  };
  [[nodiscard]] double estimate() const;
  void shift(double by);

  std::array<Of, kSources> of_;
  double value_ = 1, calm_ = 1;  // calm_: at its best, of late
  double changed_ = 0;           // logarithm of how much slower it has become
};

}  // namespace rilievo
