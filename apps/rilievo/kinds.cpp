#include "apps/rilievo/kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

std::string help_of(const Option& option, const std::vector<std::string>& kinds) {
  std::string help = fmt::format("{}: {}", fmt::join(kinds, ", "), option.help);
  if (option.type == OptionType::choice)
    help += fmt::format(": {}", fmt::join(option.choices, ", "));
  if (option.type != OptionType::flag && !option.default_value.empty())
    help += fmt::format(" (default {})", option.default_value);
  return help;
}

}  // namespace

void add_kind_options(CLI::App& command, KindOptionsOf which, KindOptions& options) {
  std::set<std::string_view> added;
  for (const Kind* kind : kinds())
    for (const Option& option : options_of(*kind, which)) {
      if (!added.insert(option.name).second) continue;
      std::vector<std::string> having;
      for (const Kind* other : kinds())
        if (find_option(options_of(*other, which), option.name)) having.emplace_back(other->name);
      const std::string name(option.name);
      const bool taken = command.get_option_no_throw("--" + name) != nullptr;
      const std::string flag = (taken ? "--view-" : "--") + name;
      GivenOptions& given = given_of(options, which);
      const auto keep = [&given, name](const std::string& value) { given[name] = value; };
      const std::string help = help_of(option, having);
      if (option.type == OptionType::flag) {
        command.add_flag_callback(
            flag, [keep] { keep("on"); }, help);
        continue;
      }
      // Kinds that share a name may differ in what they accept.
      const auto check = [name, which](const std::string& text) {
        if (text.empty()) return std::string("the value is empty");
        std::string expected;
        for (const Kind* other : kinds()) {
          const Option* one = find_option(options_of(*other, which), name);
          if (!one) continue;
          OptionValues values({one, 1});
          if (values.set(name, text)) return std::string();
          expected = expected_text(*one);
        }
        return fmt::format("'{}' is not {}", text, expected);
      };
      const std::string unit(option.unit.empty() ? "VALUE" : option.unit);
      if (option.type == OptionType::points) {
        const auto keep_all = [keep](const std::vector<std::string>& values) {
          keep(fmt::format("{}", fmt::join(values, " ")));
        };
        command.add_option_function<std::vector<std::string>>(flag, keep_all, help)
            ->check(CLI::Validator([check](std::string& text) { return check(text); }, ""))
            ->type_name(unit);
        continue;
      }
      command.add_option_function<std::string>(flag, keep, help)
          ->check(CLI::Validator([check](std::string& text) { return check(text); }, ""))
          ->type_name(unit);
    }
}

}  // namespace rilievo::app
