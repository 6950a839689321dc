// PLY, text or binary of either byte order: polygons, and Stanford's triangle strips, with normals,
// texture coordinates and colours at their vertices. Unknown elements and properties are passed
// over.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "rilievo/io/color_io.h"
#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/polygon_read.h"

namespace rilievo {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr TypeName kTypes[] = {
    {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
    {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
    {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
    {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
    {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
    {"float64", Type::float64}};

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> length;  // a list, with this type of its length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Format { text, little, big } format = Format::text;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes
};

Type type_of(std::string_view name) {
  for (const TypeName& t : kTypes)
    if (t.name == name) return t.type;
  refuse("is a PLY file with a property of the unknown type '" + std::string(name.substr(0, 20)) +
         "'");
}

Header read_header(std::string_view text) {
  const std::size_t whole = text.size();
  Header header;
  bool known = false;
  for (std::optional<std::string_view> line = take_line(text); line; line = take_line(text)) {
    std::string_view rest = *line;
    const std::string_view word = take_word(rest);
    if (word == "format") {
      const std::string_view format = take_word(rest);
      known =
          format == "ascii" || format == "binary_little_endian" || format == "binary_big_endian";
      if (format == "binary_little_endian") header.format = Header::Format::little;
      if (format == "binary_big_endian") header.format = Header::Format::big;
    } else if (word == "element") {
      Element element;
      element.name = take_word(rest);
      const std::optional<std::int64_t> count = whole_number_of(take_word(rest));
      // Every element has at least one byte.
      if (!count || *count < 0 || std::uint64_t(*count) > whole)
        refuse("is a PLY file that announces more elements than it can hold");
      element.count = std::uint64_t(*count);
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) refuse("is a PLY file with a property of no element");
      Property property;
      std::string_view type = take_word(rest);
      if (type == "list") {
        property.length = type_of(take_word(rest));
        type = take_word(rest);
      }
      property.type = type_of(type);
      property.name = take_word(rest);
      header.elements.back().properties.push_back(std::move(property));
    } else if (word == "end_header") {
      if (!known) refuse("is a PLY file of an unknown format");
      header.size = whole - text.size();
      // Without properties there is nothing to read, however many are announced.
      for (Element& element : header.elements)
        if (element.properties.empty()) element.count = 0;
      return header;
    }
  }
  refuse("is a PLY file whose header has no end");
}

// The values behind the header, one after the other.
class Values {
 public:
  Values(Bytes file, const Header& header)
      : format_(header.format),
        left_(file.subspan(header.size)),
        whole_(reinterpret_cast<const char*>(file.data()), file.size()),
        text_(whole_.substr(header.size)) {}

  double next(Type type) {
    if (format_ == Header::Format::text) {
      const std::string_view word = take_word(text_);
      const std::optional<double> number = number_of(word);
      if (!number && word.empty()) refuse("is a PLY file that is cut short");
      if (!number) refuse(line_name(whole_, word.data()) + " " + no_number(word));
      return *number;
    }
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::float32:
        return take<float>();
      case Type::float64:
        return take<double>();
    }
    return 0;
  }

 private:
  template <class T>
  T take() {
    if (left_.size() < sizeof(T)) refuse("is a PLY file that is cut short");
    std::array<std::uint8_t, sizeof(T)> bytes;
    std::copy_n(left_.begin(), sizeof(T), bytes.begin());
    left_ = left_.subspan(sizeof(T));
    if (format_ == Header::Format::big) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  Header::Format format_;
  Bytes left_;
  std::string_view whole_, text_;  // of a text: the file, and what is left
};

// How many values of a property follow.
std::uint64_t length_of(const Property& property, Values& values) {
  const double length = property.length ? values.next(*property.length) : 1.0;
  if (!(length >= 0 && length <= 4294967295.0)) refuse("has a list of impossible length");
  return std::uint64_t(length);
}

// Which number of a vertex a property is; -1: none that is used.
enum Slot { px, py, pz, nx, ny, nz, tu, tv, red, green, blue, alpha, kSlots };

int slot_of(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Slot>, 24> kNames = {
      {{"x", px},
       {"y", py},
       {"z", pz},
       {"nx", nx},
       {"ny", ny},
       {"nz", nz},
       {"u", tu},
       {"v", tv},
       {"s", tu},
       {"t", tv},
       {"texture_u", tu},
       {"texture_v", tv},
       {"red", red},
       {"green", green},
       {"blue", blue},
       {"alpha", alpha},
       {"r", red},
       {"g", green},
       {"b", blue},
       {"a", alpha},
       {"diffuse_red", red},
       {"diffuse_green", green},
       {"diffuse_blue", blue},
       {"diffuse_alpha", alpha}}};
  for (const auto& [known, slot] : kNames)
    if (known == name) return slot;
  return -1;
}

// Integer colours stand for [0, 1].
double color_scale(Type type) {
  return type == Type::uint8 ? 1 / 255.0 : type == Type::uint16 ? 1 / 65535.0 : 1.0;
}

void read_vertices(const Element& element, Values& values, PolygonSoup& soup,
                   MemoryBudget& budget) {
  std::array<bool, kSlots> has{};
  std::vector<int> slots;
  for (const Property& p : element.properties) {
    slots.push_back(p.length ? -1 : slot_of(p.name));
    if (slots.back() >= 0) has[slots.back()] = true;
  }
  if (!has[px] || !has[py] || !has[pz]) refuse("is a PLY file whose vertices have no x, y and z");
  const bool normals = has[nx] && has[ny] && has[nz], uv = has[tu] && has[tv];
  const bool colors = has[red] && has[green] && has[blue];
  budget.take(element.count, 12 + (normals ? 12 : 0) + (uv ? 8 : 0) + (colors ? 16 : 0));
  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::array<double, kSlots> v{};
    v[alpha] = 1.0;
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const Property& p = element.properties[k];
      for (std::uint64_t left = length_of(p, values); left > 0; --left) {
        const double number = values.next(p.type);
        if (slots[k] >= 0) v[slots[k]] = slots[k] >= red ? number * color_scale(p.type) : number;
      }
    }
    const glm::vec3 position(v[px], v[py], v[pz]);
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z))
      refuse("has a vertex whose position is not finite");
    soup.positions.push_back(position);
    if (normals) soup.normals.push_back(glm::vec3(v[nx], v[ny], v[nz]));
    // v grows upwards there, downwards here.
    if (uv) soup.uv.push_back(glm::vec2(v[tu], 1.0 - v[tv]));
    if (colors) soup.colors.push_back(linear_from_screen({v[red], v[green], v[blue], v[alpha]}));
  }
}

// Does the property list the vertices of a face?
bool lists_vertices(const Property& p) {
  return p.length && (p.name == "vertex_indices" || p.name == "vertex_index");
}

Corner corner_of(double vertex, const PolygonSoup& soup) {
  if (!(vertex >= 0 && vertex < double(soup.positions.size())))
    refuse("has a face that refers to a vertex that does not exist");
  const std::uint32_t at = std::uint32_t(vertex);
  return {at, soup.uv.empty() ? Corner::kNone : at, soup.normals.empty() ? Corner::kNone : at};
}

void read_faces(const Element& element, Values& values, PolygonSoup& soup, MemoryBudget& budget) {
  std::vector<Corner> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& p : element.properties) {
      polygon.clear();
      for (std::uint64_t left = length_of(p, values); left > 0; --left) {
        const double vertex = values.next(p.type);
        if (!lists_vertices(p)) continue;
        budget.borrow(polygon.size(), 8 * sizeof(Corner));
        polygon.push_back(corner_of(vertex, soup));
      }
      if (lists_vertices(p)) add_polygon(soup, polygon, 0, budget);
    }
}

// All strips are one list, where -1 ends a strip. Each vertex makes a triangle with the two before
// it; every second one runs the other way round.
void read_strips(const Element& element, Values& values, PolygonSoup& soup, MemoryBudget& budget) {
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& p : element.properties) {
      std::array<Corner, 3> last;  // of the strip, the newest behind
      std::uint64_t in_strip = 0;
      for (std::uint64_t left = length_of(p, values); left > 0; --left) {
        const double vertex = values.next(p.type);
        if (!lists_vertices(p)) continue;
        if (vertex == -1) {
          in_strip = 0;
          continue;
        }
        last = {last[1], last[2], corner_of(vertex, soup)};
        if (++in_strip < 3) continue;
        std::array<Corner, 3> triangle = last;
        if (in_strip % 2 == 0) std::swap(triangle[0], triangle[1]);
        add_polygon(soup, triangle, 0, budget);
      }
    }
}

void pass_over(const Element& element, Values& values) {
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& p : element.properties)
      for (std::uint64_t left = length_of(p, values); left > 0; --left) (void)values.next(p.type);
}

}  // namespace

Scene read_ply(Bytes file, LoadContext& context) {
  const Header header = read_header({reinterpret_cast<const char*>(file.data()), file.size()});
  Values values(file, header);
  PolygonSoup soup;
  for (const Element& element : header.elements) {
    if (element.name == "vertex" && soup.positions.empty()) {
      read_vertices(element, values, soup, context.budget);
    } else if (element.name == "face") {
      read_faces(element, values, soup, context.budget);
    } else if (element.name == "tristrips") {
      read_strips(element, values, soup, context.budget);
    } else {
      pass_over(element, values);
    }
  }
  if (soup.triangles.empty()) context.skip_points_or_lines();
  return scene_of(std::move(soup), {{context.name, -1}}, {}, context);
}

}  // namespace rilievo
