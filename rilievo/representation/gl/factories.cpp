#include "rilievo/representation/gl/factories.h"

#include <algorithm>
#include <array>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/gl/environment_drawable.h"
#include "rilievo/layered_impostor/gl/layered_drawable.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_relief/gl/relief_drawable.h"
#include "rilievo/layered_relief/relief_kind.h"

namespace rilievo {

std::span<const DrawableRow> drawable_rows() {
  static constexpr std::array rows{
      DrawableRow{kLayeredImpostorName, make_layered_drawable_factory},
      DrawableRow{kEnvironmentNodesName, make_environment_drawable_factory},
      DrawableRow{kLayeredReliefName, make_relief_drawable_factory},
  };
  return rows;
}

Result<std::unique_ptr<DrawableFactory>> make_factory(std::span<const DrawableRow> rows,
                                                      std::string_view kind) {
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const DrawableRow& r) { return r.kind == kind; });
  RILIEVO_EXPECTS(row != rows.end());
  return row->make_factory();
}

}  // namespace rilievo
