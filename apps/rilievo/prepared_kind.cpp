#include "apps/rilievo/prepared_kind.h"

#include <utility>

namespace rilievo::app {

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

ObjectDrawablesOptions object_options(const PreparedKind& kind, std::size_t max_bytes,
                                      Progress& progress) {
  ObjectDrawablesOptions objects{kind.bake, kind.draw};
  objects.max_bytes = max_bytes;
  objects.progress = [&](int done, int total) { progress.show(done, total); };
  return objects;
}

}  // namespace rilievo::app
