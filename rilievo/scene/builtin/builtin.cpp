#include "rilievo/scene/builtin/builtin.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

constexpr std::string_view kPrefix = "builtin:";

struct Entry {
  std::string_view name;
  std::uint64_t triangles, least, most;
  BuiltinScene (*make)(std::uint64_t triangles, std::uint64_t seed);
};
constexpr Entry kEntries[] = {
    {"bridge", 2'000'000, 100'000, 50'000'000, make_bridge},
    {"forest", 10'000'000, 10'000, 100'000'000, make_forest},
    {"teapots", 200'000, 10'000, 20'000'000, make_teapots},
    {"stonehenge", 200'000, 10'000, 20'000'000, make_stonehenge},
    {"teapot", 30'000, 500, 10'000'000,
     [](std::uint64_t triangles, std::uint64_t) { return make_single_teapot(triangles); }},
    {"fern", 60'000, 16'000, 10'000'000, make_fern},
    {"fish", 60'000, 1'000, 10'000'000, make_fish},
    {"cube", 12, 12, 10'000'000, make_cube},
};

const Entry* find_entry(std::string_view name) {
  for (const Entry& entry : kEntries)
    if (entry.name == name) return &entry;
  return nullptr;
}

std::string names() {
  std::string all;
  for (const Entry& entry : kEntries) (all += all.empty() ? "" : ", ") += entry.name;
  return all;
}

std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

bool is_builtin(std::string_view spec) { return spec.substr(0, kPrefix.size()) == kPrefix; }

Result<BuiltinScene> make_builtin(std::string_view spec) {
  const auto error = [&](const std::string& reason) { return Error{std::string(spec), reason}; };
  if (!is_builtin(spec)) return error("a built-in scene begins with \"builtin:\"");
  const std::string_view rest = spec.substr(kPrefix.size());
  const std::size_t mark = rest.find('?');
  const Entry* entry = find_entry(rest.substr(0, mark));
  if (!entry) return error("no such built-in scene; there are " + names());

  std::uint64_t triangles = entry->triangles, seed = 1;
  std::string_view options = mark == rest.npos ? "" : rest.substr(mark + 1);
  while (!options.empty()) {
    const std::size_t end = std::min(options.find('&'), options.size());
    const std::string_view option = options.substr(0, end);
    options.remove_prefix(std::min(end + 1, options.size()));
    const std::size_t equals = std::min(option.find('='), option.size());
    const std::string_view name = option.substr(0, equals);
    if (name != "triangles" && name != "seed")
      return error("no option \"" + std::string(name) + "\"; there are triangles=N and seed=S");
    const std::optional<std::uint64_t> value =
        parse_number(option.substr(std::min(equals + 1, option.size())));
    if (name == "seed") {
      if (!value) return error("seed must be a whole number");
      seed = *value;
    } else {
      if (!value || *value < entry->least || *value > entry->most)
        return error("triangles must be a whole number from " + std::to_string(entry->least) +
                     " to " + std::to_string(entry->most));
      triangles = *value;
    }
  }
  return entry->make(triangles, seed);
}

}  // namespace rilievo
