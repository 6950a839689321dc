// PLY, text or binary of either byte order: polygons, Stanford's triangle strips, and edges, with
// normals, texture coordinates and colours at their vertices; the vertices alone, if there is
// nothing else. Faces may have coordinates and a picture for
// their corners (texcoord, texnumber) and a colour, which counts where vertices have none, or all
// the same. Elements come in any order. Unknown elements and properties are passed over.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "rilievo/io/color_io.h"
#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/ply_textures.h"
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

Header read_header(std::string_view text, PlyTextures& textures) {
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
    } else if (word == "comment" || word == "obj_info") {
      textures.read_comment(rest);
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
  budget.take(element.count, 24 + (normals ? 12 : 0) + (uv ? 8 : 0) + (colors ? 16 : 0));
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
    // Finite or not: scanners write NaN for what they did not measure, and no face uses it.
    soup.positions.push_back({v[px], v[py], v[pz]});
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

Corner corner_of(double vertex, const PolygonSoup& soup, const char* of = "a face") {
  if (!(vertex >= 0 && vertex < double(soup.positions.size()) && vertex == std::floor(vertex)))
    refuse(std::string("has ") + of + " that refers to a vertex that does not exist");
  const std::uint32_t at = std::uint32_t(vertex);
  return {at, soup.uv.empty() ? Corner::kNone : at, soup.normals.empty() ? Corner::kNone : at};
}

void add_face(PolygonSoup& soup, std::span<const Corner> polygon, std::uint32_t part,
              MemoryBudget& budget) {
  if (const Corner* bad = corner_that_is_not_finite(soup, polygon))
    refuse("has a face with vertex " + std::to_string(bad->position) +
           ", whose position is not finite");
  add_polygon(soup, polygon, part, budget);
}

// What a property of a face is.
enum class Role { none, vertices, coordinates, picture, red, green, blue, alpha };

Role role_of(const Property& p) {
  if (lists_vertices(p)) return Role::vertices;
  if (p.length) {
    for (const char* name : {"texcoord", "texcoords", "tex_coord", "texture_coordinates", "uv"})
      if (p.name == name) return Role::coordinates;
    return Role::none;
  }
  if (p.name == "texnumber" || p.name == "texture_number") return Role::picture;
  const int slot = slot_of(p.name);
  return slot == red     ? Role::red
         : slot == green ? Role::green
         : slot == blue  ? Role::blue
         : slot == alpha ? Role::alpha
                         : Role::none;
}

// Reads faces into a soup, a part for each picture that they show.
class Faces {
 public:
  Faces(PolygonSoup& soup, PlyTextures& textures, LoadContext& context)
      : soup_(soup), textures_(textures), context_(context) {}

  void read(const Element& element, Values& values) {
    std::vector<Role> roles;
    for (const Property& p : element.properties) roles.push_back(role_of(p));
    const auto has = [&](Role role) {
      return std::find(roles.begin(), roles.end(), role) != roles.end();
    };
    const bool colored = has(Role::red) && has(Role::green) && has(Role::blue) && plain_vertices();
    if (colored && soup_.colors.size() < soup_.positions.size()) {
      context_.budget.take(soup_.positions.size(), sizeof(glm::vec4));
      soup_.colors.resize(soup_.positions.size(), glm::vec4(1.0f));
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      double picture = 0;
      glm::vec4 color(0, 0, 0, 1);
      polygon_.clear(), coordinates_.clear();
      for (std::size_t k = 0; k < roles.size(); ++k) {
        const Property& p = element.properties[k];
        for (std::uint64_t left = length_of(p, values); left > 0; --left) {
          const double number = values.next(p.type);
          if (roles[k] == Role::vertices) {
            context_.budget.borrow(polygon_.size(), 8 * sizeof(Corner));
            polygon_.push_back(corner_of(number, soup_));
          } else if (roles[k] == Role::coordinates) {
            context_.budget.borrow(coordinates_.size(), 8 * sizeof(double));
            coordinates_.push_back(number);
          } else if (roles[k] == Role::picture) {
            picture = number;
          } else if (roles[k] >= Role::red) {
            color[int(roles[k]) - int(Role::red)] = float(number * color_scale(p.type));
          }
        }
      }
      if (colored) give_color(color);
      give_coordinates();
      add_face(soup_, polygon_, part_of(picture), context_.budget);
    }
  }

  // The part of what shows a picture, by its number.
  std::uint32_t part_of(double picture) {
    const int material = textures_.empty() ? -1 : textures_.material(picture);
    const auto [known, fresh] = part_index_.try_emplace(material, std::uint32_t(parts_.size()));
    if (fresh) parts_.push_back({context_.name, material, material < 0});
    return known->second;
  }

  // Those of the soup; at least one.
  [[nodiscard]] const std::vector<SoupPart>& parts() {
    if (parts_.empty()) (void)part_of(-1);
    return parts_;
  }

 private:
  // Have the vertices no colours, or all the same?
  [[nodiscard]] bool plain_vertices() const {
    return std::adjacent_find(soup_.colors.begin(), soup_.colors.end(), std::not_equal_to<>()) ==
           soup_.colors.end();
  }

  void give_color(const glm::vec4& color) {
    context_.budget.take(2 * sizeof(glm::vec4));
    for (Corner& c : polygon_) c.color = std::uint32_t(soup_.colors.size());
    soup_.colors.push_back(linear_from_screen(color));
  }

  // Two numbers a corner; an empty list is usual where a face shows no picture.
  void give_coordinates() {
    if (coordinates_.empty()) return;
    if (coordinates_.size() != 2 * polygon_.size())
      refuse("has a face with " + std::to_string(polygon_.size()) + " corners, but " +
             std::to_string(coordinates_.size()) + " texture coordinates");
    context_.budget.take(polygon_.size(), 2 * sizeof(glm::vec2));
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      polygon_[i].uv = std::uint32_t(soup_.uv.size());
      soup_.uv.push_back(glm::vec2(coordinates_[2 * i], 1.0 - coordinates_[2 * i + 1]));
    }
  }

  PolygonSoup& soup_;
  PlyTextures& textures_;
  LoadContext& context_;
  std::vector<Corner> polygon_;
  std::vector<double> coordinates_;
  std::vector<SoupPart> parts_;
  std::map<int, std::uint32_t> part_index_;  // by material
};

// All strips are one list, where -1 ends a strip. Each vertex makes a triangle with the two before
// it; every second one runs the other way round.
void read_strips(const Element& element, Values& values, PolygonSoup& soup, std::uint32_t part,
                 MemoryBudget& budget) {
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
        add_face(soup, triangle, part, budget);
      }
    }
}

// Lines between two vertices each.
void read_edges(const Element& element, Values& values, PolygonSoup& soup, MemoryBudget& budget) {
  budget.take(element.count, 4 * sizeof(Corner) + 2 * sizeof(std::uint32_t));
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double ends[2] = {-1, -1};
    for (const Property& p : element.properties)
      for (std::uint64_t left = length_of(p, values); left > 0; --left) {
        const double number = values.next(p.type);
        if (p.name == "vertex1") ends[0] = number;
        if (p.name == "vertex2") ends[1] = number;
      }
    for (const double end : ends) soup.lines.corners.push_back(corner_of(end, soup, "an edge"));
    soup.lines.parts.push_back(0);
  }
}

void pass_over(const Element& element, Values& values) {
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& p : element.properties)
      for (std::uint64_t left = length_of(p, values); left > 0; --left) (void)values.next(p.type);
}

bool is_vertices(const Element& element) { return element.name == "vertex"; }

bool has_property(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& p) { return p.name == name; });
}

}  // namespace

Scene read_ply(Bytes file, LoadContext& context) {
  PlyTextures textures(context);
  const Header header =
      read_header({reinterpret_cast<const char*>(file.data()), file.size()}, textures);
  const std::vector<Element>& elements = header.elements;
  const auto vertices = std::find_if(elements.begin(), elements.end(), is_vertices);
  if (vertices == elements.end()) refuse("is a PLY file without an element 'vertex'");
  for (const char* name : {"f_dc_0", "packed_position"})
    if (has_property(*vertices, name))
      refuse("holds 3-D Gaussian splats ('" + std::string(name) +
             "'), which are no surfaces and are not drawn: make a mesh of them, or points with "
             "colours");
  PolygonSoup soup;
  Faces faces(soup, textures, context);
  const auto read_element = [&](const Element& element, Values& values) {
    if (element.name == "face") {
      faces.read(element, values);
    } else if (element.name == "edge") {
      read_edges(element, values, soup, context.budget);
    } else if (element.name == "tristrips") {
      read_strips(element, values, soup, faces.part_of(0), context.budget);
    } else {
      pass_over(element, values);
    }
  };
  // The vertices first, wherever they are.
  Values values(file, header), again = values;
  for (auto element = elements.begin(); element != vertices; ++element) pass_over(*element, values);
  read_vertices(*vertices, values, soup, context.budget);
  for (auto element = elements.begin(); element != vertices; ++element)
    read_element(*element, again);
  for (auto element = vertices + 1; element != elements.end(); ++element)
    read_element(*element, values);
  soup.all_points = soup.triangles.empty() && soup.lines.corners.empty();
  if (!textures.empty() && soup.uv.empty() && !soup.triangles.empty())
    context.warn("has a picture for its faces, but no texture coordinates");
  const std::vector<SoupPart> parts = faces.parts();
  return scene_of(std::move(soup), parts, textures.take(), context);
}

}  // namespace rilievo
