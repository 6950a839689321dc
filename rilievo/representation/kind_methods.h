// The names under which kinds are drawn, and the options that are given for them as text.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/kind/kind.h"
#include "rilievo/representation/drawable_rows.h"

namespace rilievo {

// By Option::name, for all kinds that have it; or by given_name(), for one kind, which wins.
using GivenOptions = std::map<std::string, std::string, std::less<>>;

// The options given for kinds. An option for baking and one for drawing can have the same name.
struct KindOptions {
  GivenOptions bake, draw;
};

// The name under which an option is given for one kind: "layered-impostor.views".
[[nodiscard]] std::string given_name(const Kind& kind, std::string_view option);

// Which of a kind's options.
enum class KindOptionsOf { bake, draw };

// A kind's options for baking or for drawing.
[[nodiscard]] std::span<const Option> options_of(const Kind& kind, KindOptionsOf which);
// Those given.
[[nodiscard]] GivenOptions& given_of(KindOptions& options, KindOptionsOf which);
// The option of that name; null: there is none.
[[nodiscard]] const Option* find_option(std::span<const Option> options, std::string_view name);

// The values for one kind; options that it does not have are ignored. The error names the option as
// the command line has it.
[[nodiscard]] Result<OptionValues> bake_values(const Kind& kind, const KindOptions& options);
[[nodiscard]] Result<OptionValues> draw_values(const Kind& kind, const KindOptions& options);

// The error names an option that was given and that the kind has not.
[[nodiscard]] Result<> expect_options_of(const Kind& kind, const KindOptions& options);

// A name under which a kind is drawn: its own, or that of one of its ways.
struct KindMethod {
  const Kind* kind = nullptr;
  const Variant* variant = nullptr;  // null: the kind's own name
};
// Null kind if no kind has a method of that name.
[[nodiscard]] KindMethod kind_method(std::string_view name);
// Sets what the variant says.
void apply(const KindMethod& method, KindOptions& options);

// The names of all kinds.
[[nodiscard]] std::vector<std::string> kind_names();
// The kind that is baked unless another one is named: the first of the list.
[[nodiscard]] const Kind& default_kind();
// The methods of all kinds, or of one: its name first, former names left out.
[[nodiscard]] std::vector<std::string> kind_method_names();
[[nodiscard]] std::vector<std::string> kind_method_names(const Kind& kind);

// A kind with its options for baking and drawing, and its factory.
struct PreparedKind {
  OptionValues bake, draw;
  std::unique_ptr<DrawableFactory> factory;
};
// `rows` are a backend's factories. The error names the option.
[[nodiscard]] Result<PreparedKind> prepare(const KindMethod& method, const KindOptions& options,
                                           std::span<const DrawableRow> rows);

}  // namespace rilievo
