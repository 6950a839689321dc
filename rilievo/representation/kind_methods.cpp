#include "rilievo/representation/kind_methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "rilievo/representation/kinds.h"

namespace rilievo {
namespace {

Result<OptionValues> values_of(const Kind& kind, KindOptionsOf which, const GivenOptions& given) {
  OptionValues values(options_of(kind, which));
  const std::string own = given_name(kind, "");
  // Those of this kind alone come last: they win.
  for (const bool last : {false, true})
    for (const auto& [name, value] : given) {
      if (name.starts_with(own) != last) continue;
      const std::string_view option = std::string_view(name).substr(last ? own.size() : 0);
      if (!values.has(option)) continue;
      if (Result<> set = values.set(option, value); !set) return set.error();
    }
  return values;
}

}  // namespace

std::string given_name(const Kind& kind, std::string_view option) {
  return fmt::format("{}.{}", kind.name, option);
}

std::span<const Option> options_of(const Kind& kind, KindOptionsOf which) {
  return which == KindOptionsOf::bake ? kind.bake_options : kind.draw_options;
}

GivenOptions& given_of(KindOptions& options, KindOptionsOf which) {
  return which == KindOptionsOf::bake ? options.bake : options.draw;
}

const Option* find_option(std::span<const Option> options, std::string_view name) {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == name; });
  return found == options.end() ? nullptr : &*found;
}

Result<OptionValues> bake_values(const Kind& kind, const KindOptions& options) {
  Result<OptionValues> values = values_of(kind, KindOptionsOf::bake, options.bake);
  if (!values || !kind.check_options) return values;
  if (Result<> good = kind.check_options(*values); !good) return good.error();
  return values;
}

Result<OptionValues> draw_values(const Kind& kind, const KindOptions& options) {
  return values_of(kind, KindOptionsOf::draw, options.draw);
}

Result<> expect_options_of(const Kind& kind, const KindOptions& options) {
  for (const KindOptionsOf which : {KindOptionsOf::bake, KindOptionsOf::draw})
    for (const auto& [name, value] : (which == KindOptionsOf::bake ? options.bake : options.draw))
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
      given_of(options, which)[given_name(*method.kind, name)] = method.variant->value;
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

Result<PreparedKind> prepare(const KindMethod& method, const KindOptions& options,
                             std::span<const DrawableRow> rows) {
  KindOptions values = options;
  apply(method, values);
  Result<OptionValues> bake = bake_values(*method.kind, values);
  if (!bake) return bake.error();
  Result<OptionValues> draw = draw_values(*method.kind, values);
  if (!draw) return draw.error();
  Result<std::unique_ptr<DrawableFactory>> factory = make_factory(rows, method.kind->name);
  if (!factory) return factory.error();
  return PreparedKind{std::move(*bake), std::move(*draw), std::move(*factory)};
}

}  // namespace rilievo
