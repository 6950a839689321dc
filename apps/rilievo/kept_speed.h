// What OpenGL and software were measured to take for polygons, as it is kept for later runs.
//
// A measurement may have met other programs, and a machine changes. So a file says what it depends
// on, and when it was made: one of another machine, driver or build does not hold, nor does an old
// one. The first one holds for a day; one that found about the same as the one before holds for a
// month. So what was disturbed decides for a day at most, unless it is disturbed in the same way
// twice. The size of a scene is no part: the times are of a triangle and of a pixel.
//
// One file keeps several, the newest first: a home may be shared by machines, and a machine may run
// with other drivers or numbers of threads in turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rilievo/cache/prices/machine_costs.h"

namespace rilievo::app {

struct DrawSpeed {
  PolygonTimes opengl, software;
};

// What a measurement depends on.
struct SpeedDependsOn {
  std::string gl_renderer, gl_version, processor, program;
  int threads = 0;
  friend bool operator==(const SpeedDependsOn&, const SpeedDependsOn&) = default;
};

struct KeptSpeed {
  DrawSpeed speed;
  std::int64_t measured_at = 0;  // seconds since 1970
  int agreed = 0;                // measurements before it, in a row, that found about the same
};

// How long one holds, seconds.
inline constexpr std::int64_t kFirstHolds = 24 * 3600, kAgreedHolds = 30 * kFirstHolds;
// Times that differ by more than this factor are not about the same.
inline constexpr double kAboutTheSame = 1.5;

// Does it still hold? One from the future does not.
[[nodiscard]] bool holds(const KeptSpeed& kept, std::int64_t now);
// What is kept when that was measured; `before`, of the same things, may be null.
[[nodiscard]] KeptSpeed measured_again(const KeptSpeed* before, const DrawSpeed& speed,
                                       std::int64_t now);

// A file keeps so many.
inline constexpr std::size_t kMostKept = 16;

// What a file keeps of those things. None: nothing, or it is damaged.
[[nodiscard]] std::optional<KeptSpeed> find_kept_speed(std::string_view file,
                                                       const SpeedDependsOn& on);
// The file with that in place of what it kept of those things; what else it kept stays, up to
// kMostKept in all. Damaged parts go.
[[nodiscard]] std::string with_kept_speed(std::string_view file, const KeptSpeed& kept,
                                          const SpeedDependsOn& on);

}  // namespace rilievo::app
