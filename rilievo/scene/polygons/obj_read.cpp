// Wavefront OBJ: polygons, points, lines, groups and materials; free-form surfaces are left out.
//
// Every name after `o` or `g` is an Object; a vertex may have a colour behind its position, as
// sculpting programs write it: from 0 to 1, or in bytes. A face may refer to what follows it.
// Where faces have no normals, smoothing groups say which edges are smooth; before the first `s`,
// and in files without, angles do. A group does not reach beyond its `o`.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "rilievo/io/color_io.h"
#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/obj_material.h"
#include "rilievo/scene/polygons/polygon_read.h"

namespace rilievo {
namespace {

// What a vertex without a colour has until all are read.
constexpr glm::vec4 kNoColor(-1.0f);

// A face that refers to what follows it.
struct LateFace {
  std::size_t line = 0;  // of the file
  std::uint32_t part = 0, smoothing = PolygonSoup::kCreased;
  std::vector<Corner> corners;
};

class Reader {
 public:
  explicit Reader(LoadContext& context) : context_(context), library_(context) {}

  Scene read(std::string_view text) {
    std::string joined;
    for (std::optional<std::string_view> line = next(text, joined); line; line = next(text, joined))
      read_statement(*line);
    add_late_faces();
    check_strokes();
    finish_colors();
    if (!any_statement_) refuse("is not an OBJ file: it has no statement of one");
    if (soup_.triangles.empty() && soup_.lines.corners.empty() && soup_.points.corners.empty())
      show_vertices();
    for (SoupPart& part : parts_)
      part.material = library_.use(material_names_[part.material], !soup_.colors.empty());
    return scene_of(std::move(soup_), parts_, library_.take(), context_);
  }

 private:
  // Does the next line belong to this one? A backslash that ends a comment is a path's.
  static bool is_continued(std::string_view line) {
    return line.ends_with('\\') && !trimmed(line).starts_with('#') &&
           line.find(" #") == line.npos && line.find("\t#") == line.npos;
  }

  // The next line; a backslash at its end joins it with the one that follows.
  std::optional<std::string_view> next(std::string_view& text, std::string& joined) {
    ++line_;
    std::optional<std::string_view> line = take_line(text);
    if (!line || !is_continued(*line)) return line;
    joined.clear();
    while (line && is_continued(*line)) {
      joined += line->substr(0, line->size() - 1);
      joined += ' ';
      ++line_;
      line = take_line(text);
    }
    if (line) joined += *line;
    return joined;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    refuse("line " + std::to_string(line_) + " " + reason);
  }

  // Up to `numbers.size()` numbers; how many there are.
  std::size_t read_numbers(std::string_view rest, std::span<double> numbers) const {
    std::size_t n = 0;
    for (std::string_view word = take_word(rest); !word.empty() && n < numbers.size();
         word = take_word(rest)) {
      if (word[0] == '#') break;
      const std::optional<double> number = number_of(word);
      if (!number) fail(no_number(word));
      numbers[n++] = *number;
    }
    return n;
  }

  void read_statement(std::string_view rest) {
    const std::string_view word = take_word(rest);
    if (word.empty() || word[0] == '#') return;
    if (word == "v") {
      read_position(rest);
    } else if (word == "vt") {
      double uv[2] = {0, 0};
      // One coordinate is legal, and two might be written with a comma between them.
      if (read_numbers(rest, uv) == 1 && rest.find(',') != rest.npos)
        fail("has '" + std::string(trimmed(rest).substr(0, 20)) + "', one number or two");
      context_.budget.take(2 * sizeof(glm::vec2));
      // v grows upwards there, downwards here.
      soup_.uv.push_back(glm::vec2(uv[0], 1.0 - uv[1]));
    } else if (word == "vn") {
      double n[3] = {0, 0, 0};
      read_numbers(rest, n);
      context_.budget.take(2 * sizeof(glm::vec3));
      soup_.normals.push_back(glm::vec3(n[0], n[1], n[2]));
    } else if (word == "f" || word == "fo") {
      read_face(rest);
    } else if (word == "s") {
      read_smoothing(take_word(rest));
    } else if (word == "o" || word == "g") {
      object_ = trimmed(rest);
      if (word == "o") whole_ = object_;
      part_ = -1;
    } else if (word == "usemtl") {
      material_ = trimmed(rest);
      part_ = -1;
    } else if (word == "mtllib") {
      library_.read(std::string(trimmed(rest)));
    } else if (word == "p" || word == "l") {
      read_strokes(rest, word == "p");
    } else if (word == "curv" || word == "surf" || word == "curv2") {
      context_.warn("free-form curves and surfaces are left out");
    } else {
      return;
    }
    any_statement_ = true;
  }

  // "off" and 0, "on", a number: which faces are smooth from here on.
  void read_smoothing(std::string_view word) {
    const std::string state = lower_case(word);
    const std::optional<std::int64_t> number = state == "off"  ? 0
                                               : state == "on" ? 1
                                                               : whole_number_of(state);
    if (!number && !state.empty()) fail(no_number(word));
    smoothing_ = number ? *number : 0;
  }

  // What PolygonSoup::smoothing says of the next face.
  std::uint32_t smoothing_group() {
    if (!smoothing_) return PolygonSoup::kCreased;
    if (*smoothing_ == 0) return PolygonSoup::kFlat;
    const auto [known, fresh] =
        groups_.try_emplace({whole_, *smoothing_}, std::uint32_t(groups_.size() + 1));
    if (fresh) context_.budget.take(128 + whole_.size());
    return known->second;
  }

  void add_face(std::span<const Corner> polygon, std::uint32_t part, std::uint32_t smoothing) {
    if (const Corner* bad = corner_that_is_not_finite(soup_, polygon))
      fail("has a face with vertex " + std::to_string(bad->position + 1) +
           ", whose position is not finite");
    const std::size_t before = soup_.parts.size();
    add_polygon(soup_, polygon, part, context_.budget);
    if (smoothing == PolygonSoup::kCreased && soup_.smoothing.empty()) return;
    context_.budget.take(2 * (soup_.parts.size() - soup_.smoothing.size()), sizeof(std::uint32_t));
    soup_.smoothing.resize(before, PolygonSoup::kCreased);
    soup_.smoothing.resize(soup_.parts.size(), smoothing);
  }

  void read_position(std::string_view rest) {
    double v[7];
    const std::size_t n = read_numbers(rest, v);
    if (n < 3) fail("has a vertex with fewer than three numbers");
    context_.budget.take(2 * sizeof(glm::dvec3));
    soup_.positions.push_back({v[0], v[1], v[2]});  // finite or not: a face may never use it
    if (n < 6) return;
    context_.budget.take(2 * sizeof(glm::vec4));
    soup_.colors.resize(soup_.positions.size() - 1, kNoColor);
    soup_.colors.push_back(glm::vec4(v[3], v[4], v[5], n > 6 ? v[6] : 1.0));
  }

  // Makes the colours linear: they are as the file has them until all are read.
  void finish_colors() {
    if (soup_.colors.empty()) return;
    soup_.colors.resize(soup_.positions.size(), kNoColor);
    // Whether they are bytes only the whole file tells. Rounding alone may bring 1 a little above
    // 1; bytes of which none is above 2 would be a black object.
    const bool bytes =
        std::any_of(soup_.colors.begin(), soup_.colors.end(), [](const glm::vec4& c) {
          return c != kNoColor && std::max({c.r, c.g, c.b}) > 2.0f;
        });
    for (glm::vec4& c : soup_.colors) {
      if (c == kNoColor) c = glm::vec4(bytes ? 255.0f : 1.0f);
      if (bytes) c = glm::vec4(glm::vec3(c) / 255.0f, c.a > 2.0f ? c.a / 255.0f : c.a);
      c = linear_from_screen(c);
    }
  }

  // "7", "-1": from the first, or back from the last one so far. The first may be still to come.
  std::uint32_t resolve(std::string_view digits, std::size_t count, const char* what) const {
    const std::optional<std::int64_t> i = whole_number_of(digits);
    if (!i) fail(no_number(digits));
    const std::int64_t at = *i > 0 ? *i - 1 : *i + std::int64_t(count);
    if (*i == 0 || at < 0 || at >= std::int64_t(Corner::kNone)) fail_reference(what, *i, count);
    return std::uint32_t(at);
  }

  [[noreturn]] void fail_reference(const char* what, std::int64_t number, std::size_t count) const {
    fail("refers to " + std::string(what) + " " + std::to_string(number) + but_there_are(count));
  }

  // Points, or a line from each to the next.
  void read_strokes(std::string_view rest, bool points) {
    read_corners(rest);
    if (part_ < 0) part_ = find_part();
    const std::uint32_t part = std::uint32_t(part_);
    context_.budget.take(polygon_.size(), 8 * sizeof(Corner));
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      if (late_stroke_ == 0 && !is_read(polygon_[i])) late_stroke_ = line_;
      if (points) soup_.points.corners.push_back(polygon_[i]), soup_.points.parts.push_back(part);
      if (points || i == 0) continue;
      soup_.lines.corners.insert(soup_.lines.corners.end(), {polygon_[i - 1], polygon_[i]});
      soup_.lines.parts.push_back(part);
    }
  }

  void read_face(std::string_view rest) {
    read_corners(rest);
    if (polygon_.size() < 3) {
      context_.warn("faces with fewer than three corners are left out");
      return;
    }
    if (part_ < 0) part_ = find_part();
    if (std::all_of(polygon_.begin(), polygon_.end(),
                    [&](const Corner& c) { return is_read(c); })) {
      add_face(polygon_, std::uint32_t(part_), smoothing_group());
    } else {
      context_.budget.take(2 * sizeof(LateFace) + polygon_.size() * sizeof(Corner));
      late_faces_.push_back({line_, std::uint32_t(part_), smoothing_group(), polygon_});
    }
  }

  // The corners of a face, or of points or lines, which may follow it.
  void read_corners(std::string_view rest) {
    polygon_.clear();
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      if (word[0] == '#') break;
      // "position", "position/uv", "position//normal", "position/uv/normal"
      std::array<std::string_view, 3> field;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t end = std::min(word.find('/'), word.size());
        field[k] = word.substr(0, end);
        word.remove_prefix(std::min(end + 1, word.size()));
      }
      Corner corner{resolve(field[0], soup_.positions.size(), "vertex")};
      if (!field[1].empty()) corner.uv = resolve(field[1], soup_.uv.size(), "texture coordinate");
      if (!field[2].empty()) corner.normal = resolve(field[2], soup_.normals.size(), "normal");
      context_.budget.borrow(polygon_.size(), 8 * sizeof(Corner));
      polygon_.push_back(corner);
    }
  }

  static bool is_below(std::uint32_t index, std::size_t count) {
    return index == Corner::kNone || index < count;
  }

  bool is_read(const Corner& c) const {
    return c.position < soup_.positions.size() && is_below(c.uv, soup_.uv.size()) &&
           is_below(c.normal, soup_.normals.size());
  }

  // Adds the faces that referred to what followed them.
  void add_late_faces() {
    for (const LateFace& face : late_faces_) {
      line_ = face.line;
      for (const Corner& c : face.corners) check(c);
      add_face(face.corners, face.part, face.smoothing);
    }
  }

  void check(const Corner& c) const {
    const auto refers = [&](const char* what, std::uint32_t index, std::size_t count) {
      if (!is_below(index, count)) fail_reference(what, std::int64_t(index) + 1, count);
    };
    refers("vertex", c.position, soup_.positions.size());
    refers("texture coordinate", c.uv, soup_.uv.size());
    refers("normal", c.normal, soup_.normals.size());
  }

  // Points and lines may refer to what follows them, too.
  void check_strokes() {
    line_ = late_stroke_;
    for (const Strokes* strokes : {&soup_.points, &soup_.lines})
      for (const Corner& c : strokes->corners) check(c);
  }

  // A file of nothing but vertices is a cloud of points.
  void show_vertices() {
    object_.clear(), material_.clear();
    parts_.clear(), part_index_.clear();
    (void)find_part();
    soup_.all_points = true;
    if (soup_.normals.size() != soup_.positions.size()) soup_.normals.clear();
    if (soup_.uv.size() != soup_.positions.size()) soup_.uv.clear();
  }

  // The part of the current object with the current material.
  int find_part() {
    const auto [material, new_material] =
        material_index_.try_emplace(material_, int(material_names_.size()));
    if (new_material) material_names_.push_back(material_);
    const auto [part, fresh] =
        part_index_.try_emplace({object_, material->second}, int(parts_.size()));
    if (fresh) {
      context_.budget.take(256 + object_.size() + sizeof(Mesh));
      parts_.push_back({object_.empty() ? context_.name : object_, material->second});
    }
    return part->second;
  }

  LoadContext& context_;
  ObjMaterials library_;
  PolygonSoup soup_;
  std::vector<Corner> polygon_;
  std::vector<LateFace> late_faces_;
  std::string object_, material_;
  std::string whole_;                      // what `o` named last
  std::optional<std::int64_t> smoothing_;  // what `s` said last
  std::map<std::pair<std::string, std::int64_t>, std::uint32_t> groups_;
  int part_ = -1;                // of the soup, for the next face; -1: to be found
  std::vector<SoupPart> parts_;  // material: an index into material_names_ until all is read
  std::vector<std::string> material_names_;
  std::map<std::string, int> material_index_;
  std::map<std::pair<std::string, int>, int> part_index_;
  std::size_t line_ = 0;
  std::size_t late_stroke_ = 0;  // the first line whose points or lines refer to what follows them
  bool any_statement_ = false;
};

}  // namespace

Scene read_obj(Bytes file, LoadContext& context) {
  context.budget.borrow(file.size(), 2);  // if it is in UTF-16
  std::string converted;
  const std::string_view text = utf8_from(file, converted);
  // A zero is in no text, but soon in anything else.
  if (text.substr(0, 4096).find('\0') != std::string::npos)
    refuse("is not an OBJ file: it holds binary data");
  return Reader(context).read(text);
}

}  // namespace rilievo
