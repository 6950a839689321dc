#include "apps/rilievo/kept_speed.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rilievo::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "rilievo-draw-speed-2";
// More agreement says no more.
constexpr int kMostAgreed = 1000;

Json json_of(const SpeedDependsOn& on) {
  return {{"schema", kSchema},           {"gl_renderer", on.gl_renderer},
          {"gl_version", on.gl_version}, {"processor", on.processor},
          {"threads", on.threads},       {"program", on.program}};
}

Json json_of(const PolygonTimes& times) {
  return {{"triangle_ns", times.triangle_ns}, {"pixel_ns", times.pixel_ns}};
}

std::optional<PolygonTimes> parse_times(const Json& json) {
  const PolygonTimes times{json.at("triangle_ns").get<double>(), json.at("pixel_ns").get<double>()};
  const auto good = [](double ns) { return ns >= kLeastNs && ns <= kMostNs; };
  return good(times.triangle_ns) && good(times.pixel_ns) ? std::optional(times) : std::nullopt;
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

std::string kept_speed_json(const KeptSpeed& kept, const SpeedDependsOn& on) {
  Json json = json_of(on);
  json["measured_at"] = kept.measured_at;
  json["agreed"] = kept.agreed;
  json["opengl"] = json_of(kept.speed.opengl);
  json["software"] = json_of(kept.speed.software);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<KeptSpeed> parse_kept_speed(std::string_view text, const SpeedDependsOn& on) {
  try {
    const Json json = Json::parse(text);
    // As a file has them: what is no UTF-8 is replaced there.
    const Json ours = Json::parse(json_of(on).dump(-1, ' ', false, Json::error_handler_t::replace));
    for (const auto& [key, value] : ours.items())
      if (json.at(key) != value) return std::nullopt;
    const std::optional<PolygonTimes> opengl = parse_times(json.at("opengl")),
                                      software = parse_times(json.at("software"));
    const Json &at = json.at("measured_at"), &times = json.at("agreed");
    if (!at.is_number_integer() || !times.is_number_integer()) return std::nullopt;
    const auto measured_at = at.get<std::int64_t>(), agreed = times.get<std::int64_t>();
    if (!opengl || !software || measured_at < 0 || agreed < 0 || agreed > kMostAgreed)
      return std::nullopt;
    return KeptSpeed{{*opengl, *software}, measured_at, int(agreed)};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace rilievo::app
