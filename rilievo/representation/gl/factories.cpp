#include "rilievo/representation/gl/factories.h"

#include <array>

#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/gl/node_textures.h"
#include "rilievo/layered_impostor/gl/layered_drawable.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_relief/relief_drawable.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/nailboard/gl/atlas_boards.h"

namespace rilievo {
namespace {

Result<std::unique_ptr<DrawableFactory>> make_relief_drawable_factory() {
  Result<std::unique_ptr<AtlasBoards>> boards = AtlasBoards::create();
  if (!boards) return boards.error();
  return {make_relief_factory(std::move(*boards))};
}

}  // namespace

std::span<const DrawableRow> drawable_rows() {
  static constexpr std::array rows{
      DrawableRow{kLayeredImpostorName, make_layered_drawable_factory},
      DrawableRow{kEnvironmentNodesName, make_environment_drawable_factory},
      DrawableRow{kLayeredReliefName, make_relief_drawable_factory},
  };
  return rows;
}

}  // namespace rilievo
