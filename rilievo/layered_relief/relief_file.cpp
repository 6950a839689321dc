#include "rilievo/layered_relief/relief_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "rilievo/io/deep_exr.h"
#include "rilievo/io/stroke_attributes.h"
#include "rilievo/io/world_attributes.h"
#include "rilievo/layered_relief/relief_bound.h"

namespace rilievo {
namespace {

constexpr const char* kRepresentation = "representation";
constexpr const char* kLayeredRelief = "layered-relief";
constexpr const char* kMerged = "merged";
constexpr const char* kMoved = "moved";
constexpr const char* kLacks = "lacks";

// A length that is there, finite and not negative.
std::optional<double> metres(const Attributes& attributes, const char* key) {
  const auto found = attributes.find(key);
  if (found == attributes.end()) return std::nullopt;
  const std::string& text = found->second;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value) || value < 0) return std::nullopt;
  return value;
}

}  // namespace

Result<> save_relief_pictures(const std::filesystem::path& path, const ReliefPictures& pictures,
                              const WorldSpace& world) {
  FileAttributes attributes;
  store_world(world, attributes.file);
  store_strokes(pictures.strokes, attributes.file);
  attributes.file[kRepresentation] = kLayeredRelief;
  std::vector<LayeredDepthImage> layers;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    layers.push_back(picture.layers);
    attributes.pictures.push_back(
        {{kMerged, fmt::format("{}", picture.merged)}, {kMoved, fmt::format("{}", picture.moved)}});
    if (picture.lacks > 0) attributes.pictures.back()[kLacks] = fmt::format("{}", picture.lacks);
  }
  return save_layers(path, layers, attributes);
}

bool matches_layered_relief(const FileAttributes& attributes) {
  const auto found = attributes.file.find(kRepresentation);
  return found != attributes.file.end() && found->second == kLayeredRelief;
}

Result<ReliefPictures> relief_pictures_from(PictureFile file, const std::filesystem::path& path) {
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  if (!matches_layered_relief(file.attributes)) return error("holds no layered relief");
  if (file.layers.empty()) return error("says it is a layered relief, but has no deep pictures");
  if (file.layers.size() > ReliefStats::kMaxCount)
    return error(fmt::format("has {} deep pictures; a layered relief has at most {}",
                             file.layers.size(), int(ReliefStats::kMaxCount)));
  ReliefPictures pictures;
  for (std::size_t i = 0; i < file.layers.size(); ++i) {
    const Attributes& attributes = file.attributes.pictures[i];
    const std::optional<double> merged = metres(attributes, kMerged),
                                moved = metres(attributes, kMoved);
    if (!merged || !moved)
      return error(fmt::format("part {}: does not say how far its samples were moved", i));
    if (file.layers[i].camera.projection == Projection::back_perspective)
      return error(fmt::format("part {}: is back-perspective, which no layered relief is", i));
    pictures.pictures.push_back(
        {std::move(file.layers[i]), *merged, *moved, metres(attributes, kLacks).value_or(0.0)});
  }
  pictures.bounds = bounds_of(pictures);
  if (pictures.bounds.empty()) return error("its pictures show nothing");
  const Result<StrokeSize> strokes = strokes_from(file.attributes.file);
  if (!strokes) return error(strokes.error().reason);
  pictures.strokes = *strokes;
  return pictures;
}

}  // namespace rilievo
