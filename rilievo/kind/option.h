// Which options does a kind of representation take, and which values were given?
//
// An option is described once: the command line, the viewer's panel and `rilievo info` are made
// from the description. Values travel as text, as on a command line, and are checked when they are
// set.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/core/result.h"

namespace rilievo {

enum class OptionType {
  flag,     // "on" or "off"
  integer,  // within [least, most]
  number,   // within [least, most], finite
  choice,   // one of `choices`
  point,    // three finite numbers "X,Y,Z", or empty
  points,   // some such, with spaces between them, or empty
  box,      // two corners, the second above the first: "X0,Y0,Z0,X1,Y1,Z1", or empty
  text,
};

struct Option {
  std::string_view name;  // "overlap" is --overlap
  OptionType type = OptionType::text;
  std::string_view default_value;
  std::string_view help;
  std::string_view unit = {};  // "N", "PIXELS", "DEGREES"
  double least = std::numeric_limits<double>::lowest(), most = std::numeric_limits<double>::max();
  std::vector<std::string_view> choices = {};  // numbers too, where only some are possible
};

// The values of a list of options. Copies the values, refers to the options: they must outlive it.
class OptionValues {
 public:
  OptionValues() = default;
  // Their defaults.
  explicit OptionValues(std::span<const Option> options);

  // The error names the option and says what it takes. There must be an option of that name.
  Result<> set(std::string_view name, std::string_view value);

  // Was the value set, rather than left at its default?
  [[nodiscard]] bool given(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;

  // Each requires an option of that name and type; a choice is text, and may be read as a number.
  [[nodiscard]] bool flag(std::string_view name) const;
  [[nodiscard]] int integer(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::string_view name) const;
  // A point, points or a box, one number after the other; nothing if it is empty.
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

// "--NAME takes a number from A to B", for the error and for the help. Nothing for text.
[[nodiscard]] std::string expected_text(const Option& option);

}  // namespace rilievo
