#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/cache/prices/use_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "rilievo/cache/measure_costs.h"
#include "rilievo/cache/plan/forest_test_helpers.h"
#include "rilievo/cache/software/measure_software.h"
#include "rilievo/core/file_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;
using Json = nlohmann::json;

// The machine of policy.h: a triangle takes 280 ns.
MachineCosts builtin_machine() {
  MachineCosts costs;
  costs.cpu = "a \"CPU\"";
  costs.threads = 2;
  costs.gl_renderer = "llvmpipe";
  costs.draw_software = {2800, 5.6, 5600, 280, 28};
  costs.draw_opengl = costs.draw_software;
  costs.capture_rasterizer = {11200, 28, 84};
  costs.capture_opengl = {560000, 280, 56};
  costs.ray_texel_ns = 224;
  return costs;
}

TEST(MachineCosts, come_back_from_json_and_from_a_file_to_the_bit) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> exponent(std::log(kLeastNs), std::log(kMostNs));
  const auto time = [&] { return std::clamp(std::exp(exponent(rng)), kLeastNs, kMostNs); };
  const TemporaryFolder folder;
  for (int i = 0; i < 200; ++i) {
    MachineCosts costs;
    costs.cpu = "cpu " + std::to_string(i);
    costs.threads = i;
    for (DrawTimes* draw : {&costs.draw_software, &costs.draw_opengl.emplace()})
      for (double* ns : {&draw->picture_ns, &draw->picture_pixel_ns, &draw->object_ns,
                         &draw->triangle_ns, &draw->polygon_pixel_ns})
        *ns = time();
    for (CaptureTimes* capture : {&costs.capture_rasterizer, &costs.capture_opengl.emplace()})
      for (double* ns : {&capture->picture_ns, &capture->triangle_ns, &capture->texel_ns})
        *ns = time();
    costs.ray_texel_ns = time();
    if (i % 2 == 0) costs.draw_opengl.reset(), costs.capture_opengl.reset();
    const Result<MachineCosts> parsed = parse_machine(machine_json(costs), "text");
    ASSERT_TRUE(parsed.ok()) << parsed.error().message();
    EXPECT_EQ(*parsed, costs);
    if (i >= 3) continue;
    ASSERT_TRUE(save_machine(costs, folder / "machine.json").ok());  // the second replaces it
    const Result<MachineCosts> loaded = load_machine(folder / "machine.json");
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    EXPECT_EQ(*loaded, costs);
  }
  EXPECT_FALSE(load_machine(folder / "none.json").ok());
}

// Every place of a number in the file.
std::vector<Json::json_pointer> times_of(const Json& json) {
  std::vector<Json::json_pointer> places;
  const Json flat = json.flatten();
  for (const auto& [place, value] : flat.items())
    if (place.ends_with("_ns")) places.emplace_back(place);
  return places;
}

TEST(MachineCosts, a_time_that_is_missing_or_absurd_is_named) {
  const Json good = Json::parse(machine_json(builtin_machine()));
  const std::vector<Json::json_pointer> places = times_of(good);
  ASSERT_EQ(places.size(), 2u * 5 + 2 * 3 + 1);
  for (const Json::json_pointer& place : places) {
    std::string name = place.to_string().substr(1);  // draw/software/picture_ns
    std::replace(name.begin(), name.end(), '/', '.');
    for (const Json& bad : {Json(-1.0), Json(0.0), Json(1e-5), Json(1e10), Json(1e300), Json(),
                            Json("280"), Json::array({280.0}), Json(true), Json(-280)}) {
      Json json = good;
      json[place] = bad;
      const Result<MachineCosts> parsed = parse_machine(json.dump(), "machine.json");
      ASSERT_FALSE(parsed.ok()) << json.dump();
      EXPECT_EQ(parsed.error().where, "machine.json");
      EXPECT_NE(parsed.error().reason.find(name), std::string::npos) << parsed.error().reason;
    }
    Json json = good;
    json[place.parent_pointer()].erase(place.back());
    const Result<MachineCosts> parsed = parse_machine(json.dump(), "machine.json");
    ASSERT_FALSE(parsed.ok()) << json.dump();
    EXPECT_NE(parsed.error().reason.find(name), std::string::npos) << parsed.error().reason;
    EXPECT_NE(parsed.error().reason.find("missing"), std::string::npos) << parsed.error().reason;
  }
}

TEST(MachineCosts, what_is_no_such_file_is_refused) {
  const std::string good = machine_json(builtin_machine());
  for (std::size_t length = 0; length + 2 < good.size(); ++length)
    EXPECT_FALSE(parse_machine(good.substr(0, length), "cut").ok()) << length;
  // NaN and infinity are no JSON.
  for (const char* word : {"NaN", "nan", "Infinity", "-Infinity", "1e999"}) {
    std::string bad = good;
    bad.replace(bad.find("280.0"), 5, word);
    EXPECT_FALSE(parse_machine(bad, "word").ok()) << word;
  }
  for (const char* text : {"[]", "3", "null", "{}", R"({"schema": "rilievo-path-1"})",
                           R"({"schema": 7})", R"({"schema": "rilievo-machine-1"})"})
    EXPECT_FALSE(parse_machine(text, "other").ok()) << text;
  for (const char* part : {"draw", "capture"})
    for (const Json& bad : {Json(3), Json::array(), Json()}) {
      Json json = Json::parse(good);
      json[part] = bad;
      EXPECT_FALSE(parse_machine(json.dump(), "part").ok()) << json.dump();
    }
}

TEST(MachineCosts, those_of_the_machine_that_the_defaults_are_from_give_the_defaults) {
  const auto expect_same = [](const CacheOptions& a, const CacheOptions& b) {
    const auto near = [](double x, double y) { EXPECT_NEAR(x, y, 1e-12 * y); };
    near(a.cost.picture, b.cost.picture), near(a.cost.picture_pixel, b.cost.picture_pixel);
    near(a.cost.object, b.cost.object), near(a.cost.polygon_pixel, b.cost.polygon_pixel);
    near(a.cost.capture, b.cost.capture), near(a.cost.capture_triangle, b.cost.capture_triangle);
    near(a.cost.capture_texel, b.cost.capture_texel);
    near(a.cost.fallback_texel, b.cost.fallback_texel);
    EXPECT_EQ(a.capture_triangles, b.capture_triangles);
    EXPECT_EQ(a.picture_triangles, b.picture_triangles);
  };
  CostClock clock;
  CacheOptions options;
  use_machine(builtin_machine(), DrawnBy::opengl, false, options, clock);
  expect_same(options, {});
  options = {};
  use_machine(builtin_machine(), DrawnBy::software, true, options, clock);
  CacheOptions rasterized = rasterized_cache_options();
  rasterized.capture_triangles = 1'428'571;  // in 40 ms instead of 140, of 28 ns each
  expect_same(options, rasterized);
  for (const MeasuredPrice& price : {clock.drawing, clock.capture, clock.fallback})
    EXPECT_DOUBLE_EQ(price.ms_per_cost, 280e-6);
}

TEST(MachineCosts, measured_without_opengl_do_not_serve_it) {
  MachineCosts costs = builtin_machine();
  EXPECT_TRUE(expect_costs(costs, DrawnBy::opengl, false).ok());
  costs.capture_opengl.reset();
  EXPECT_FALSE(expect_costs(costs, DrawnBy::opengl, false).ok());
  EXPECT_TRUE(expect_costs(costs, DrawnBy::opengl, true).ok());
  costs.draw_opengl.reset();
  EXPECT_FALSE(expect_costs(costs, DrawnBy::opengl, true).ok());
  EXPECT_TRUE(expect_costs(costs, DrawnBy::software, true).ok());
}

TEST(MachineCosts, a_kinds_triangles_stay_and_its_work_follows_the_pixels) {
  const CostTerms terms{100, 0.5, 4000};
  const CostTerms same = terms_for(terms, {});
  EXPECT_EQ(same.fixed, 4100);
  EXPECT_EQ(same.per_pixel, 0.5);
  EXPECT_EQ(same.triangles, 0);
  CostModel dear;  // triangles ten times as dear: pixels are a tenth of one
  dear.picture_pixel /= 10;
  const CostTerms cheap = terms_for(terms, dear);
  EXPECT_DOUBLE_EQ(cheap.fixed, 4010);
  EXPECT_DOUBLE_EQ(cheap.per_pixel, 0.05);
}

// Objects drawn as polygons and captures, in frames of a walk.
struct Chosen {
  int polygons = 0, captures = 0;
};
Chosen walk_on(const MachineCosts& costs) {
  const PlanObjects forest = plant(700);
  CacheOptions options = rasterized_cache_options();
  CostClock clock;
  use_machine(costs, DrawnBy::software, true, options, clock);
  options.fade_frames = 1;  // nothing is drawn from two
  Loop run;
  Chosen chosen;
  for (int f = 0; f < 40; ++f) {
    run.frame(forest.tree, {}, walk(1, f), options);
    chosen.polygons += int(run.plan.polygons.size());
    chosen.captures += int(run.plan.captures.size());
  }
  return chosen;
}

TEST(MachineCosts, where_triangles_are_dear_the_planner_captures_what_it_else_draws) {
  // The nearest trees live so briefly that their 2000 triangles are cheaper, where one takes as
  // long as a pixel or two.
  MachineCosts cheap = builtin_machine();
  cheap.draw_software.triangle_ns = 10;
  cheap.draw_software.object_ns = 100;
  MachineCosts dear = cheap;
  dear.draw_software.triangle_ns *= 100;
  const Chosen drawn = walk_on(cheap), captured = walk_on(dear);
  EXPECT_GT(drawn.polygons, 400);
  // What is too near for pictures stays.
  EXPECT_LT(captured.polygons, drawn.polygons / 2);
  EXPECT_GT(captured.captures, drawn.captures + 20);
}

TEST(MeasuredCosts, are_of_a_scene_whose_runs_differ_in_one_thing_only) {
  const MeasuredScene scene = measured_scene();
  const auto total = [](const MeasuredRun& run) { return double(run.count * run.triangles); };
  // Objects: many more, with as many triangles, or nearly so.
  EXPECT_GT(scene.small.count, 10 * scene.light.count);
  EXPECT_NEAR(total(scene.small) / total(scene.light), 1, 0.25);
  // Triangles: several times as many, in objects of the same place and size.
  ASSERT_EQ(scene.heavy.count, scene.light.count);
  EXPECT_GT(total(scene.heavy), 3 * total(scene.light));
  for (std::uint32_t i = 0; i < scene.heavy.count; ++i)
    EXPECT_EQ(scene.scene.objects[scene.heavy.first + i].placement,
              scene.scene.objects[scene.light.first + i].placement);
  EXPECT_TRUE(validate(scene.scene).ok());
  ASSERT_EQ(scene.pictures.size(), scene.light.count + scene.small.count);
  for (const DepthImage& picture : scene.pictures) {
    EXPECT_TRUE(validate(picture).ok());
    int covered = 0;
    for (int y = 0; y < picture.camera.height; ++y)
      for (int x = 0; x < picture.camera.width; ++x) covered += picture.covered(x, y);
    // A disc in its square, with a margin of 5 % and up to 3 % more because of its front: 0.67 to
    // 0.71. With 20 texels across a row of them is 5 %.
    const double share = double(covered) / (picture.camera.width * picture.camera.height);
    EXPECT_GT(share, 0.62);
    EXPECT_LT(share, 0.76);
  }
}

TEST(MeasuredCosts, of_this_machine_can_be_stored_and_used) {
  const Result<MachineCosts> measured = measure_software();
  ASSERT_TRUE(measured.ok()) << measured.error().message();
  EXPECT_FALSE(measured->draw_opengl || measured->capture_opengl);
  const Result<MachineCosts> stored = parse_machine(machine_json(*measured), "stored");
  ASSERT_TRUE(stored.ok()) << stored.error().message();
  EXPECT_EQ(*stored, *measured);
  CacheOptions options;
  CostClock clock;
  use_machine(*stored, DrawnBy::software, true, options, clock);
  EXPECT_GT(options.cost.picture_pixel, 0);
  EXPECT_GE(options.picture_triangles, 1u);
}

}  // namespace
}  // namespace rilievo
