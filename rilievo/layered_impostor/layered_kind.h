// How is the layered impostor a kind of representation? Its row in the list of kinds.
#pragma once

#include "rilievo/kind/kind.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The name of the kind.
inline constexpr std::string_view kLayeredImpostorName = "layered-impostor";

// A layered impostor as a Representation.
struct LayeredRepresentation final : Representation {
  explicit LayeredRepresentation(LayeredImpostor made) : impostor(std::move(made)) {}
  [[nodiscard]] Box bounds() const override { return impostor.bounds; }
  [[nodiscard]] Vantage vantage() const override { return impostor.vantage; }
  [[nodiscard]] std::size_t bytes() const override;
  [[nodiscard]] std::uint32_t only_object() const override;

  LayeredImpostor impostor;
};

// Typed options from the values of the row's bake_options and draw_options.
[[nodiscard]] BakeOptions layered_bake_options(const OptionValues& values);
[[nodiscard]] LayeredOptions layered_draw_options(const OptionValues& values);

// The row.
[[nodiscard]] const Kind& layered_impostor_kind();

}  // namespace rilievo
