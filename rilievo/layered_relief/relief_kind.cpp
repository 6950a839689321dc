#include "rilievo/layered_relief/relief_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "rilievo/kind/bounds_facts.h"
#include "rilievo/layered_relief/relief_file.h"

namespace rilievo {
namespace {

const std::array kBakeOptions{
    Option{.name = "size",
           .type = OptionType::integer,
           .default_value = "512",
           .help = "Texels of the longer side of a texture",
           .unit = "N",
           .min = 8,
           .max = 4096},
    Option{.name = "textures",
           .type = OptionType::choice,
           .default_value = "6",
           .help = "Directions that the object is looked at from",
           .choices = {"1", "2", "6", "12", "20", "32"}},
    Option{.name = "ball",
           .type = OptionType::number,
           .default_value = "0",
           .help = "Textures are squares, so many times as wide as the ball around the object: "
                   "texels are of one size from all sides; 0: they fit the object",
           .unit = "X",
           .min = 0,
           .max = 100},
    Option{.name = "merge",
           .type = OptionType::number,
           .default_value = "0.1",
           .help = "Surfaces closer along a line of sight than so many texels become one",
           .unit = "TEXELS",
           .min = 0,
           .max = 1000},
    Option{.name = "share",
           .type = OptionType::number,
           .default_value = "0.75",
           .help = "Faces that a texture sees edge-on get samples of the others, so many texels "
                   "apart, and cracks have a bound; 0: neither, and the cache draws none",
           .unit = "TEXELS",
           .min = 0,
           .max = 100},
    Option{.name = "max-depth",
           .type = OptionType::number,
           .default_value = "0",
           .help = "Of deep images: only what is nearer than this; 0 for all",
           .unit = "METRES",
           .min = 0},
};

const std::array kDrawOptions{
    Option{.name = "splat",
           .type = OptionType::number,
           .default_value = "1.4",
           .help = "Edge of the rectangle that a sample covers, as an eye sees it",
           .unit = "TEXELS",
           .min = 1,
           .max = 8},
    Option{.name = "relief-resolution",
           .type = OptionType::number,
           .default_value = "1",
           .help = "Texels of the warped picture for each texel of a texture, along a side",
           .unit = "X",
           .min = 0.05,
           .max = 8},
};

// Refuses options that say nothing of scenes, or of deep images.
Result<> check_options_of_source(const OptionValues& values,
                                 std::span<const LayeredDepthImage> deep) {
  if (deep.empty())
    return values.expect_none_of({"max-depth"}, "is for deep images, not for scenes");
  if (Result<> good = values.expect_none_of({"ball"}, "is for scenes: a deep image is framed");
      !good)
    return good;
  if (Result<> good = values.expect_none_of({"size", "textures", "share"},
                                            "is for scenes: a deep image is one texture as it is");
      !good)
    return good;
  const bool parallel = std::ranges::any_of(deep, [](const LayeredDepthImage& layers) {
    return layers.camera.projection == Projection::parallel;
  });
  if (!parallel) return Done{};
  return values.expect_none_of({"max-depth"},
                               "is for perspective deep images: a parallel one stays as it is");
}

Result<Baked> bake(const BakeInput& input, const OptionValues& values, const Progress& progress) {
  const ReliefCaptureOptions options = relief_capture_options(values);
  const std::span<const LayeredDepthImage> deep = input.source.deep_images();
  if (options.ball > 0 && options.ball < 1)
    return Error{"--ball", "must be 0 or at least 1: the ball would be cut off"};
  if (Result<> good = check_options_of_source(values, deep); !good) return good.error();
  Result<ReliefPictures> pictures =
      deep.empty() ? capture_relief_pictures(input.source, input.objects, options, progress)
                   : adopt_relief_pictures(deep, options);
  if (!pictures) return pictures.error();
  Baked baked{std::make_unique<ReliefRepresentation>(*std::move(pictures)), {}};
  baked.representation->world = input.source.world();
  return baked;
}

Result<std::unique_ptr<Representation>> load(PictureFile file, const std::filesystem::path& path) {
  Result<ReliefPictures> pictures = relief_pictures_from(std::move(file), path);
  if (!pictures) return pictures.error();
  return {std::make_unique<ReliefRepresentation>(*std::move(pictures))};
}

const ReliefPictures& pictures_of(const Representation& representation) {
  return dynamic_cast<const ReliefRepresentation&>(representation).pictures;
}

Result<> save(const Representation& representation, const std::filesystem::path& path) {
  return save_relief_pictures(path, pictures_of(representation), representation.world);
}

std::vector<Fact> describe(const Representation& representation) {
  const ReliefPictures& pictures = pictures_of(representation);
  std::size_t samples = 0, lines = 0, deepest = 0;
  double merged = 0, moved = 0;
  nlohmann::json sizes = nlohmann::json::array();
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    const LayeredDepthImage& layers = picture.layers;
    samples += layers.samples.size();
    for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
      const std::size_t count = layers.first[i + 1] - layers.first[i];
      lines += count > 0;
      deepest = std::max(deepest, count);
    }
    merged = std::max(merged, picture.merged);
    moved = std::max(moved, picture.moved);
    sizes.push_back({layers.camera.width, layers.camera.height});
  }
  const auto json = [](const auto& value) { return nlohmann::json(value).dump(); };
  const std::size_t count = pictures.pictures.size();
  const Camera& first = pictures.pictures.front().layers.camera;
  // Four streams of eight bytes a sample.
  const std::size_t bytes = 32 * samples;
  const double layers = double(samples) / double(std::max<std::size_t>(lines, 1));
  std::vector<Fact> facts{
      {"textures", json(count), "textures",
       fmt::format("{}, the first {}x{}", count, first.width, first.height)},
      {"sizes", sizes.dump(), "", ""},
      {"samples", json(samples), "samples",
       fmt::format("{}, {:.1f} on a line of sight, at most {}", samples, layers, deepest)},
      {"samples_a_line", json(layers), "", ""},
      {"most_samples_a_line", json(deepest), "", ""},
      {"relief_bytes", json(bytes), "memory",
       fmt::format("{:.1f} MB to be warped", 1e-6 * double(bytes))},
      {"merged_m", json(merged), "merged", fmt::format("{:.3g} m along a line of sight", merged)},
      {"moved_m", json(moved), moved > 0 ? "moved" : "",
       fmt::format("up to {:.3g} m into textures that others saw them for", moved)},
  };
  for (Fact& fact : bounds_facts(pictures.bounds, representation.world))
    facts.push_back(std::move(fact));
  return facts;
}

}  // namespace

std::size_t ReliefRepresentation::bytes() const {
  std::size_t sum = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    sum += picture.layers.samples.size() * sizeof(LayerSample) +
           picture.layers.first.size() * sizeof(std::uint64_t);
  return sum;
}

std::uint32_t ReliefRepresentation::only_object() const {
  const std::uint32_t only = rilievo::only_object(pictures);
  return only == kNoObject ? 1 : only;
}

Vantage ReliefRepresentation::vantage() const {
  Vantage vantage;
  const Camera& camera = pictures.pictures.front().layers.camera;
  if (pictures.pictures.size() != 1 || camera.projection != Projection::perspective) return vantage;
  const glm::dvec3 eye = camera.position(), forward = camera.forward();
  vantage.up = glm::normalize(glm::dvec3(camera.world_from_eye[1]));
  const double distance = glm::dot(glm::dvec3(pictures.bounds.center()) - eye, forward);
  if (distance > 0) vantage.gaze = Vantage::Gaze{eye, eye + distance * forward};
  return vantage;
}

ReliefCaptureOptions relief_capture_options(const OptionValues& values) {
  ReliefCaptureOptions options;
  options.size = values.integer("size");
  options.textures = int(values.number("textures"));
  options.ball = values.number("ball");
  options.merge_texels = values.number("merge");
  options.share_texels = values.number("share");
  options.max_depth = values.number("max-depth");
  return options;
}

PrewarpOptions relief_draw_options(const OptionValues& values) {
  PrewarpOptions options;
  options.splat_size = values.number("splat");
  options.resolution = values.number("relief-resolution");
  options.max_size = 2048;
  options.fill_pinholes = true;
  options.splats_face_eye = true;
  return options;
}

const Kind& layered_relief_kind() {
  static const Kind kind{
      .name = kLayeredReliefName,
      .summary = "every surface along each line of sight, warped by processors",
      .takes_deep_images = true,
      .bake_options = kBakeOptions,
      .draw_options = kDrawOptions,
      .bake = bake,
      .matches = matches_layered_relief,
      .load = load,
      .save = save,
      .describe = describe,
  };
  return kind;
}

}  // namespace rilievo
