// STL, binary or text: triangles without anything else; a text may hold several solids, and each is
// an Object. Facet normals are left out, for they say nothing that the corners do not, and are
// often wrong.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/polygon_read.h"

namespace rilievo {
namespace {

void add_triangle(PolygonSoup& soup, std::span<const glm::dvec3> loop, std::uint32_t part,
                  MemoryBudget& budget) {
  std::vector<Corner> corners;
  for (const glm::dvec3& p : loop) {
    budget.take(sizeof(glm::dvec3));
    corners.push_back({std::uint32_t(soup.positions.size())});
    soup.positions.push_back(p);
  }
  if (corner_that_is_not_finite(soup, corners)) refuse("has a vertex whose position is not finite");
  add_polygon(soup, corners, part, budget);
}

// A binary file is 80 bytes of anything, a count, then for each triangle its normal, three corners
// and two bytes.
constexpr std::size_t kHead = 84, kTriangle = 50;

std::uint32_t announced(Bytes file) {
  std::uint32_t count = 0;
  std::memcpy(&count, file.data() + 80, 4);
  return count;
}

void read_binary(Bytes file, std::size_t count, PolygonSoup& soup, MemoryBudget& budget) {
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 p[3];
    std::memcpy(p, file.data() + kHead + kTriangle * i + 12, sizeof p);
    const glm::dvec3 loop[] = {p[0], p[1], p[2]};
    add_triangle(soup, loop, 0, budget);
  }
}

// No text has these, but the numbers of a binary file soon do.
bool has_zeros(Bytes file) {
  constexpr std::size_t kLooked = 1024;
  const Bytes head = file.first(std::min(file.size(), kLooked));
  return std::find(head.begin(), head.end(), 0) != head.end();
}

// A binary file whose count does not fit its length: how many triangles are read.
std::size_t count_of_odd_binary(Bytes file, LoadContext& context) {
  if (file.size() < kHead)
    refuse("is a binary STL file that is cut short: it has " + std::to_string(file.size()) +
           " bytes, and its head alone takes " + std::to_string(kHead));
  const std::size_t there = (file.size() - kHead) / kTriangle;
  const std::uint32_t count = announced(file);
  if (count > 0)
    refuse("is a binary STL file that is cut short, or none: it announces " +
           std::to_string(count) + " triangles, but has bytes for " + std::to_string(there));
  // Whoever writes before counting leaves the zero.
  if (there == 0 || (file.size() - kHead) % kTriangle != 0)
    refuse("is a binary STL file that announces no triangles, and its " +
           std::to_string(file.size()) + " bytes are no whole number of them");
  context.warn("announces no triangles, but has bytes for " + std::to_string(there) +
               ", which are read");
  return there;
}

// The solids of a text, each a part.
class Solids {
 public:
  explicit Solids(LoadContext& context) : context_(context) {}

  void begin(std::string_view name) {
    name_ = name;
    open_ = false;
  }
  // The part of the solid that was begun last.
  std::uint32_t part() {
    if (!open_) {
      open_ = true;
      context_.budget.take(2 * sizeof(SoupPart) + 2 * name_.size() + 256);
      parts_.push_back({name_, -1});
    }
    return std::uint32_t(parts_.size() - 1);
  }
  // Each with a name of its own: bodies stay apart even if they are called the same.
  std::vector<SoupPart> take() {
    if (parts_.size() == 1 && parts_[0].object.empty()) parts_[0].object = context_.name;
    std::set<std::string> names;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      std::string& name = parts_[i].object;
      if (name.empty()) name = "solid";
      if (!names.insert(name).second) names.insert(name += " #" + std::to_string(i + 1));
    }
    return std::move(parts_);
  }

 private:
  LoadContext& context_;
  std::string name_;
  bool open_ = false;
  std::vector<SoupPart> parts_;
};

std::string_view take_rest_of_line(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  const std::string_view rest = trimmed(text.substr(0, end));
  text.remove_prefix(end);
  return rest;
}

std::vector<SoupPart> read_text(std::string_view text, PolygonSoup& soup, LoadContext& context) {
  const std::string_view whole = text;
  Solids solids(context);
  std::vector<glm::dvec3> loop;
  std::size_t facets = 0;
  // Some writers use capitals throughout.
  for (std::string word = lower_case(take_word(text)); !word.empty();
       word = lower_case(take_word(text))) {
    if (word == "solid") {
      solids.begin(take_rest_of_line(text));  // the name, which may be anything
    } else if (word == "endsolid") {
      (void)take_rest_of_line(text);
      solids.begin({});
    } else if (word == "vertex") {
      glm::dvec3 p;
      for (int c = 0; c < 3; ++c) {
        const std::string_view digits = take_word(text);
        const std::optional<double> number = number_of(digits);
        if (!number) refuse(line_name(whole, digits.data()) + " " + no_number(digits));
        p[c] = *number;
      }
      context.budget.borrow(loop.size(), sizeof(glm::dvec3));
      loop.push_back(p);
    } else if (word == "endloop") {
      add_triangle(soup, loop, solids.part(), context.budget);
      loop.clear();
      ++facets;
    }
  }
  if (!loop.empty())
    refuse("is an STL file that is cut short: it ends within a facet, after " +
           std::to_string(facets) + " whole ones");
  if (facets == 0) refuse("is an STL file without facets");
  return solids.take();
}

}  // namespace

bool is_binary_stl(Bytes file) {
  if (file.size() < kHead) return false;
  // Some writers leave bytes behind the triangles; a text never has as many as its 80th byte says.
  const std::uint32_t count = announced(file);
  return kHead + kTriangle * std::uint64_t(count) <= file.size() && count > 0;
}

Scene read_stl(Bytes file, LoadContext& context) {
  PolygonSoup soup;
  std::vector<SoupPart> parts{{context.name, -1}};
  std::string converted;
  const std::string_view text = utf8_from(file, converted);
  if (is_binary_stl(file)) {
    read_binary(file, announced(file), soup, context.budget);
  } else if (lower_case(trimmed(text.substr(0, 4096)).substr(0, 5)) == "solid" &&
             !(converted.empty() && has_zeros(file))) {
    parts = read_text(text, soup, context);
  } else if (has_zeros(file)) {
    read_binary(file, count_of_odd_binary(file, context), soup, context.budget);
  } else {
    refuse("is not an STL file: it neither begins with 'solid' nor has the length it announces");
  }
  return scene_of(std::move(soup), parts, {}, context);
}

}  // namespace rilievo
