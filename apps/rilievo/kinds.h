// Which options do the kinds of representation have? They are made from the list of kinds.
//
// Kinds can share an option's name; it is added to a command once. Where a command has an option of
// that name itself, the kinds' option is called --view-NAME.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/kind/kind.h"

namespace rilievo::app {

// By Option::name, of all kinds that have it.
using GivenOptions = std::map<std::string, std::string, std::less<>>;

// What was given on the command line, or set in the panel. An option for baking and one for drawing
// can have the same name.
struct KindOptions {
  GivenOptions bake, draw;
};

enum class KindOptionsOf { bake, draw };

void add_kind_options(CLI::App& command, KindOptionsOf which, KindOptions& options);

// The values for one kind; options that it does not have are ignored. The error names the option as
// the command line has it.
[[nodiscard]] Result<OptionValues> bake_values(const Kind& kind, const KindOptions& options);
[[nodiscard]] Result<OptionValues> draw_values(const Kind& kind, const KindOptions& options);

// The error names an option that was given and that the kind has not.
[[nodiscard]] Result<> expect_options_of(const Kind& kind, const KindOptions& options);

// A name of --method: of a kind, or of a kind drawn in one of its ways.
struct KindMethod {
  const Kind* kind = nullptr;
  const Variant* variant = nullptr;  // null: the kind's own name
};
// Null kind if no kind has a method of that name.
[[nodiscard]] KindMethod kind_method(std::string_view name);
// Sets what the variant says.
void apply(const KindMethod& method, KindOptions& options);

[[nodiscard]] std::vector<std::string> kind_names();
// The kind that is baked unless another one is named: the first of the list.
[[nodiscard]] const Kind& default_kind();
// Of all kinds, or of one: its name first, former names left out.
[[nodiscard]] std::vector<std::string> kind_method_names();
[[nodiscard]] std::vector<std::string> kind_method_names(const Kind& kind);

}  // namespace rilievo::app
