#include "rilievo/cache/prices/machine_costs.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rilievo/core/expects.h"
#include "rilievo/core/file.h"

namespace rilievo {
namespace {

using MachineJson = nlohmann::ordered_json;

constexpr const char* kMachineSchema = "rilievo-machine-1";
constexpr std::uint64_t kMaxMachineBytes = 1u << 20;
constexpr int kMostThreads = 1 << 20;

// The members by name, the same for reading and writing.
template <typename Times, typename Visit>
void visit_draw(Times& times, const Visit& visit) {
  visit("picture_ns", times.picture_ns);
  visit("picture_pixel_ns", times.picture_pixel_ns);
  visit("object_ns", times.object_ns);
  visit("triangle_ns", times.triangle_ns);
  visit("polygon_pixel_ns", times.polygon_pixel_ns);
}
template <typename Times, typename Visit>
void visit_capture(Times& times, const Visit& visit) {
  visit("picture_ns", times.picture_ns);
  visit("triangle_ns", times.triangle_ns);
  visit("texel_ns", times.texel_ns);
}

MachineJson draw_json(const DrawTimes& times) {
  MachineJson json;
  visit_draw(times, [&](const char* name, double ns) { json[name] = ns; });
  return json;
}
MachineJson capture_json(const CaptureTimes& times) {
  MachineJson json;
  visit_capture(times, [&](const char* name, double ns) { json[name] = ns; });
  return json;
}

// Reads members; the first fault is kept.
struct MachineReader {
  std::string fault;

  void fail(const std::string& reason) {
    if (fault.empty()) fault = reason;
  }
  // A member that is an object; null if it is missing.
  const MachineJson* part(const MachineJson& json, const char* name, const std::string& place,
                          bool required) {
    const auto found = json.find(name);
    if (found == json.end()) {
      if (required) fail("\"" + place + "\" is missing");
      return nullptr;
    }
    if (!found->is_object()) return fail("\"" + place + "\" is not an object"), nullptr;
    return &*found;
  }
  void time(const MachineJson& json, const char* name, const std::string& place, double& ns) {
    const std::string full = "\"" + place + "." + name + "\"";
    const auto found = json.find(name);
    if (found == json.end()) return fail(full + " is missing");
    if (!found->is_number()) return fail(full + " is not a number");
    ns = found->get<double>();
    if (!(ns >= kLeastNs && ns <= kMostNs))
      fail(full + " is not between 0.0001 and 1e9 nanoseconds");
  }
  DrawTimes draw(const MachineJson& json, const std::string& place) {
    DrawTimes times;
    visit_draw(times, [&](const char* name, double& ns) { time(json, name, place, ns); });
    return times;
  }
  CaptureTimes capture(const MachineJson& json, const std::string& place) {
    CaptureTimes times;
    visit_capture(times, [&](const char* name, double& ns) { time(json, name, place, ns); });
    return times;
  }
};

std::string text_of(const MachineJson& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

MachineCosts builtin_software_costs() {
  MachineCosts costs;
  costs.threads = 2;
  // Of walks through models that others made, not of measured balls side by side: most triangles
  // are hidden by other objects, and captures look through all of them.
  costs.draw_software = {2800, 5.6, 1400, 14, 24};
  costs.capture_rasterizer = {11'200, 28, 84};
  costs.ray_texel_ns = 224;
  return costs;
}

std::string machine_json(const MachineCosts& costs) {
  MachineJson json{{"schema", kMachineSchema}, {"cpu", costs.cpu}, {"threads", costs.threads}};
  if (!costs.gl_renderer.empty()) json["gl_renderer"] = costs.gl_renderer;
  json["draw"]["software"] = draw_json(costs.draw_software);
  if (costs.draw_opengl) json["draw"]["opengl"] = draw_json(*costs.draw_opengl);
  json["capture"]["rasterizer"] = capture_json(costs.capture_rasterizer);
  json["capture"]["rays"]["texel_ns"] = costs.ray_texel_ns;
  if (costs.capture_opengl) json["capture"]["opengl"] = capture_json(*costs.capture_opengl);
  return json.dump(2, ' ', false, MachineJson::error_handler_t::replace) + "\n";
}

Result<MachineCosts> parse_machine(std::string_view text, const std::string& where) {
  const auto error = [&](const std::string& reason) { return Error{where, reason}; };
  MachineJson json;
  try {
    json = MachineJson::parse(text);
  } catch (const MachineJson::exception& e) {
    return error(std::string("not JSON: ") + e.what());
  }
  if (!json.is_object() || text_of(json, "schema") != kMachineSchema)
    return error(std::string("holds no machine's costs: \"schema\" is not \"") + kMachineSchema +
                 "\"");
  MachineCosts costs;
  costs.cpu = text_of(json, "cpu");
  costs.gl_renderer = text_of(json, "gl_renderer");
  if (const auto found = json.find("threads");
      found != json.end() && found->is_number_integer() && *found >= 0 && *found <= kMostThreads)
    costs.threads = found->get<int>();
  MachineReader reader;
  if (const MachineJson* draw = reader.part(json, "draw", "draw", true)) {
    if (const MachineJson* one = reader.part(*draw, "software", "draw.software", true))
      costs.draw_software = reader.draw(*one, "draw.software");
    if (const MachineJson* one = reader.part(*draw, "opengl", "draw.opengl", false))
      costs.draw_opengl = reader.draw(*one, "draw.opengl");
  }
  if (const MachineJson* capture = reader.part(json, "capture", "capture", true)) {
    if (const MachineJson* one = reader.part(*capture, "rasterizer", "capture.rasterizer", true))
      costs.capture_rasterizer = reader.capture(*one, "capture.rasterizer");
    if (const MachineJson* one = reader.part(*capture, "rays", "capture.rays", true))
      reader.time(*one, "texel_ns", "capture.rays", costs.ray_texel_ns);
    if (const MachineJson* one = reader.part(*capture, "opengl", "capture.opengl", false))
      costs.capture_opengl = reader.capture(*one, "capture.opengl");
  }
  if (!reader.fault.empty()) return error(reader.fault);
  return costs;
}

Result<MachineCosts> load_machine(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file, kMaxMachineBytes);
  if (!text) return text.error();
  return parse_machine(*text, file.string());
}

Result<> save_machine(const MachineCosts& costs, const std::filesystem::path& file) {
  return write_file(file, machine_json(costs));
}

}  // namespace rilievo
