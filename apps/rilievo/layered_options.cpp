#include "apps/rilievo/layered_options.h"

#include <fmt/format.h>

#include "apps/rilievo/checks.h"

namespace rilievo::app {

void add_layered_options(CLI::App& command, LayeredBakeOptions& options,
                         const std::string& size_name) {
  auto* views = command
                    .add_option("--views", options.views,
                                "Views of a layered impostor: faces of a dodecahedron, corners, or "
                                "both (default 32)")
                    ->check(CLI::IsMember({12, 20, 32}));
  auto* hemisphere =
      command.add_flag("--hemisphere", options.hemisphere, "Only views at or above the horizon");
  command
      .add_option("--ring", options.ring, "Instead: N views around the vertical, at the horizon")
      ->check(in_range(3, 1024))
      ->excludes(views)
      ->excludes(hemisphere)
      ->type_name("N");
  command.add_option(size_name, options.size, "Texels a side of a view (default 256)")
      ->check(in_range(8, 4096))
      ->type_name("N");
  command.add_option("--layers", options.layers, "Slices of a view (default 64)")
      ->check(in_range(1, 4096))
      ->type_name("N");
  command
      .add_option("--overlap", options.overlap,
                  "By how much of its thickness a slice reaches into its neighbours (default 0)")
      ->check(in_range(0.0, 4096.0))
      ->type_name("X");
}

Result<BakeOptions> bake_options(const LayeredBakeOptions& options) {
  if (!(options.overlap <= float(options.layers)))
    return Error{"--overlap", fmt::format("{} is more than all of the {} layers", options.overlap,
                                          options.layers)};
  BakeOptions bake;
  bake.views.spread = options.ring          ? ViewSpread::ring
                      : options.views == 12 ? ViewSpread::faces_12
                      : options.views == 20 ? ViewSpread::vertices_20
                                            : ViewSpread::both_32;
  bake.views.hemisphere = options.hemisphere;
  if (options.ring) bake.views.ring = options.ring;
  bake.camera.size = options.size;
  bake.slicing.layers = options.layers;
  bake.slicing.overlap = options.overlap;
  return bake;
}

}  // namespace rilievo::app
