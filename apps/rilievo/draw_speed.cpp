#include "apps/rilievo/draw_speed.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "rilievo/cache/gl/measure_opengl.h"
#include "rilievo/cache/software/measure_software.h"
#include "rilievo/core/file.h"
#include "rilievo/gl/context.h"

namespace rilievo::app {
namespace {

using Json = nlohmann::ordered_json;

// The share of software's time that OpenGL may take at most to be the faster one.
constexpr double kPlainlyFaster = 0.75;
constexpr const char* kSpeedSchema = "rilievo-draw-speed-1";
constexpr std::uint64_t kMaxKeptBytes = 1 << 16;

struct DrawSpeed {
  PolygonTimes opengl, software;
};

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

// Of this machine: the file may lie in a home that several share.
Json of_this_machine() {
  return {{"schema", kSpeedSchema},
          {"gl_renderer", gl::renderer_name()},
          {"threads", std::thread::hardware_concurrency()}};
}

std::optional<PolygonTimes> parse_times(const Json& json, const char* name) {
  const auto time = [&](const char* key) {
    const double ns = json.at(name).at(key).get<double>();
    return ns >= kLeastNs && ns <= kMostNs ? ns : 0.0;
  };
  const PolygonTimes times{time("triangle_ns"), time("pixel_ns")};
  if (times.triangle_ns == 0 || times.pixel_ns == 0) return std::nullopt;
  return times;
}

// None: there is no file, it is damaged, or it is another machine's.
std::optional<DrawSpeed> read_kept(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file, kMaxKeptBytes);
  if (!text) return std::nullopt;
  try {
    const Json json = Json::parse(*text);
    const Json ours = of_this_machine();
    for (const auto& [key, value] : ours.items())
      if (json.at(key) != value) return std::nullopt;
    const std::optional<PolygonTimes> opengl = parse_times(json, "opengl"),
                                      software = parse_times(json, "software");
    if (!opengl || !software) return std::nullopt;
    return DrawSpeed{*opengl, *software};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

// What cannot be kept is measured again.
void keep(const DrawSpeed& speed, const std::filesystem::path& file) {
  const auto times = [](const PolygonTimes& of) {
    return Json{{"triangle_ns", of.triangle_ns}, {"pixel_ns", of.pixel_ns}};
  };
  Json json = of_this_machine();
  json["opengl"] = times(speed.opengl);
  json["software"] = times(speed.software);
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  if (!failed) static_cast<void>(write_file(file, json.dump(2) + "\n"));
}

Result<DrawSpeed> measure() {
  const Result<PolygonTimes> opengl = measure_polygons_by_opengl();
  if (!opengl) return opengl.error();
  const Result<PolygonTimes> software = measure_polygons_by_software();
  if (!software) return software.error();
  return DrawSpeed{*opengl, *software};
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
  if (known) return faster(*known);
  const std::filesystem::path file = kept_file();
  if (!file.empty()) known = read_kept(file);
  if (known) return faster(*known);
  Result<DrawSpeed> measured = measure();
  if (!measured) return measured.error();
  known = *measured;
  if (!file.empty()) keep(*known, file);
  return faster(*known);
}

}  // namespace rilievo::app
