#include "rilievo/representation/drawable_rows.h"

#include <algorithm>
#include <string>

namespace rilievo {

Result<std::unique_ptr<DrawableFactory>> make_factory(std::span<const DrawableRow> rows,
                                                      std::string_view kind) {
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const DrawableRow& r) { return r.kind == kind; });
  if (row == rows.end()) return Error{std::string(kind), "is drawn by OpenGL only"};
  return row->make_factory();
}

}  // namespace rilievo
