// Which values do options accept? Every number is checked by in_range() or finite(), because
// CLI::Range accepts NaN; main() makes all options refuse_empty().
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace rilievo::app {

// A number of type T from `least` to `most`.
template <class T>
[[nodiscard]] CLI::Validator in_range(T least, T most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        T value{};
        // Written so that NaN fails.
        const bool inside = !text.empty() && CLI::detail::lexical_cast(text, value) &&
                            value >= least && value <= most;
        return inside ? std::string()
                      : fmt::format("'{}' is not between {} and {}", text, least, most);
      },
      fmt::format("{} in [{} - {}]", CLI::detail::type_name<T>(), least, most));
}

// Any number but NaN and infinity.
[[nodiscard]] inline CLI::Validator finite() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool good =
            !text.empty() && CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        return good ? std::string() : fmt::format("'{}' is not a finite number", text);
      },
      "");
}

// Options that take a value refuse an empty one, which would count as not given.
inline void refuse_empty(CLI::App& command) {
  const CLI::Validator not_empty(
      [](std::string& text) { return text.empty() ? std::string("the value is empty") : ""; }, "");
  for (CLI::Option* option : command.get_options())
    if (option->get_items_expected_max() > 0) option->check(not_empty);
}

}  // namespace rilievo::app
