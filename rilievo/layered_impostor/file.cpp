#include "rilievo/layered_impostor/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "rilievo/io/stroke_attributes.h"
#include "rilievo/io/world_attributes.h"

namespace rilievo {
namespace {

constexpr const char* kRepresentation = "representation";
constexpr const char* kLayeredImpostor = "layered-impostor";
constexpr const char* kSlicing = "slicing";
constexpr const char* kFills = "fills";
constexpr const char* kUp = "up";
constexpr const char* kGaze = "gaze";
constexpr std::size_t kMaxFillText = std::size_t(1) << 24;

std::vector<std::string_view> split(std::string_view text, std::string_view separator) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (end > 0) pieces.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + separator.size(), text.size()));
  }
  return pieces;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string slicing_text(const SliceOptions& slicing) {
  return fmt::format("{} {} {} {}", slicing.layers, slicing.overlap,
                     slicing.spacing == SliceSpacing::eye_z ? "eye_z" : "window_z",
                     slicing.pieces ? "pieces" : "samples");
}

std::optional<SliceOptions> slicing_from(std::string_view text) {
  const std::vector<std::string_view> words = split(text, " ");
  if (words.size() != 4) return std::nullopt;
  const std::optional<int> layers = number<int>(words[0]);
  const std::optional<float> overlap = number<float>(words[1]);
  if (!layers || *layers < 1 || *layers > 4096) return std::nullopt;
  if (!overlap || !(*overlap >= 0 && *overlap <= float(*layers))) return std::nullopt;
  if (words[2] != "eye_z" && words[2] != "window_z") return std::nullopt;
  if (words[3] != "pieces" && words[3] != "samples") return std::nullopt;
  return SliceOptions{*layers, *overlap, words[3] == "pieces",
                      words[2] == "eye_z" ? SliceSpacing::eye_z : SliceSpacing::window_z};
}

std::string text_of(const glm::dvec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

// As many vectors as `into` has room for, of finite numbers.
bool read_vectors(std::string_view text, std::span<glm::dvec3> into) {
  const std::vector<std::string_view> words = split(text, " ");
  if (words.size() != 3 * into.size()) return false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<double> value = number<double>(words[i]);
    if (!value || !std::isfinite(*value)) return false;
    into[i / 3][glm::length_t(i % 3)] = *value;
  }
  return true;
}

// Files that do not say stand upright along y and are looked at from outside.
Result<Vantage> vantage_from(const Attributes& attributes) {
  Vantage vantage;
  if (const auto up = attributes.find(kUp); up != attributes.end()) {
    const bool read = read_vectors(up->second, {&vantage.up, 1});
    const double length = glm::length(vantage.up);
    if (!read || !(length > 1e-6 && length < 1e6))
      return Error{"", fmt::format("\"{}\" is not a direction that could be up", up->second)};
    vantage.up /= length;
  }
  if (const auto gaze = attributes.find(kGaze); gaze != attributes.end()) {
    std::array<glm::dvec3, 2> points;
    const bool read = read_vectors(gaze->second, points);
    const glm::dvec3 way = points[0] - points[1];
    // Who looks straight up or down has no way to go around.
    if (!read || !(glm::length(way) < 1e12) ||
        !(glm::length(glm::cross(way, vantage.up)) > 1e-6 * glm::length(way)))
      return Error{"", fmt::format("\"{}\" is not an eye and what it looks at", gaze->second)};
    vantage.gaze = Vantage::Gaze{points[0], points[1]};
  }
  return vantage;
}

std::string fills_text(const LayeredImpostor& impostor, int view) {
  std::string text;
  for (const FillSlices& fill : impostor.fills) {
    if (fill.view != view) continue;
    for (const FillSlice& s : fill.slices)
      text += fmt::format("{}{} {} {} {} {} {}", text.empty() ? "" : "; ", fill.neighbor,
                          impostor.slices[fill.neighbor][s.slice].layer, s.rect.x0, s.rect.y0,
                          s.rect.x1, s.rect.y1);
  }
  return text;
}

// Adds one view's fill slices to those of its pairs, which are all there.
Result<> add_fills(std::string_view text, int view, LayeredImpostor& impostor) {
  if (text.size() > kMaxFillText) return Error{"", "its fills are too long"};
  for (std::string_view entry : split(text, "; ")) {
    const Error broken{"", fmt::format("\"{}\" is not a slice that fills holes", entry)};
    const std::vector<std::string_view> words = split(entry, " ");
    if (words.size() != 6) return broken;
    int n[6];
    for (int i = 0; i < 6; ++i) {
      const std::optional<int> value = number<int>(words[i]);
      if (!value) return broken;
      n[i] = *value;
    }
    const auto pair =
        std::find_if(impostor.fills.begin(), impostor.fills.end(),
                     [&](const FillSlices& f) { return f.view == view && f.neighbor == n[0]; });
    if (pair == impostor.fills.end())
      return Error{"", fmt::format("its fills name view {}, which is no neighbour", n[0])};
    const std::vector<Slice>& slices = impostor.slices[n[0]];
    const auto slice =
        std::find_if(slices.begin(), slices.end(), [&](const Slice& s) { return s.layer == n[1]; });
    if (slice == slices.end())
      return Error{"",
                   fmt::format("its fills name layer {} of view {}, which is empty", n[1], n[0])};
    const TexelRect rect{n[2], n[3], n[4], n[5]};
    const Camera& camera = impostor.pictures[n[0]].camera;
    if (!(0 <= rect.x0 && rect.x0 < rect.x1 && rect.x1 <= camera.width && 0 <= rect.y0 &&
          rect.y0 < rect.y1 && rect.y1 <= camera.height))
      return broken;
    pair->slices.push_back({int(slice - slices.begin()), rect});
  }
  return Done{};
}

}  // namespace

Result<> save_layered_impostor(const std::filesystem::path& path, const LayeredImpostor& impostor,
                               const WorldSpace& world) {
  FileAttributes attributes;
  store_world(world, attributes.file);
  store_strokes(impostor.strokes, attributes.file);
  attributes.file[kRepresentation] = kLayeredImpostor;
  attributes.file[kSlicing] = slicing_text(impostor.slicing);
  if (impostor.vantage != Vantage{}) attributes.file[kUp] = text_of(impostor.vantage.up);
  if (const auto& gaze = impostor.vantage.gaze)
    attributes.file[kGaze] = text_of(gaze->eye) + " " + text_of(gaze->target);
  attributes.pictures.resize(impostor.pictures.size());
  if (!impostor.fills.empty())
    for (std::size_t v = 0; v < impostor.pictures.size(); ++v)
      attributes.pictures[v][kFills] = fills_text(impostor, int(v));
  return save_pictures(path, impostor.pictures, attributes);
}

bool matches_layered_impostor(const FileAttributes& attributes) {
  const auto found = attributes.file.find(kRepresentation);
  return found != attributes.file.end() && found->second == kLayeredImpostor;
}

Result<LayeredImpostor> layered_impostor_from(PictureFile file, const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& reason) { return Error{path.string(), reason}; };
  if (!matches_layered_impostor(file.attributes))
    return refuse(
        "it is not a layered impostor: rilievo.file.representation is missing or different");
  const auto text = file.attributes.file.find(kSlicing);
  if (text == file.attributes.file.end()) return refuse("it does not say how its views are sliced");
  const std::optional<SliceOptions> slicing = slicing_from(text->second);
  if (!slicing) return refuse(fmt::format("\"{}\" is not a way to slice views", text->second));

  const Result<Vantage> vantage = vantage_from(file.attributes.file);
  if (!vantage) return refuse(vantage.error().reason);
  const Result<StrokeSize> strokes = strokes_from(file.attributes.file);
  if (!strokes) return refuse(strokes.error().reason);

  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(file.pictures), *slicing);
  if (!impostor) return refuse(impostor.error().message());
  impostor->vantage = *vantage;
  impostor->strokes = *strokes;
  impostor->name = path.stem().string();

  std::size_t with_fills = 0;
  for (const Attributes& a : file.attributes.pictures) with_fills += a.count(kFills);
  if (with_fills == 0) return impostor;
  if (with_fills != impostor->pictures.size())
    return refuse("some of its views, not all, say what fills their holes");
  impostor->fills = neighbor_pairs(impostor->views);
  for (std::size_t v = 0; v < impostor->pictures.size(); ++v) {
    const Result<> added = add_fills(file.attributes.pictures[v].at(kFills), int(v), *impostor);
    if (!added) return refuse(fmt::format("view {}: {}", v, added.error().reason));
  }
  for (FillSlices& fill : impostor->fills)
    std::sort(fill.slices.begin(), fill.slices.end(),
              [](const FillSlice& a, const FillSlice& b) { return a.slice < b.slice; });
  return impostor;
}

Result<LayeredImpostor> load_layered_impostor(const std::filesystem::path& path) {
  Result<PictureFile> file = load_picture_file(path);
  if (!file) return file.error();
  return layered_impostor_from(std::move(*file), path);
}

}  // namespace rilievo
