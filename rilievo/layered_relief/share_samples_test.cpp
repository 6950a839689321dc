// What do pictures lack of faces that they graze, before and after they share samples?
#include "rilievo/layered_relief/share_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <unordered_set>
#include <utility>
#include <vector>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_relief/between_samples.h"
#include "rilievo/layered_relief/relief_bound.h"
#include "rilievo/layered_relief/relief_drawable.h"
#include "rilievo/layered_relief/two_sided_ball_test_helpers.h"
#include "rilievo/nailboard/software/software_boards.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

constexpr int kPixels = 96;

glm::vec3 random_direction(Random& random) {
  for (;;) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    const glm::vec3 v(x, y, z);
    if (const float length = glm::length(v); length > 0.1f && length < 1) return v / length;
  }
}

// Boxes and balls that hide parts of each other; some boxes stand along the axes, so that
// pictures see their sides edge-on.
Scene random_scene(Random& random) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 at = 0.6f * random_direction(random);
    glm::mat4 pose = glm::translate(glm::mat4(1), at);
    if (i % 2) {
      const float turn = random.between(0, 3);
      pose = glm::rotate(pose, turn, random_direction(random));
    }
    const float size = random.between(0.25f, 0.5f);
    const glm::vec3 color(random.unit(), 0.5f, 0.3f);
    test_shapes::add(scene, i == 3 ? test_shapes::sphere(size) : test_shapes::box(glm::vec3(size)),
                     color, pose);
  }
  finish(scene);
  return scene;
}

// Of the pixels that show something.
struct Lacking {
  int pixels = 0, cracks = 0, violations = 0;
  double largest = 0;  // distance to where it is shown, over the bound
};

// How far, in pixels, is the nearest pixel that shows what the truth shows, or something before
// it?
double distance_to_shown(const Image<float>& shown, int x, int y, float farthest, int most) {
  double least = 1e9;
  for (int v = std::max(0, y - most); v <= std::min(shown.height() - 1, y + most); ++v)
    for (int u = std::max(0, x - most); u <= std::min(shown.width() - 1, x + most); ++u)
      if (shown(u, v) <= farthest) least = std::min(least, std::hypot(u - x, v - y));
  return least;
}

// Draws what was captured for random eyes around it, as frames are drawn, beside the truth by
// rays. `reach`: metres to the nearest sample, as far as is known.
Lacking look(const RayScene& rays, const ReliefPictures& pictures, double reach, double splat,
             Random& random, int eyes) {
  SoftwareBoards boards;
  PrewarpOptions options;
  options.splat_size = splat;
  options.max_size = 2048;
  auto drawable = make_relief_drawable(pictures, boards, options);
  EXPECT_TRUE(drawable.ok());
  const ErrorModel model = (*drawable)->error_model(0);
  (*drawable)->set_samples(1);
  SoftwareTarget target(kPixels, kPixels, 1);
  const Box box = world_bounds(rays.scene());
  const double radius = double(box.radius());
  Lacking found;
  for (int e = 0; e < eyes; ++e) {
    const glm::dvec3 to(random_direction(random));
    const double distance = double(random.between(2.2f, 5)) * radius;
    const glm::dvec3 center(box.center());
    const Camera camera =
        look_at(center + distance * to, center, glm::dvec3(0.1, 1, 0.2), 2.1 * radius / distance,
                kPixels, kPixels, 0.05 * radius, 20 * radius);
    const double gap_px = model.gap_px(glm::dmat4(1), camera);
    if (!std::isfinite(model.bound_px(glm::dmat4(1), camera))) continue;
    const Instance instance;
    (*drawable)->draw(camera, {&instance, 1}, Output::color);
    const TileDrawer* drawers[] = {(*drawable)->tiles()};
    target.draw(camera.z_far, drawers);
    const Image<float> shown = target.eye_z();
    const DepthImage truth = cast_picture(rays, camera);
    // Which the bound leaves to pixels.
    const double slack = std::sqrt(0.5);
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        if (!truth.covered(x, y)) continue;
        ++found.pixels;
        const double z =
            eye_z_from(truth.depth_kind, double(truth.depth(x, y)), camera, {x + 0.5, y + 0.5});
        // A sample of the same surface may lie deeper by as much as it is away.
        const float farthest = float(z + reach);
        if (shown(x, y) <= farthest) continue;
        ++found.cracks;
        const double allowed = 0.5 * gap_px + slack;
        // Without a bound, anywhere in the frame.
        const int most = int(std::min(std::ceil(allowed), double(kPixels)));
        const double px = distance_to_shown(shown, x, y, farthest, most);
        found.violations += px > allowed;
        found.largest = std::max(found.largest, px / allowed);
      }
  }
  return found;
}

ReliefPictures captured(const RayScene& rays, double share, int size, double merge = 0.1) {
  RaySource source(rays);
  auto made = capture_relief_pictures(source, {},
                                      {.size = size, .merge_texels = merge, .share_texels = share});
  EXPECT_TRUE(made.ok());
  return *std::move(made);
}

std::size_t samples_of(const ReliefPictures& pictures) {
  std::size_t sum = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    sum += picture.layers.samples.size();
  return sum;
}

// Where the samples stand.
std::vector<glm::dvec3> places_of(const LayeredDepthImage& layers) {
  std::vector<glm::dvec3> places;
  const int width = layers.camera.width;
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i)
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      const glm::dvec2 at(int(i) % width + 0.5, int(i) / width + 0.5);
      places.push_back(world_from_raster(
          layers.camera, at,
          eye_z_from(layers.depth_kind, double(layers.samples[s].depth), layers.camera, at)));
    }
  return places;
}

TEST(ShareSamples, no_crack_is_wider_than_the_bound) {
  Random random(31);
  Lacking shared, own;
  double ratio = 0;
  constexpr int kScenes = 12;
  for (int i = 0; i < kScenes; ++i) {
    const Scene scene = random_scene(random);
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    // Texels of a pixel, of two, and of half of one, which are averaged.
    const int size = i % 3 == 0 ? 64 : i % 3 == 1 ? 32 : 128;
    const ReliefPictures with = captured(*rays, i % 2 ? 0.75 : 1.0, size),
                         without = captured(*rays, 0, size);
    ratio += double(samples_of(with)) / double(samples_of(without)) / kScenes;
    const auto add = [](Lacking& to, const Lacking& one) {
      to.pixels += one.pixels, to.cracks += one.cracks, to.violations += one.violations;
      to.largest = std::max(to.largest, one.largest);
    };
    Random again = random;
    const int eyes = sanitized_cases(200);
    double reach = 0;
    for (const ReliefPictures::Picture& picture : with.pictures)
      reach = std::max(reach, picture.lacks);
    const double splat = i % 4 < 2 ? 1.5 : 2.0;
    add(shared, look(*rays, with, reach, splat, random, eyes));
    add(own, look(*rays, without, reach, splat, again, std::max(1, eyes / 8)));
  }
  const double shared_share = double(shared.cracks) / shared.pixels,
               own_share = double(own.cracks) / own.pixels;
  RecordProperty("cracks", std::to_string(shared_share));
  RecordProperty("cracks_without", std::to_string(own_share));
  RecordProperty("largest_over_bound", std::to_string(shared.largest));
  RecordProperty("samples_over_own", std::to_string(ratio));
  EXPECT_EQ(shared.violations, 0) << "of " << shared.pixels << " pixels";
  EXPECT_LT(shared_share, 0.2 * own_share);
  EXPECT_GT(shared.largest, 0.5);  // the bound is no more than twice too large
  if (std::getenv("RILIEVO_SHOW"))
    std::printf(
        "cracks %.4f %% (without sharing %.4f %%), widest %.2f of the bound, samples %.2f\n",
        100 * shared_share, 100 * own_share, shared.largest, ratio);
}

TEST(ShareSamples, each_sample_added_stands_within_moved_of_one_that_was_seen_or_between_two) {
  Random random(32);
  const Scene scene = random_scene(random);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  const ReliefPictures before = captured(*rays, 0, 24);
  ReliefPictures after = before;
  share_samples(after, 1);
  std::vector<glm::dvec3> seen, known;
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : before.pictures) {
    for (const glm::dvec3& p : places_of(picture.layers)) seen.push_back(p);
    all.push_back(&picture.layers);
  }
  known = seen;
  const std::unordered_set<std::uint32_t> closed = find_closed_objects(all);
  for (const LayeredDepthImage* layers : all) {
    const SampleSides sides(*layers, closed);
    SurfaceLattice(sides).each_place(
        kBetween * texel_angle(layers->camera), [](std::size_t) { return true; },
        [&](const PlaceBetween& place) { known.push_back(place.world); });
  }
  for (std::size_t k = 0; k < after.pictures.size(); ++k) {
    const ReliefPictures::Picture& picture = after.pictures[k];
    EXPECT_TRUE(validate(picture.layers).ok());
    EXPECT_GT(picture.layers.samples.size(), before.pictures[k].layers.samples.size());
    EXPECT_GT(picture.moved, 0);
    const std::vector<glm::dvec3> now = places_of(picture.layers);
    for (const glm::dvec3& p : now) {
      double least = 1e9;
      for (const glm::dvec3& q : known) least = std::min(least, glm::distance(p, q));
      ASSERT_LE(least, picture.moved + 1e-5);  // depths are floats
    }
    // And each that was seen has one beside it, as lacks claims.
    for (std::size_t i = 0; i < seen.size(); i += 7) {
      double least = 1e9;
      for (const glm::dvec3& p : now) least = std::min(least, glm::distance(p, seen[i]));
      ASSERT_LE(least, picture.lacks);
    }
  }
}

// By definition: of the others' samples, one after the other, those that have none within
// `reach` units; then of the places between samples. Lines of sight, and depths along them.
std::vector<std::pair<int, float>> shared_by_definition(const ReliefPictures& pictures,
                                                        std::size_t k, double reach) {
  const LayeredDepthImage& to = pictures.pictures[k].layers;
  const Camera& camera = to.camera;
  const double texel = (camera.window.right - camera.window.left) / camera.width;
  // Those with finer texels than others get fewer samples, for larger splats.
  double coarser = 1;
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    coarser = std::max(coarser, texel_angle(picture.layers.camera) / texel);
  const double unit = texel * std::pow(std::min(coarser, 2.0), 0.25), metres = reach * unit;
  std::vector<std::pair<int, float>> samples;
  std::vector<glm::dvec3> places;  // across and along, metres
  const auto add = [&](int line, float depth) {
    const glm::dvec2 at(line % camera.width + 0.5, line / camera.width + 0.5);
    samples.emplace_back(line, depth);
    places.emplace_back(texel * at, eye_z_from(to.depth_kind, double(depth), camera, at));
  };
  for (std::size_t line = 0; line + 1 < to.first.size(); ++line)
    for (std::uint64_t s = to.first[line]; s < to.first[line + 1]; ++s)
      add(int(line), to.samples[s].depth);
  // By turns: those of the side that the picture's viewers see come first.
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : pictures.pictures) all.push_back(&picture.layers);
  const std::unordered_set<std::uint32_t> closed = find_closed_objects(all);
  const std::size_t count = pictures.pictures.size();
  const auto offer = [&](const glm::dvec3& world) {
    const glm::dvec3 there = raster_from_world(camera, world);
    // Places between samples may lie beside the picture.
    if (there.x < -1e-3 || there.y < -1e-3 || there.x > camera.width + 1e-3 ||
        there.y > camera.height + 1e-3)
      return;
    const glm::dvec3 place(texel * glm::dvec2(there), there.z);
    if (std::any_of(places.begin(), places.end(),
                    [&](const glm::dvec3& other) { return glm::distance(other, place) <= metres; }))
      return;
    const int x = std::clamp(int(there.x), 0, camera.width - 1),
              y = std::clamp(int(there.y), 0, camera.height - 1);
    add(y * camera.width + x,
        float(depth_from_eye_z(to.depth_kind, there.z, camera, glm::dvec2(x + 0.5, y + 0.5))));
  };
  for (std::size_t n = 0; n < SampleSides::kTurns * count; ++n) {
    const std::size_t j = n % count;
    if (j == k) continue;
    const LayeredDepthImage& from = pictures.pictures[j].layers;
    const SampleSides sides(from, closed);
    const int width = from.camera.width;
    for (std::size_t line = 0; line + 1 < from.first.size(); ++line)
      for (std::uint64_t s = from.first[line]; s < from.first[line + 1]; ++s) {
        if (sides.turn(s, camera.forward()) != int(n / count)) continue;
        const glm::dvec2 at(int(line) % width + 0.5, int(line) / width + 0.5);
        const double z =
            eye_z_from(from.depth_kind, double(from.samples[s].depth), from.camera, at);
        offer(world_from_raster(from.camera, at, z));
      }
  }
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    const SampleSides sides(picture.layers, closed);
    const glm::dvec3 own = picture.layers.camera.forward();
    // Outer sides of closed bodies that face the picture's viewers, or turn away by up to 30
    // degrees, and their own picture's within 60 degrees.
    const auto of = [&](std::size_t sample) {
      const glm::dvec3 normal(sides.normal(sample));
      return sides.is_closed(sample) && sides.is_outer(sample) &&
             -glm::dot(normal, camera.forward()) > -0.5 && -glm::dot(normal, own) >= 0.5;
    };
    SurfaceLattice(sides).each_place(kBetween * unit, of,
                                     [&](const PlaceBetween& place) { offer(place.world); });
  }
  std::sort(samples.begin(), samples.end());
  return samples;
}

TEST(ShareSamples, pictures_get_the_samples_that_have_none_of_their_own_within_reach) {
  Random random(35);
  for (const double reach : {0.6, 0.75, 1.0}) {
    const Scene scene = random_scene(random);
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    const ReliefPictures before = captured(*rays, 0, 24);
    ReliefPictures after = before;
    share_samples(after, reach);
    for (std::size_t k = 0; k < after.pictures.size(); ++k) {
      const LayeredDepthImage& layers = after.pictures[k].layers;
      const Camera& camera = layers.camera;
      // Texels are squares here.
      const double texel = (camera.window.right - camera.window.left) / camera.width;
      EXPECT_NEAR(texel, (camera.window.top - camera.window.bottom) / camera.height, 1e-9);
      std::vector<std::pair<int, float>> samples;
      for (std::size_t line = 0; line + 1 < layers.first.size(); ++line)
        for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s)
          samples.emplace_back(int(line), layers.samples[s].depth);
      std::sort(samples.begin(), samples.end());
      EXPECT_EQ(samples, shared_by_definition(before, k, reach));
      EXPECT_GT(samples.size(), before.pictures[k].layers.samples.size());
    }
  }
}

TEST(ShareSamples, the_inner_side_of_a_body_does_not_pepper_its_outer_side) {
  const ReliefPictures before = two_sided_ball(48);
  ReliefPictures after = before;
  share_samples(after, 0.75);
  int added = 0, peppered = 0;
  for (std::size_t k = 0; k < after.pictures.size(); ++k) {
    const LayeredDepthImage &was = before.pictures[k].layers, &is = after.pictures[k].layers;
    for (std::size_t line = 0; line + 1 < is.first.size(); ++line)
      for (std::uint64_t s = is.first[line]; s < is.first[line + 1]; ++s) {
        bool own = false;
        for (std::uint64_t o = was.first[line]; o < was.first[line + 1]; ++o)
          own = own || was.samples[o].depth == is.samples[s].depth;
        if (own) continue;
        ++added;
        peppered += is.samples[s].color.b > 0.5f;
      }
  }
  EXPECT_GT(added, 1000);
  // What is left turns away from the picture's viewers.
  EXPECT_LE(peppered, added / 40) << "of " << added;
}

// Through a gap between samples of the near side one sees the far side, of which only the outer
// colour is ever to be seen.
TEST(ShareSamples, the_inner_side_of_a_body_has_the_outer_sides_colour) {
  ReliefPictures pictures = two_sided_ball(48);
  share_samples(pictures, 0.75);
  std::size_t all = 0, inner = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    for (const LayerSample& sample : picture.layers.samples) ++all, inner += sample.color.b > 0.5f;
  EXPECT_GT(all, 20000u);
  EXPECT_LE(inner, all / 200);
}

// A ball that shines for each picture where that picture looks: what is beside each other must not
// differ because others saw it.
TEST(ShareSamples, samples_of_several_pictures_side_by_side_have_one_colour) {
  ReliefPictures pictures = two_sided_ball(48);
  for (std::size_t k = 0; k < pictures.pictures.size(); ++k)
    for (LayerSample& sample : pictures.pictures[k].layers.samples)
      sample.color.g = k % 2 ? 1.0f : 0.0f;
  share_samples(pictures, 0.75);
  double differ = 0, count = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    const LayeredDepthImage& layers = picture.layers;
    const double texel = (layers.camera.window.right - layers.camera.window.left) / 48;
    for (std::size_t line = 0; line + 2 < layers.first.size(); ++line)
      for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s)
        for (std::uint64_t t = s + 1; t < layers.first[line + 2]; ++t) {
          if (std::abs(layers.samples[s].depth - layers.samples[t].depth) > 0.5 * texel) continue;
          differ += double(std::abs(layers.samples[s].color.g - layers.samples[t].color.g));
          ++count;
        }
  }
  EXPECT_GT(count, 10000);
  // Colours as they were captured would differ by 1 wherever two pictures meet.
  EXPECT_LT(differ / count, 0.06);
}

// A sheet between two pictures that look at it from above and from below, and one that looks along
// it: green above, blue below. The first two see one side each. Of the third half of the viewers
// see each side: between samples of both there is no step, and the mean is half of either.
TEST(ShareSamples, a_sheet_is_not_peppered_with_its_other_side) {
  ReliefPictures pictures;
  constexpr int kSize = 48;
  for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1), {1, 0, 0}}) {
    const Result<Camera> camera = relief_camera({glm::vec3(-1), glm::vec3(1)}, direction, kSize);
    ASSERT_TRUE(camera);
    LayeredDepthImage layers;
    layers.camera = *camera;
    layers.first = {0};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const CameraRay ray = camera_ray(*camera, {x + 0.5, y + 0.5});
        // The plane z = 0.3 x, within the unit ball: the third picture sees it at 17 degrees.
        const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.3, 0, 1));
        const double t = -glm::dot(ray.origin, normal) / glm::dot(ray.direction, normal);
        const glm::dvec3 at = ray.origin + t * ray.direction;
        if (glm::dot(at, at) < 1) {
          LayerSample sample;
          const bool above = glm::dot(ray.direction, normal) < 0;
          sample.color = {0, above, !above, 1};
          sample.depth = sample.back = float(ray.eye_z_start + t * ray.eye_z_step);
          sample.object = 1;
          layers.samples.push_back(sample);
        }
        layers.first.push_back(layers.samples.size());
      }
    pictures.pictures.push_back({std::move(layers), 0, 0, 0});
  }
  share_samples(pictures, 0.75);
  const auto green = [&](std::size_t k) {
    double sum = 0, squares = 0;
    const std::vector<LayerSample>& samples = pictures.pictures[k].layers.samples;
    for (const LayerSample& sample : samples)
      sum += double(sample.color.g), squares += double(sample.color.g * sample.color.g);
    const double mean = sum / double(samples.size());
    return glm::dvec2(mean,
                      std::sqrt(std::max(0.0, squares / double(samples.size()) - mean * mean)));
  };
  // 45 degrees off the sheet's plane all viewers see one side.
  EXPECT_DOUBLE_EQ(green(0).x, 1);
  EXPECT_DOUBLE_EQ(green(1).x, 0);
  // At 17 degrees a share of (1 + tan(17 degrees)) / 2 of the viewers sees the side below.
  EXPECT_GT(pictures.pictures[2].layers.samples.size(), 1000u);
  EXPECT_NEAR(green(2).x, 0.35, 0.03);
  // Colours as they were seen deviate by 0.48 from their mean. At the sheet's rim some samples have
  // none of the other side within reach.
  EXPECT_LT(green(2).y, 0.12);
}

// What was merged stands elsewhere than where it was seen.
TEST(ShareSamples, what_was_merged_away_has_a_sample_as_near_as_claimed) {
  Random random(37);
  for (int i = 0; i < 3; ++i) {
    const Scene scene = random_scene(random);
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    const ReliefPictures all = captured(*rays, 0, 24, 0);
    for (const double merge : {0.1, 4.0, 8.0}) {
      const ReliefPictures merged = captured(*rays, 0.75, 24, merge);
      double farthest = 0;
      for (const ReliefPictures::Picture& picture : merged.pictures) {
        const std::vector<glm::dvec3> now = places_of(picture.layers);
        EXPECT_GT(picture.lacks, picture.merged);
        for (const ReliefPictures::Picture& seen : all.pictures)
          for (const glm::dvec3& p : places_of(seen.layers)) {
            double least = 1e9;
            for (const glm::dvec3& q : now) least = std::min(least, glm::distance(p, q));
            farthest = std::max(farthest, least / picture.lacks);
          }
      }
      EXPECT_LE(farthest, 1);
    }
  }
}

// Is a bound of cracks claimed of a drawable of these pictures? One of errors always is.
bool claims_cracks(const ReliefPictures& pictures, double splat) {
  SoftwareBoards boards;
  const auto drawable = make_relief_drawable(pictures, boards, {.splat_size = splat});
  EXPECT_TRUE(drawable.ok());
  const Camera camera = look_at({4, 1, 2}, {0, 0, 0}, {0, 1, 0}, 0.6, 64, 64, 0.1, 20);
  const ErrorModel model = (*drawable)->error_model(0);
  EXPECT_TRUE(std::isfinite(model.bound_px(glm::dmat4(1), camera)));
  return std::isfinite(model.gap_px(glm::dmat4(1), camera));
}

// Cracks may be as wide as a face, or splats lie between the middles of all texels of the result.
TEST(ShareSamples, of_cracks_nothing_is_claimed_without_sharing_and_of_splats_below_a_texel) {
  Random random(34);
  const Scene scene = random_scene(random);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  const ReliefPictures shared = captured(*rays, 1, 32);
  EXPECT_FALSE(claims_cracks(captured(*rays, 0, 32), 1.5));
  EXPECT_TRUE(claims_cracks(shared, 1.5));
  EXPECT_FALSE(claims_cracks(shared, 0.25));
  EXPECT_TRUE(claims_cracks(shared, 2.0));
}

}  // namespace
}  // namespace rilievo
