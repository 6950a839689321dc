#include "rilievo/representation/software/software_factories.h"

#include <array>

#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_impostor/software/layered_tiles.h"
#include "rilievo/layered_relief/relief_drawable.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/nailboard/software/software_boards.h"

namespace rilievo {
namespace {

Result<std::unique_ptr<DrawableFactory>> make_relief_tiles_factory() {
  return {make_relief_factory(std::make_unique<SoftwareBoards>())};
}

}  // namespace

std::span<const DrawableRow> software_drawable_rows() {
  static constexpr std::array rows{
      DrawableRow{kLayeredImpostorName, make_layered_tiles_factory},
      DrawableRow{kEnvironmentNodesName, make_environment_tiles_factory},
      DrawableRow{kLayeredReliefName, make_relief_tiles_factory},
  };
  return rows;
}

}  // namespace rilievo
