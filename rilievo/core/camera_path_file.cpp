#include <cmath>
#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/file.h"

namespace rilievo {
namespace {

using Json = nlohmann::json;

constexpr const char* kSchema = "rilievo-path-1";
constexpr std::uint64_t kMaxFileBytes = 64u << 20;
// Beyond any scene, and far from the range where doubles overflow.
constexpr double kMaxMagnitude = 1e9;

bool in_range(double v) { return std::abs(v) <= kMaxMagnitude; }  // false for NaN
bool in_range(const glm::dvec3& v) { return in_range(v.x) && in_range(v.y) && in_range(v.z); }

// Reads members of JSON objects; the first fault is kept, and named by the member's place.
struct Reader {
  std::string fault;

  void fail(const std::string& reason) {
    if (fault.empty()) fault = reason;
  }
  double number(const Json& object, const char* name, const std::string& place) {
    const auto found = object.find(name);
    if (found == object.end() || !found->is_number())
      return fail(place + " has no number \"" + name + "\""), 0.0;
    return found->get<double>();
  }
  // `count` numbers.
  glm::dvec4 numbers(const Json& object, const char* name, int count, const std::string& place) {
    const auto found = object.find(name);
    glm::dvec4 v{0.0};
    if (found == object.end() || !found->is_array() || found->size() != std::size_t(count))
      return fail(place + " has no \"" + name + "\" of " + std::to_string(count) + " numbers"), v;
    for (int i = 0; i < count; ++i) {
      const Json& element = (*found)[std::size_t(i)];
      if (!element.is_number())
        return fail(place + " has something else than numbers in \"" + name + "\""), v;
      v[i] = element.get<double>();
    }
    return v;
  }
};

PathKey read_key(const Json& json, const std::string& place, Reader& reader) {
  if (!json.is_object()) return reader.fail(place + " is not an object"), PathKey{};
  PathKey key;
  key.time = reader.number(json, "time", place);
  key.eye = reader.numbers(json, "eye", 3, place);
  key.vertical_fov = reader.number(json, "vertical_fov", place);
  if (json.contains("target")) {
    const glm::dvec3 target = reader.numbers(json, "target", 3, place);
    const glm::dvec3 up = json.contains("up") ? glm::dvec3(reader.numbers(json, "up", 3, place))
                                              : glm::dvec3(0, 1, 0);
    if (!reader.fault.empty()) return key;
    if (!in_range(target) || !in_range(up) || !in_range(key.eye))
      return reader.fail(place + " has a number out of range"), key;
    if (target == key.eye) return reader.fail(place + " looks at its own eye"), key;
    if (up == glm::dvec3(0)) return reader.fail(place + " has no direction \"up\""), key;
    return look_key(key.time, key.eye, target, up, key.vertical_fov);
  }
  const glm::dvec4 q = reader.numbers(json, "orientation", 4, place);
  const double length = glm::length(q);
  // Written by hand with a few digits, a unit quaternion is one to 1e-3.
  if (reader.fault.empty() && !(std::abs(length - 1.0) < 1e-3))
    return reader.fail(place + " has an \"orientation\" that is not a unit quaternion"), key;
  // One that is unit up to rounding comes back as it was written.
  const glm::dvec4 unit = std::abs(length - 1.0) < 1e-12 ? q : q / length;
  key.world_from_eye = glm::dquat(unit.w, unit.x, unit.y, unit.z);
  return key;
}

}  // namespace

Result<> validate(const CameraPath& path) {
  const auto error = [](const std::string& reason) { return Error{"camera path", reason}; };
  if (path.keys.empty()) return error("there is no key");
  if (!(0 < path.z_near && path.z_near < path.z_far && in_range(path.z_far)))
    return error("z_near and z_far do not satisfy 0 < z_near < z_far <= 1e9");
  for (std::size_t i = 0; i < path.keys.size(); ++i) {
    const PathKey& key = path.keys[i];
    const std::string name = "key " + std::to_string(i);
    if (!in_range(key.time) || !in_range(key.eye))
      return error(name + " has a number out of range");
    if (i > 0 && !(path.keys[i - 1].time < key.time))
      return error(name + " is not later than the key before it");
    if (!(std::abs(glm::length(key.world_from_eye) - 1.0) < 1e-6))
      return error(name + " has an orientation that is not a unit quaternion");
    if (!(0.001 <= key.vertical_fov && key.vertical_fov <= 3.1))
      return error(name + " has a vertical_fov outside 0.001 ... 3.1 radians");
  }
  return Done{};
}

Result<CameraPath> parse_path(std::string_view text, const std::string& where) {
  const auto error = [&](const std::string& reason) { return Error{where, reason}; };
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& e) {
    return error(std::string("not JSON: ") + e.what());
  }
  if (!json.is_object() || !json.contains("schema") || json["schema"] != kSchema)
    return error(std::string("not a camera path: \"schema\" is not \"") + kSchema + "\"");
  if (!json.contains("keys") || !json["keys"].is_array())
    return error("a camera path needs an array \"keys\"");

  Reader reader;
  CameraPath path;
  if (json.contains("z_near")) path.z_near = reader.number(json, "z_near", "the path");
  if (json.contains("z_far")) path.z_far = reader.number(json, "z_far", "the path");
  for (const Json& key : json["keys"]) {
    path.keys.push_back(read_key(key, "key " + std::to_string(path.keys.size()), reader));
    if (!reader.fault.empty()) return error(reader.fault);
  }
  if (!reader.fault.empty()) return error(reader.fault);
  const Result<> valid = validate(path);
  if (!valid) return error(valid.error().reason);
  return path;
}

Result<CameraPath> load_path(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file, kMaxFileBytes);
  if (!text) return text.error();
  return parse_path(*text, file.string());
}

Result<> save_path(const CameraPath& path, const std::filesystem::path& file) {
  const Result<> valid = validate(path);
  if (!valid) return Error{file.string(), valid.error().reason};
  nlohmann::ordered_json json{{"schema", kSchema}, {"z_near", path.z_near}, {"z_far", path.z_far}};
  json["keys"] = nlohmann::ordered_json::array();
  for (const PathKey& key : path.keys) {
    const glm::dquat& q = key.world_from_eye;
    json["keys"].push_back({{"time", key.time},
                            {"eye", {key.eye.x, key.eye.y, key.eye.z}},
                            {"orientation", {q.x, q.y, q.z, q.w}},
                            {"vertical_fov", key.vertical_fov}});
  }
  return write_file(file, json.dump(1) + "\n");
}

}  // namespace rilievo
