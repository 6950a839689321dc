#include "apps/rilievo/draw_speed.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "apps/commit.h"
#include "apps/rilievo/kept_speed.h"
#include "rilievo/cache/gl/measure_opengl.h"
#include "rilievo/cache/software/measure_software.h"
#include "rilievo/core/file.h"
#include "rilievo/gl/context.h"
#include "rilievo/gl/driver.h"
#include "rilievo/measure/machine.h"

namespace rilievo::app {
namespace {

// The share of software's time that OpenGL may take at most to be the faster one.
constexpr double kPlainlyFaster = 0.75;
constexpr std::uint64_t kMaxKeptBytes = 1 << 16;

// Where it is kept; empty: nowhere.
std::filesystem::path kept_file() {
  const auto folder = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value ? value : "");
  };
  const std::filesystem::path cache = folder("XDG_CACHE_HOME"), home = folder("HOME");
  if (cache.is_absolute()) return cache / "rilievo" / "draw_speed.json";
  if (home.is_absolute()) return home / ".cache" / "rilievo" / "draw_speed.json";
  return {};
}

// The file may lie in a home that several machines share.
SpeedDependsOn of_this_machine() {
  const Machine machine = this_machine();
  return {gl::renderer_name(), gl::driver_version(), machine.cpu,
          fmt::format("{} ({})", RILIEVO_VERSION, commit()), machine.threads};
}

std::int64_t seconds_since_1970() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::seconds>(now).count();
}

// What cannot be kept is measured again.
void keep(const std::filesystem::path& file, const std::string& text) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  if (!failed) static_cast<void>(write_file(file, text));
}

Result<DrawSpeed> measure() {
  const Result<PolygonTimes> opengl = measure_polygons_by_opengl();
  if (!opengl) return opengl.error();
  const Result<PolygonTimes> software = measure_polygons_by_software();
  if (!software) return software.error();
  return DrawSpeed{*opengl, *software};
}

// As it is kept, or measured and kept.
Result<DrawSpeed> kept_or_measured() {
  const std::filesystem::path file = kept_file();
  if (file.empty()) return measure();
  const SpeedDependsOn on = of_this_machine();
  const auto text = [&file] {
    const Result<std::string> read = read_file(file, kMaxKeptBytes);
    return read ? *read : std::string();
  };
  const std::optional<KeptSpeed> kept = find_kept_speed(text(), on);
  const std::int64_t now = seconds_since_1970();
  if (kept && holds(*kept, now)) return kept->speed;
  Result<DrawSpeed> measured = measure();
  // Read again: another program may have kept something meanwhile.
  const KeptSpeed* before = kept ? &*kept : nullptr;
  if (measured) keep(file, with_kept_speed(text(), measured_again(before, *measured, now), on));
  return measured;
}

}  // namespace

Result<bool> software_is_faster(double triangles, double pixels,
                                const std::optional<MachineCosts>& machine) {
  const auto faster = [&](const DrawSpeed& speed) {
    return speed.opengl.frame_ms(triangles, pixels) >
           kPlainlyFaster * speed.software.frame_ms(triangles, pixels);
  };
  if (machine && machine->draw_opengl) {
    const DrawTimes &software = machine->draw_software, &opengl = *machine->draw_opengl;
    return faster({{opengl.triangle_ns, opengl.polygon_pixel_ns},
                   {software.triangle_ns, software.polygon_pixel_ns}});
  }
  static std::optional<DrawSpeed> known;
  if (!known) {
    Result<DrawSpeed> speed = kept_or_measured();
    if (!speed) return speed.error();
    known = *speed;
  }
  return faster(*known);
}

}  // namespace rilievo::app
