#include "rilievo/kind/bounds_facts.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "rilievo/core/place_text.h"

namespace rilievo {

std::vector<Fact> bounds_facts(const Box& bounds, const WorldSpace& world) {
  const double size = double(bounds.radius());
  const glm::dvec3 low = world.origin + glm::dvec3(bounds.min),
                   high = world.origin + glm::dvec3(bounds.max);
  const auto list = [](const glm::dvec3& v) { return nlohmann::json{v.x, v.y, v.z}.dump(); };
  return {{"bounds_min", list(low), "bounds",
           fmt::format("{} to {} m", place_text(low, size), place_text(high, size))},
          {"bounds_max", list(high), "", ""}};
}

}  // namespace rilievo
