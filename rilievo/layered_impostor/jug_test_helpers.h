// The jug of the test shapes as a layered impostor.
#pragma once

#include <utility>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo::test_shapes {

inline LayeredImpostor jug_impostor(int size, const SliceOptions& options = {},
                                    Projection kind = Projection::back_perspective) {
  Result<LayeredImpostor> impostor = make_layered_impostor(
      cast_views(jug(), make_view_set({}), {.projection = kind, .size = size}), options);
  return std::move(*impostor);
}

}  // namespace rilievo::test_shapes
