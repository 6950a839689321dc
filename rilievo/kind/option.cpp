#include "rilievo/kind/option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

std::optional<double> number_from(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

// Numbers with commas between them; empty if one of them is none.
std::vector<double> numbers_from(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::optional<double> number = number_from(text.substr(0, comma));
    if (!number) return {};
    numbers.push_back(*number);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

// Three numbers each; empty if one of them is no point.
std::vector<double> points_from(std::string_view text) {
  std::vector<double> all;
  while (!text.empty()) {
    const std::size_t space = std::min(text.find(' '), text.size());
    const std::vector<double> point = numbers_from(text.substr(0, space));
    if (point.size() != 3) return {};
    all.insert(all.end(), point.begin(), point.end());
    text.remove_prefix(std::min(space + 1, text.size()));
  }
  return all;
}

bool is_box(const std::vector<double>& n) {
  return n.size() == 6 && n[0] < n[3] && n[1] < n[4] && n[2] < n[5];
}

bool accepts(const Option& option, std::string_view value) {
  switch (option.type) {
    case OptionType::flag:
      return value == "on" || value == "off";
    case OptionType::integer:
    case OptionType::number: {
      const std::optional<double> number = number_from(value);
      return number && *number >= option.min && *number <= option.max &&
             (option.type == OptionType::number || *number == std::floor(*number));
    }
    case OptionType::choice:
      return std::find(option.choices.begin(), option.choices.end(), value) != option.choices.end();
    case OptionType::point:
      return value.empty() || numbers_from(value).size() == 3;
    case OptionType::points:
      return value.empty() || !points_from(value).empty();
    case OptionType::box:
      return value.empty() || is_box(numbers_from(value));
    case OptionType::text:
      return true;
  }
  return false;
}

}  // namespace

std::string expected_text(const Option& option) {
  switch (option.type) {
    case OptionType::flag:
      return "on or off";
    case OptionType::integer:
      return fmt::format("a whole number from {} to {}", option.min, option.max);
    case OptionType::number:
      return fmt::format("a number from {} to {}", option.min, option.max);
    case OptionType::choice:
      return fmt::format("{}", fmt::join(option.choices, ", "));
    case OptionType::point:
      return "three numbers, X,Y,Z";
    case OptionType::points:
      return "one or more points, X,Y,Z each";
    case OptionType::box:
      return "two corners, X0,Y0,Z0,X1,Y1,Z1, the second above the first along every axis";
    case OptionType::text:
      break;
  }
  return {};
}

OptionValues::OptionValues(std::span<const Option> options) : options_(options) {
  for (const Option& option : options) {
    RILIEVO_EXPECTS(accepts(option, option.default_value));
    values_.push_back({std::string(option.default_value), false});
  }
}

Result<> OptionValues::set(std::string_view name, std::string_view value) {
  const std::size_t i = index_of(name);
  if (!accepts(options_[i], value))
    return Error{fmt::format("--{}", name),
                 fmt::format("'{}' is not {}", value, expected_text(options_[i]))};
  values_[i] = {std::string(value), true};
  return Done{};
}

std::size_t OptionValues::index_of(std::string_view name) const {
  const auto found = std::find_if(options_.begin(), options_.end(),
                                  [&](const Option& option) { return option.name == name; });
  RILIEVO_EXPECTS(found != options_.end());
  return std::size_t(found - options_.begin());
}

bool OptionValues::has(std::string_view name) const {
  return std::any_of(options_.begin(), options_.end(),
                     [&](const Option& option) { return option.name == name; });
}

Result<> OptionValues::expect_none_of(std::initializer_list<std::string_view> names,
                                      const std::string& reason) const {
  for (const std::string_view name : names)
    if (given(name)) return Error{"--" + std::string(name), reason};
  return Done{};
}

bool OptionValues::given(std::string_view name) const { return values_[index_of(name)].given; }

bool OptionValues::flag(std::string_view name) const {
  RILIEVO_EXPECTS(options_[index_of(name)].type == OptionType::flag);
  return text(name) == "on";
}

int OptionValues::integer(std::string_view name) const { return int(number(name)); }

double OptionValues::number(std::string_view name) const {
  const std::optional<double> value = number_from(text(name));
  RILIEVO_EXPECTS(value.has_value());
  return *value;
}

std::vector<double> OptionValues::numbers(std::string_view name) const {
  const bool points = options_[index_of(name)].type == OptionType::points;
  return points ? points_from(text(name)) : numbers_from(text(name));
}

const std::string& OptionValues::text(std::string_view name) const {
  return values_[index_of(name)].text;
}

}  // namespace rilievo
