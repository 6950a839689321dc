#include "apps/rilievo/kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

std::span<const Option> options_of(const Kind& kind, KindOptionsOf which) {
  return which == KindOptionsOf::bake ? kind.bake_options : kind.draw_options;
}

template <class Options>
auto& given_of(Options& options, KindOptionsOf which) {
  return which == KindOptionsOf::bake ? options.bake : options.draw;
}

const Option* find_option(std::span<const Option> options, std::string_view name) {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == name; });
  return found == options.end() ? nullptr : &*found;
}

std::string help_of(const Option& option, const std::vector<std::string>& kinds) {
  std::string help = fmt::format("{}: {}", fmt::join(kinds, ", "), option.help);
  if (option.type == OptionType::choice)
    help += fmt::format(": {}", fmt::join(option.choices, ", "));
  if (option.type != OptionType::flag && !option.default_value.empty())
    help += fmt::format(" (default {})", option.default_value);
  return help;
}

Result<OptionValues> values_of(std::span<const Option> options, const GivenOptions& given) {
  OptionValues values(options);
  for (const auto& [name, value] : given) {
    if (!values.has(name)) continue;
    if (Result<> set = values.set(name, value); !set) return set.error();
  }
  return values;
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

Result<OptionValues> bake_values(const Kind& kind, const KindOptions& options) {
  Result<OptionValues> values = values_of(kind.bake_options, options.bake);
  if (!values || !kind.check_options) return values;
  if (Result<> good = kind.check_options(*values); !good) return good.error();
  return values;
}

Result<OptionValues> draw_values(const Kind& kind, const KindOptions& options) {
  return values_of(kind.draw_options, options.draw);
}

Result<> expect_options_of(const Kind& kind, const KindOptions& options) {
  for (const KindOptionsOf which : {KindOptionsOf::bake, KindOptionsOf::draw})
    for (const auto& [name, value] : given_of(options, which))
      if (!find_option(options_of(kind, which), name))
        return Error{"--" + name, fmt::format("is no option of {}", kind.name)};
  return Done{};
}

KindMethod kind_method(std::string_view name) {
  for (const Kind* kind : kinds()) {
    if (kind->name == name) return {kind, nullptr};
    for (const Variant& variant : kind->variants)
      if (variant.name == name) return {kind, &variant};
  }
  return {};
}

void apply(const KindMethod& method, KindOptions& options) {
  if (!method.variant || method.variant->option.empty()) return;
  const std::string name(method.variant->option);
  for (const KindOptionsOf which : {KindOptionsOf::bake, KindOptionsOf::draw})
    if (find_option(options_of(*method.kind, which), name))
      given_of(options, which)[name] = method.variant->value;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const Kind* kind : kinds()) names.emplace_back(kind->name);
  return names;
}

const Kind& default_kind() { return *kinds().front(); }

std::vector<std::string> kind_method_names(const Kind& kind) {
  std::vector<std::string> names{std::string(kind.name)};
  for (const Variant& variant : kind.variants)
    if (!variant.option.empty()) names.emplace_back(variant.name);
  return names;
}

std::vector<std::string> kind_method_names() {
  std::vector<std::string> names;
  for (const Kind* kind : kinds())
    for (std::string& name : kind_method_names(*kind)) names.push_back(std::move(name));
  return names;
}

}  // namespace rilievo::app
