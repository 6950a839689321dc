#include "rilievo/scene/gltf/json.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "rilievo/core/expects.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

void JsonValue::fail(const std::string& reason) const {
  refuse(path_.empty() ? "the document " + reason : path_ + " " + reason);
}

JsonValue JsonValue::operator[](const char* key) const {
  if (!value_) return {nullptr, path_};
  if (!value_->is_object()) fail("must be an object");
  std::string path = path_.empty() ? std::string(key) : path_ + "." + key;
  const auto found = value_->find(key);
  return {found == value_->end() ? nullptr : &*found, std::move(path)};
}

JsonValue JsonValue::operator[](std::size_t i) const {
  RILIEVO_EXPECTS_LT(i, size());
  return {&(*value_)[i], path_ + "[" + std::to_string(i) + "]"};
}

std::size_t JsonValue::size() const {
  if (!value_) return 0;
  if (!value_->is_array()) fail("must be an array");
  return value_->size();
}

void JsonValue::each_member(
    const std::function<void(const std::string&, const JsonValue&)>& visit) const {
  if (!value_) return;
  if (!value_->is_object()) fail("must be an object");
  for (const auto& [name, value] : value_->items())
    visit(name, JsonValue(&value, path_.empty() ? name : path_ + "." + name));
}

double JsonValue::number(std::optional<double> fallback) const {
  if (!value_) {
    if (!fallback) fail("is missing");
    return *fallback;
  }
  if (!value_->is_number()) fail("must be a number");
  const double number = value_->get<double>();
  if (!(std::abs(number) <= double(std::numeric_limits<float>::max()))) fail("is too large");
  return number;
}

std::uint64_t JsonValue::whole(std::optional<std::uint64_t> fallback) const {
  if (!value_) {
    if (!fallback) fail("is missing");
    return *fallback;
  }
  // 2^53: what every reader of JSON can hold exactly. 3.0 is a whole number, too.
  const double number = value_->is_number() ? value_->get<double>() : -1.0;
  if (!(number >= 0 && number <= 9007199254740992.0 && number == std::floor(number)))
    fail("must be a whole number");
  return std::uint64_t(number);
}

int JsonValue::index(std::size_t count) const {
  if (!value_) return -1;
  return required_index(count);
}

int JsonValue::required_index(std::size_t count) const {
  const std::uint64_t i = whole();
  if (i >= count || i > std::uint64_t(std::numeric_limits<int>::max()))
    fail("refers to " + std::to_string(i) + but_there_are(count));
  return int(i);
}

bool JsonValue::boolean(bool fallback) const {
  if (!value_) return fallback;
  if (!value_->is_boolean()) fail("must be true or false");
  return value_->get<bool>();
}

std::string JsonValue::text(std::optional<std::string> fallback) const {
  if (!value_) {
    if (!fallback) fail("is missing");
    return *fallback;
  }
  if (!value_->is_string()) fail("must be a string");
  return value_->get<std::string>();
}

void JsonValue::numbers(std::span<double> out) const {
  if (!value_) return;
  if (size() != out.size()) fail("must have " + std::to_string(out.size()) + " numbers");
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (*this)[i].number();
}

glm::dvec3 JsonValue::vec3(const glm::dvec3& fallback) const {
  glm::dvec3 v = fallback;
  numbers({&v[0], 3});
  return v;
}

glm::dvec4 JsonValue::vec4(const glm::dvec4& fallback) const {
  glm::dvec4 v = fallback;
  numbers({&v[0], 4});
  return v;
}

}  // namespace rilievo
