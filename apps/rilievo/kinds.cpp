#include "apps/rilievo/kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/rilievo/output.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

std::string help_text(const Option& option) {
  std::string help(option.help);
  if (option.type == OptionType::choice)
    help += fmt::format(": {}", fmt::join(option.choices, ", "));
  if (option.type != OptionType::flag && !option.default_value.empty())
    help += fmt::format(" (default {})", option.default_value);
  return help;
}

std::string help_of(const Option& option, const std::vector<std::string>& kinds) {
  return fmt::format("{}: {}", fmt::join(kinds, ", "), help_text(option));
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
      const std::string flag = "--" + name;
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

namespace {

// What --set takes, apart.
struct Setting {
  const Kind* kind = nullptr;
  KindOptionsOf which = KindOptionsOf::bake;
  std::string_view name;
  std::string value;
};

Result<Setting> parse_setting(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::string name = text.substr(0, equals);
  const auto refuse = [&](const std::string& reason) { return Error{name, reason}; };
  const std::size_t dot = name.find('.');
  if (dot == name.npos) return refuse("is no KIND.NAME; `rilievo info --kinds` lists them");
  Setting setting;
  setting.kind = kind_method(name.substr(0, dot)).kind;
  if (!setting.kind)
    return refuse(fmt::format("'{}' is none of the kinds: {}", name.substr(0, dot),
                              fmt::join(kind_names(), ", ")));
  const Option* option = nullptr;
  for (const KindOptionsOf which : {KindOptionsOf::draw, KindOptionsOf::bake}) {
    if (option) break;
    setting.which = which;
    option = find_option(options_of(*setting.kind, which), name.substr(dot + 1));
  }
  if (!option)
    return refuse(fmt::format("{} has no such option; `rilievo info --kinds` lists them",
                              setting.kind->name));
  setting.name = option->name;
  const bool flag = option->type == OptionType::flag && equals == text.size();
  setting.value = flag ? "on" : text.substr(std::min(equals + 1, text.size()));
  OptionValues values({option, 1});
  if (setting.value.empty() || !values.set(option->name, setting.value))
    return refuse(fmt::format("'{}' is not {}", setting.value, expected_text(*option)));
  return setting;
}

}  // namespace

void add_set_option(CLI::App& command, KindOptions& options) {
  const auto keep = [&options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      if (const Result<Setting> one = parse_setting(text); one)
        given_of(options, one->which)[given_name(*one->kind, one->name)] = one->value;
  };
  const auto check = [](std::string& text) {
    const Result<Setting> one = parse_setting(text);
    return one ? std::string() : one.error().message();
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--set", keep,
          "An option of a kind of representation, as `rilievo info --kinds` lists them: "
          "layered-impostor.views=12; may be repeated")
      ->allow_extra_args(false)
      ->check(CLI::Validator(check, ""))
      ->type_name("KIND.NAME=VALUE");
}

std::vector<std::string> set_names() {
  std::vector<std::string> names;
  for (const Kind* kind : kinds())
    for (const KindOptionsOf which : {KindOptionsOf::bake, KindOptionsOf::draw})
      for (const Option& option : options_of(*kind, which))
        names.push_back(given_name(*kind, option.name));
  return names;
}

Result<> list_kinds(const std::string& json_file) {
  nlohmann::json json = nlohmann::json::array();
  std::string text;
  for (const Kind* kind : kinds()) {
    text += fmt::format("{}: {}\n", kind->name, kind->summary);
    nlohmann::json options = nlohmann::json::array();
    for (const KindOptionsOf which : {KindOptionsOf::bake, KindOptionsOf::draw})
      for (const Option& option : options_of(*kind, which)) {
        const bool bakes = which == KindOptionsOf::bake;
        text += fmt::format("  {}.{:<18} {}\n", kind->name, option.name, help_text(option));
        options.push_back({{"name", given_name(*kind, option.name)},
                           {"of", bakes ? "bake" : "draw"},
                           {"takes", expected_text(option)},
                           {"default", option.default_value},
                           {"help", option.help}});
      }
    json.push_back({{"kind", kind->name}, {"summary", kind->summary}, {"options", options}});
  }
  if (!json_file.empty()) return write_json(json_file, json);
  fmt::print("{}", text);
  return Done{};
}

}  // namespace rilievo::app
