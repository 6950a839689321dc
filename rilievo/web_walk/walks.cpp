#include "rilievo/web_walk/walks.h"

#include <algorithm>
#include <array>
#include <string>

#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/web_walk/node_files.h"
#include "rilievo/web_walk/picture_files.h"
#include "rilievo/web_walk/relief_files.h"

namespace rilievo {
namespace {

using AddToWalk = Result<> (*)(const Representation&, WalkWriter&, WalkManifest&,
                               const WalkOptions&);

struct WalkKind {
  std::string_view name;
  AddToWalk add;
};

const std::array kWalkKinds{
    WalkKind{kEnvironmentNodesName,
             [](const Representation& of, WalkWriter& writer, WalkManifest& manifest,
                const WalkOptions& options) {
               return add_nodes(dynamic_cast<const EnvironmentRepresentation&>(of).nodes, writer,
                                manifest, options);
             }},
    WalkKind{kLayeredImpostorName,
             [](const Representation& of, WalkWriter& writer, WalkManifest& manifest,
                const WalkOptions& options) {
               return add_layered_impostor(dynamic_cast<const LayeredRepresentation&>(of).impostor,
                                           writer, manifest, options);
             }},
    WalkKind{kLayeredReliefName,
             [](const Representation& of, WalkWriter& writer, WalkManifest& manifest,
                const WalkOptions& options) {
               const OptionValues draw(layered_relief_kind().draw_options);
               return add_reliefs(dynamic_cast<const ReliefRepresentation&>(of).pictures,
                                  relief_draw_options(draw), writer, manifest, options);
             }},
};

}  // namespace

std::vector<std::string_view> walk_kinds() {
  std::vector<std::string_view> names;
  for (const WalkKind& kind : kWalkKinds) names.push_back(kind.name);
  return names;
}

Result<> add_to_walk(const Kind& kind, const Representation& representation, WalkWriter& writer,
                     WalkManifest& manifest, const WalkOptions& options) {
  const auto found = std::find_if(kWalkKinds.begin(), kWalkKinds.end(),
                                  [&](const WalkKind& of) { return of.name == kind.name; });
  if (found == kWalkKinds.end()) return Error{std::string(kind.name), "has no form for browsers"};
  return found->add(representation, writer, manifest, options);
}

}  // namespace rilievo
