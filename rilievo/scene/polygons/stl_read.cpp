// STL, binary or text: triangles without anything else. Facet normals are left out, for they say
// nothing that the corners do not, and are often wrong.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/polygon_read.h"

namespace rilievo {
namespace {

void add_triangle(PolygonSoup& soup, std::span<const glm::vec3> loop, MemoryBudget& budget) {
  std::vector<Corner> corners;
  for (const glm::vec3& p : loop) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      refuse("has a vertex whose position is not finite");
    budget.take(sizeof(glm::vec3));
    corners.push_back({std::uint32_t(soup.positions.size())});
    soup.positions.push_back(p);
  }
  add_polygon(soup, corners, 0, budget);
}

// 80 bytes of anything, a count, then for each triangle its normal, three corners and two bytes.
void read_binary(Bytes file, PolygonSoup& soup, MemoryBudget& budget) {
  std::uint32_t count = 0;
  std::memcpy(&count, file.data() + 80, 4);
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 p[3];
    std::memcpy(p, file.data() + 84 + 50 * i + 12, sizeof p);
    add_triangle(soup, p, budget);
  }
}

void read_text(std::string_view text, PolygonSoup& soup, MemoryBudget& budget) {
  const std::string_view whole = text;
  std::vector<glm::vec3> loop;
  bool facets = false;
  // Some writers use capitals throughout.
  for (std::string word = lower_case(take_word(text)); !word.empty();
       word = lower_case(take_word(text))) {
    if (word == "solid") {
      // The name, which may be anything.
      text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
    } else if (word == "vertex") {
      glm::vec3 p;
      for (int c = 0; c < 3; ++c) {
        const std::string_view digits = take_word(text);
        const std::optional<double> number = number_of(digits);
        if (!number) refuse(line_name(whole, digits.data()) + " " + no_number(digits));
        p[c] = float(*number);
      }
      budget.borrow(loop.size(), sizeof(glm::vec3));
      loop.push_back(p);
    } else if (word == "endloop") {
      add_triangle(soup, loop, budget);
      loop.clear();
      facets = true;
    }
  }
  if (!facets) refuse("is an STL file without facets");
}

}  // namespace

bool is_binary_stl(Bytes file) {
  if (file.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, file.data() + 80, 4);
  // Some writers leave bytes behind the triangles; a text never has as many as its 80th byte says.
  return 84 + 50 * std::uint64_t(count) <= file.size() && count > 0;
}

Scene read_stl(Bytes file, LoadContext& context) {
  PolygonSoup soup;
  if (is_binary_stl(file)) {
    read_binary(file, soup, context.budget);
  } else {
    std::string converted;
    const std::string_view text = utf8_from(file, converted);
    if (lower_case(trimmed(text).substr(0, 5)) != "solid")
      refuse("is not an STL file: it neither begins with 'solid' nor has the length it announces");
    read_text(text, soup, context.budget);
  }
  return scene_of(std::move(soup), {{context.name, -1}}, {}, context);
}

}  // namespace rilievo
