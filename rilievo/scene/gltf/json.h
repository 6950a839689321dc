// A value of a glTF document that knows where it stands, so that a fault can say so:
// "accessors[3].count: must be a whole number". Internal to loading; throws LoadError.
//
// An absent value is a value, too: its members are absent, its size is 0, and reading it yields the
// fallback or, where there is none, a fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

namespace rilievo {

class JsonValue {
 public:
  explicit JsonValue(const nlohmann::json& root) : value_(&root) {}

  [[nodiscard]] explicit operator bool() const { return value_ != nullptr; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& reason) const;

  // A member of an object.
  [[nodiscard]] JsonValue operator[](const char* key) const;
  // An element of an array; requires i < size().
  [[nodiscard]] JsonValue operator[](std::size_t i) const;
  // Elements of an array.
  [[nodiscard]] std::size_t size() const;
  // Calls visit(name, value) for each member of an object.
  void each_member(
      const std::function<void(const std::string& name, const JsonValue& value)>& visit) const;

  [[nodiscard]] double number(std::optional<double> fallback = {}) const;  // finite as a float
  [[nodiscard]] std::uint64_t whole(std::optional<std::uint64_t> fallback = {}) const;
  // An index into an array of `count`; absent: -1.
  [[nodiscard]] int index(std::size_t count) const;
  // The same, but it must be there.
  [[nodiscard]] int required_index(std::size_t count) const;
  [[nodiscard]] bool boolean(bool fallback) const;
  [[nodiscard]] std::string text(std::optional<std::string> fallback = {}) const;
  // Exactly out.size() numbers; absent: `out` stays as it is.
  void numbers(std::span<double> out) const;
  [[nodiscard]] glm::dvec3 vec3(const glm::dvec3& fallback) const;
  [[nodiscard]] glm::dvec4 vec4(const glm::dvec4& fallback) const;

 private:
  JsonValue(const nlohmann::json* value, std::string path)
      : value_(value), path_(std::move(path)) {}

  const nlohmann::json* value_ = nullptr;
  std::string path_;
};

}  // namespace rilievo
