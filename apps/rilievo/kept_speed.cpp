#include "apps/rilievo/kept_speed.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rilievo::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "rilievo-draw-speed-3";
// More agreement says no more.
constexpr int kMostAgreed = 1000;

std::string text_of(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const SpeedDependsOn& on) {
  const Json json{{"gl_renderer", on.gl_renderer},
                  {"gl_version", on.gl_version},
                  {"processor", on.processor},
                  {"threads", on.threads},
                  {"program", on.program}};
  // As a file has them: what is no UTF-8 is replaced there.
  return Json::parse(text_of(json, -1));
}

Json json_of(const PolygonTimes& times) {
  return {{"triangle_ns", times.triangle_ns}, {"pixel_ns", times.pixel_ns}};
}

std::optional<PolygonTimes> parse_times(const Json& json) {
  const PolygonTimes times{json.at("triangle_ns").get<double>(), json.at("pixel_ns").get<double>()};
  const auto good = [](double ns) { return ns >= kLeastNs && ns <= kMostNs; };
  return good(times.triangle_ns) && good(times.pixel_ns) ? std::optional(times) : std::nullopt;
}

// Those of a file, as they are there.
Json entries_of(std::string_view file) {
  const Json json = Json::parse(file, nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != kSchema) return Json::array();
  const auto kept = json.find("kept");
  return kept != json.end() && kept->is_array() ? *kept : Json::array();
}

// Does an entry depend on the same things?
bool is_of(const Json& entry, const Json& on) {
  if (!entry.is_object()) return false;
  for (const auto& [key, value] : on.items())
    if (entry.value(key, Json()) != value) return false;
  return true;
}

std::optional<KeptSpeed> parse(const Json& entry) {
  try {
    const std::optional<PolygonTimes> opengl = parse_times(entry.at("opengl")),
                                      software = parse_times(entry.at("software"));
    const Json &at = entry.at("measured_at"), &times = entry.at("agreed");
    if (!at.is_number_integer() || !times.is_number_integer()) return std::nullopt;
    const auto measured_at = at.get<std::int64_t>(), agreed = times.get<std::int64_t>();
    if (!opengl || !software || measured_at < 0 || agreed < 0 || agreed > kMostAgreed)
      return std::nullopt;
    return KeptSpeed{{*opengl, *software}, measured_at, int(agreed)};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

bool about_the_same(const PolygonTimes& a, const PolygonTimes& b) {
  const auto same = [](double one, double other) {
    return std::max(one, other) <= kAboutTheSame * std::min(one, other);
  };
  return same(a.triangle_ns, b.triangle_ns) && same(a.pixel_ns, b.pixel_ns);
}

}  // namespace

bool holds(const KeptSpeed& kept, std::int64_t now) {
  const std::int64_t most = kept.agreed > 0 ? kAgreedHolds : kFirstHolds;
  return kept.measured_at <= now && now - kept.measured_at < most;
}

KeptSpeed measured_again(const KeptSpeed* before, const DrawSpeed& speed, std::int64_t now) {
  const bool agrees = before && about_the_same(before->speed.opengl, speed.opengl) &&
                      about_the_same(before->speed.software, speed.software);
  return {speed, now, agrees ? std::min(before->agreed + 1, kMostAgreed) : 0};
}

std::optional<KeptSpeed> find_kept_speed(std::string_view file, const SpeedDependsOn& on) {
  const Json ours = json_of(on);
  for (const Json& one : entries_of(file))
    if (is_of(one, ours)) return parse(one);
  return std::nullopt;
}

std::string with_kept_speed(std::string_view file, const KeptSpeed& kept,
                            const SpeedDependsOn& on) {
  const Json ours = json_of(on);
  Json first = ours;
  first["measured_at"] = kept.measured_at;
  first["agreed"] = kept.agreed;
  first["opengl"] = json_of(kept.speed.opengl);
  first["software"] = json_of(kept.speed.software);
  Json all = Json::array({std::move(first)});
  for (const Json& one : entries_of(file))
    if (all.size() < kMostKept && !is_of(one, ours) && parse(one)) all.push_back(one);
  return text_of({{"schema", kSchema}, {"kept", std::move(all)}}, 2) + "\n";
}

}  // namespace rilievo::app
