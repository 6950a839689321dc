#include "rilievo/layered_impostor/layered_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "rilievo/kind/bounds_facts.h"
#include "rilievo/layered_impostor/bake_photographs.h"
#include "rilievo/layered_impostor/file.h"

namespace rilievo {
namespace {

const std::array kBakeOptions{
    Option{.name = "views",
           .type = OptionType::choice,
           .default_value = "32",
           .help = "Number of views: the faces of a dodecahedron, its vertices, or both",
           .choices = {"12", "20", "32"}},
    Option{.name = "hemisphere",
           .type = OptionType::flag,
           .default_value = "off",
           .help = "Only views at or above the horizon"},
    Option{.name = "ring",
           .type = OptionType::integer,
           .default_value = "0",
           .help = "N views on a horizontal circle, instead of --views; 0: off",
           .unit = "N",
           .min = 0,
           .max = 1024},
    Option{.name = "size",
           .type = OptionType::integer,
           .default_value = "256",
           .help = "Size of a view in texels a side",
           .unit = "N",
           .min = 8,
           .max = 4096},
    Option{.name = "layers",
           .type = OptionType::integer,
           .default_value = "64",
           .help = "Number of slices of a view",
           .unit = "N",
           .min = 1,
           .max = 4096},
    Option{.name = "overlap",
           .type = OptionType::number,
           .default_value = "0",
           .help = "Overlap of neighbouring slices, as a multiple of their thickness",
           .unit = "X",
           .min = 0,
           .max = 4096},
    Option{.name = "no-fills",
           .type = OptionType::flag,
           .default_value = "off",
           .help = "Do not compute the slices that fill each view's holes"},
    Option{.name = "box",
           .type = OptionType::box,
           .default_value = "",
           .help = "Photographs: the region to bake, as two corners (default everything)",
           .unit = "X0,Y0,Z0,X1,Y1,Z1"},
    Option{.name = "upright",
           .type = OptionType::point,
           .default_value = "",
           .help = "Photographs: the direction that is up in their world (default estimated "
                   "from the poses)",
           .unit = "X,Y,Z"},
    Option{
        .name = "around",
        .type = OptionType::flag,
        .default_value = "off",
        .help = "Photographs: views around the box, as for a scene, instead of at their cameras"},
};

const std::array kDrawOptions{
    Option{.name = "warp",
           .type = OptionType::choice,
           .default_value = "surfaces",
           .help = "Draw by ray marching through the pictures' surfaces, or draw their slices",
           .choices = {"surfaces", "slices"}},
};

constexpr std::array kVariants{Variant{"layered-slices", "warp", "slices"},
                               Variant{"layered", "", ""}};

// Of the option "upright"; nothing if it was not given.
std::optional<glm::dvec3> up_from(const OptionValues& values) {
  const std::vector<double> n = values.numbers("upright");
  if (n.empty()) return std::nullopt;
  return glm::dvec3(n[0], n[1], n[2]);
}

Result<> check_options(const OptionValues& values) {
  if (const std::optional<glm::dvec3> up = up_from(values);
      up && !(glm::length(*up) > 1e-6 && glm::length(*up) < 1e6))
    return Error{"--upright", "is not a direction: its length must be between 1e-6 and 1e6"};
  if (values.integer("ring") > 0 && values.integer("ring") < 3)
    return Error{"--ring", "takes at least 3 views"};
  if (values.integer("ring") > 0 && (values.given("views") || values.flag("hemisphere")))
    return Error{"--ring", "excludes --views and --hemisphere"};
  if (!(values.number("overlap") <= values.number("layers")))
    return Error{"--overlap", fmt::format("{} is more than all of the {} layers",
                                          values.text("overlap"), values.text("layers"))};
  return Done{};
}

// `n` counts from the world's origin.
Box box_from(const std::vector<double>& n, std::span<const DepthImage> photographs,
             const glm::dvec3& origin) {
  if (n.empty()) return measured_bounds(photographs);
  return {glm::dvec3(n[0], n[1], n[2]) - origin, glm::dvec3(n[3], n[4], n[5]) - origin};
}

nlohmann::json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// From photographs: their own reprojection, no capture call (S2.7).
Result<Baked> bake_from_photographs(CaptureSource& source, const OptionValues& values) {
  if (!values.flag("around"))
    if (Result<> good = values.expect_none_of(
            {"views", "ring", "hemisphere", "size"},
            "is for views around the box (--around): these stand at the photographs' cameras");
        !good)
      return good.error();
  const BakeOptions options = layered_bake_options(values);
  const std::span<const DepthImage> photographs = source.photographs();
  const WorldSpace world = source.world();
  const Box box = box_from(values.numbers("box"), photographs, world.origin);
  PhotographBakeOptions bake;
  bake.reproject.box = box;
  bake.up = up_from(values);
  bake.slicing = options.slicing;
  bake.kind = values.flag("around") ? PhotographViews::around : PhotographViews::at_cameras;
  bake.views = options.views;
  bake.camera = options.camera;
  Result<PhotographBake> made = bake_photographs(photographs, bake);
  if (!made) return Error{std::string(source.name()), made.error().reason};
  made->impostor.name = source.name();
  nlohmann::json holes = nlohmann::json::array();
  for (const ReprojectStats& view : made->stats) holes.push_back(view.hole_share());
  Baked baked;
  baked.facts = {
      {"photographs", std::to_string(photographs.size()), "photos",
       std::to_string(photographs.size())},
      {"box",
       nlohmann::json{list_of(world.origin + glm::dvec3(box.min)),
                      list_of(world.origin + glm::dvec3(box.max))}
           .dump(),
       "", ""},
      {"filled_texels", nlohmann::json(made->total.filled).dump(), "", ""},
      {"hole_texels", nlohmann::json(made->total.holes).dump(), "", ""},
      {"hole_share", nlohmann::json(made->total.hole_share()).dump(), "holes",
       fmt::format("{:.2f} % of the silhouettes", 100 * made->total.hole_share())},
      {"hole_share_by_view", holes.dump(), "", ""},
  };
  baked.representation = std::make_unique<LayeredRepresentation>(std::move(made->impostor));
  baked.representation->world = world;
  return baked;
}

Result<Baked> bake(const BakeInput& input, const OptionValues& values, const Progress& progress) {
  if (!input.source.photographs().empty()) return bake_from_photographs(input.source, values);
  if (values.given("box") || values.given("upright") || values.flag("around"))
    return Error{std::string(input.source.name()),
                 "is no capture: --box, --upright and --around are for photographs"};
  BakeOptions options = layered_bake_options(values);
  options.progress = progress;
  Result<LayeredImpostor> impostor = bake_layered(input.source, input.objects, options);
  if (!impostor) return impostor.error();
  Baked baked{std::make_unique<LayeredRepresentation>(std::move(*impostor)), {}};
  baked.representation->world = input.source.world();
  return baked;
}

Result<std::unique_ptr<Representation>> load(PictureFile file, const std::filesystem::path& path) {
  Result<LayeredImpostor> impostor = layered_impostor_from(std::move(file), path);
  if (!impostor) return impostor.error();
  return {std::make_unique<LayeredRepresentation>(std::move(*impostor))};
}

const LayeredImpostor& impostor_of(const Representation& representation) {
  return dynamic_cast<const LayeredRepresentation&>(representation).impostor;
}

Result<> save(const Representation& representation, const std::filesystem::path& path) {
  return save_layered_impostor(path, impostor_of(representation), representation.world);
}

const char* name_of(Projection projection) {
  switch (projection) {
    case Projection::perspective:
      return "perspective";
    case Projection::back_perspective:
      return "back-perspective";
    case Projection::parallel:
      return "parallel";
  }
  return "";
}

std::size_t texture_bytes(const LayeredImpostor& impostor, LayeredMethod method) {
  int width = 0, height = 0;
  for (const DepthImage& picture : impostor.pictures) {
    width = std::max(width, picture.camera.width);
    height = std::max(height, picture.camera.height);
  }
  return layered_texture_bytes(int(impostor.pictures.size()), width, height, method);
}

std::vector<Fact> describe(const Representation& representation) {
  const LayeredImpostor& impostor = impostor_of(representation);
  const LayeredStats stats = analyze_layered_impostor(impostor);
  const DepthImage& first = impostor.pictures.front();
  const std::size_t views = impostor.pictures.size();
  std::size_t texels = 0;
  for (const DepthImage& picture : impostor.pictures) texels += picture.depth.texels().size();
  const double coverage = double(stats.covered_texels) / double(texels);
  const auto json = [](const auto& value) { return nlohmann::json(value).dump(); };
  const std::size_t surfaces = texture_bytes(impostor, LayeredMethod::surfaces);
  const std::size_t slices = texture_bytes(impostor, LayeredMethod::slices);
  const Camera& camera = first.camera;
  std::vector<Fact> facts{
      {"views", json(views), "views",
       fmt::format("{} {} pictures of {}x{}", views, name_of(camera.projection), camera.width,
                   camera.height)},
      {"size", nlohmann::json{camera.width, camera.height}.dump(), "", ""},
      {"projection", json(name_of(camera.projection)), "", ""},
      {"paper_bytes", json(stats.paper_bytes), "memory",
       fmt::format("{:.1f} MB as 4 bytes a texel; textures {:.1f} MB for surfaces, {:.1f} MB for "
                   "slices",
                   1e-6 * double(stats.paper_bytes), 1e-6 * double(surfaces),
                   1e-6 * double(slices))},
      {"texture_bytes", nlohmann::json{{"surfaces", surfaces}, {"slices", slices}}.dump(), "", ""},
      {"coverage", json(coverage), "coverage",
       fmt::format("{:.1f} % of the texels show something", 100 * coverage)},
      {"layers", json(impostor.slicing.layers), "slices",
       fmt::format("{} of {} layers a view, overlap {}; {} empty ones dropped", stats.slices,
                   impostor.slicing.layers, impostor.slicing.overlap, stats.empty_slices)},
      {"overlap", json(impostor.slicing.overlap), "", ""},
      {"slices", json(stats.slices), "", ""},
      {"empty_slices", json(stats.empty_slices), "", ""},
      {"fill_share", json(stats.fill_share), "fill",
       fmt::format("{:.1f} % of the texels of full slices are drawn", 100 * stats.fill_share)},
      {"fill_saved", json(stats.fill_saved), "", ""},
      {"holes_looked_for", json(!impostor.fills.empty()), "holes",
       impostor.fills.empty()
           ? std::string("not looked for")
           : fmt::format("of a view filled by {:.1f} slices of a neighbour, {:.1f} % of its fill",
                         stats.hole_slices, 100 * stats.hole_fill_share)},
      {"hole_slices", json(stats.hole_slices), "", ""},
      {"hole_fill_share", json(stats.hole_fill_share), "", ""},
      {"up",
       nlohmann::json{impostor.vantage.up.x, impostor.vantage.up.y, impostor.vantage.up.z}.dump(),
       "", ""},
  };
  for (Fact& fact : bounds_facts(impostor.bounds, representation.world))
    facts.push_back(std::move(fact));
  return facts;
}

}  // namespace

std::size_t LayeredRepresentation::bytes() const {
  std::size_t texels = 0;
  for (const DepthImage& picture : impostor.pictures) texels += picture.depth.texels().size();
  return texels * (sizeof(glm::vec4) + sizeof(float) + sizeof(std::uint32_t));
}

std::uint32_t LayeredRepresentation::only_object() const {
  for (const DepthImage& picture : impostor.pictures)
    for (const std::uint32_t object : picture.object.texels())
      if (object != kNoObject) return object;
  return 1;
}

BakeOptions layered_bake_options(const OptionValues& values) {
  BakeOptions bake;
  const int ring = values.integer("ring"), views = values.integer("views");
  bake.views.spread = ring          ? ViewSpread::ring
                      : views == 12 ? ViewSpread::faces_12
                      : views == 20 ? ViewSpread::vertices_20
                                    : ViewSpread::both_32;
  bake.views.hemisphere = values.flag("hemisphere");
  if (ring) bake.views.ring = ring;
  bake.camera.size = values.integer("size");
  bake.fills = !values.flag("no-fills");
  bake.slicing.layers = values.integer("layers");
  bake.slicing.overlap = float(values.number("overlap"));
  return bake;
}

LayeredOptions layered_draw_options(const OptionValues& values) {
  LayeredOptions options;
  if (values.text("warp") == "slices") options.method = LayeredMethod::slices;
  return options;
}

const Kind& layered_impostor_kind() {
  static const Kind kind{
      .name = kLayeredImpostorName,
      .summary = "pictures from all around, the nearest ones warped",
      .variants = kVariants,
      .bake_options = kBakeOptions,
      .draw_options = kDrawOptions,
      .bake = bake,
      .check_options = check_options,
      .matches = matches_layered_impostor,
      .load = load,
      .save = save,
      .describe = describe,
  };
  return kind;
}

}  // namespace rilievo
