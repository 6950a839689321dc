// The layered relief as a row of the list of kinds.
#pragma once

#include "rilievo/kind/kind.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/relief_pictures.h"

namespace rilievo {

// Kind::name.
inline constexpr std::string_view kLayeredReliefName = "layered-relief";

// The layered pictures of a bake or of a file.
struct ReliefRepresentation final : Representation {
  explicit ReliefRepresentation(ReliefPictures made) : pictures(std::move(made)) {}
  [[nodiscard]] Box bounds() const override { return pictures.bounds; }
  [[nodiscard]] std::size_t bytes() const override;
  [[nodiscard]] std::uint32_t only_object() const override;
  // Of a deep image: as its own camera looked.
  [[nodiscard]] Vantage vantage() const override;

  ReliefPictures pictures;
};

// From the values of the row's bake_options and draw_options.
[[nodiscard]] ReliefCaptureOptions relief_capture_options(const OptionValues& values);
[[nodiscard]] PrewarpOptions relief_draw_options(const OptionValues& values);

// The row of the list.
[[nodiscard]] const Kind& layered_relief_kind();

}  // namespace rilievo
