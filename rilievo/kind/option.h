// The options of a kind of representation, and the values that were given.
//
// The command line, the viewer's panel and `rilievo info` are made from one description of each
// option. Values are text, as on a command line, and are checked when they are set.
#pragma once

#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/core/result.h"

namespace rilievo {

// The type of an option's value.
enum class OptionType {
  flag,     // "on" or "off"
  integer,  // within [min, max]
  number,   // within [min, max], finite
  choice,   // one of `choices`
  point,    // three finite numbers "X,Y,Z", or empty
  points,   // several points, separated by spaces, or empty
  box,      // two corners, the second above the first: "X0,Y0,Z0,X1,Y1,Z1", or empty
  text,
};

// The description of an option.
struct Option {
  std::string_view name;  // "overlap" stands for --overlap
  OptionType type = OptionType::text;
  std::string_view default_value;
  std::string_view help;
  std::string_view unit = {};  // "N", "PIXELS", "DEGREES"
  double min = std::numeric_limits<double>::lowest(), max = std::numeric_limits<double>::max();
  std::vector<std::string_view> choices = {};  // numbers too, if only some are allowed
};

// The values of a list of options. Copies the values but refers to the options, which must outlive
// it.
class OptionValues {
 public:
  OptionValues() = default;
  // All options at their defaults.
  explicit OptionValues(std::span<const Option> options);

  // Sets a value. The error names the option and says which values it takes. Requires an option of
  // that name.
  Result<> set(std::string_view name, std::string_view value);

  // Was the value set, as opposed to left at its default?
  [[nodiscard]] bool given(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;
  // Fails if one of `names` was given. The error names it as the command line has it.
  [[nodiscard]] Result<> expect_none_of(std::initializer_list<std::string_view> names,
                                        const std::string& reason) const;

  // The value by type. Requires an option of that name and type; a choice is text, or a number if
  // all its choices are.
  [[nodiscard]] bool flag(std::string_view name) const;
  [[nodiscard]] int integer(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::string_view name) const;
  // The coordinates of a point, of points or of a box; empty if the value is.
  [[nodiscard]] std::vector<double> numbers(std::string_view name) const;

  [[nodiscard]] std::span<const Option> options() const { return options_; }

 private:
  struct Value {
    std::string text;
    bool given = false;
  };
  [[nodiscard]] std::size_t index_of(std::string_view name) const;

  std::span<const Option> options_;
  std::vector<Value> values_;
};

// "--NAME takes a number from A to B", for errors and help; empty for a text.
[[nodiscard]] std::string expected_text(const Option& option);

}  // namespace rilievo
