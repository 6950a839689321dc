#include "rilievo/layered_impostor/layered_impostor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

std::vector<DepthImage> jug_pictures(int size, ViewSpread spread = ViewSpread::faces_12) {
  return test_shapes::cast_views(test_shapes::jug(), make_view_set({.spread = spread}),
                                 {.size = size});
}

TEST(LayeredImpostor, every_texel_is_on_every_slice_that_it_reaches_and_rectangles_are_tight) {
  const std::vector<DepthImage> pictures = jug_pictures(40);
  for (float overlap : {0.0f, 0.7f, 3.0f})
    for (bool pieces : {true, false})
      for (SliceSpacing spacing : {SliceSpacing::eye_z, SliceSpacing::window_z}) {
        const SliceOptions options{
            .layers = 20, .overlap = overlap, .pieces = pieces, .spacing = spacing};
        const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, options);
        ASSERT_TRUE(impostor.ok()) << impostor.error().message();
        for (std::size_t v = 0; v < pictures.size(); ++v) {
          const std::vector<Slice>& slices = impostor->slices[v];
          std::vector<TexelRect> tight(slices.size(), TexelRect{1000, 1000, 0, 0});
          for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 40; ++x) {
              if (!pictures[v].covered(x, y)) continue;
              const DepthInterval d = sliced_interval(impostor->surfaces[v].texels(x, y), options);
              if (!pieces) {
                EXPECT_NEAR(d.front, pictures[v].depth(x, y), 1e-6);
              }
              int on = 0;
              for (std::size_t s = 0; s < slices.size(); ++s) {
                if (!(d.back >= slices[s].front && d.front < slices[s].back)) continue;
                ++on;
                TexelRect& r = tight[s];
                r = {std::min(r.x0, x), std::min(r.y0, y), std::max(r.x1, x + 1),
                     std::max(r.y1, y + 1)};
              }
              EXPECT_GE(on, 1);
              if (overlap == 0 && !pieces) {
                EXPECT_EQ(on, 1);
              }
            }
          for (std::size_t s = 0; s < slices.size(); ++s) {
            EXPECT_EQ(tight[s], slices[s].rect);  // none is empty, none is too large
            EXPECT_LT(slices[s].front, slices[s].eye_z);
            EXPECT_GT(slices[s].back, slices[s].eye_z);
          }
        }
      }
}

TEST(LayeredImpostor, slices_stand_evenly_in_the_depth_that_was_asked_for) {
  const std::vector<DepthImage> pictures = jug_pictures(32);
  for (SliceSpacing spacing : {SliceSpacing::eye_z, SliceSpacing::window_z}) {
    const Result<LayeredImpostor> impostor = make_layered_impostor(
        pictures, {.layers = 10, .overlap = 0.5f, .pieces = true, .spacing = spacing});
    const std::vector<Slice>& s = impostor->slices[0];
    ASSERT_EQ(s.size(), 10u);
    const auto place = [&](float z) { return spacing == SliceSpacing::eye_z ? z : 1 / z; };
    const float step = place(s[1].eye_z) - place(s[0].eye_z);
    for (int i = 1; i < 10; ++i) EXPECT_NEAR(place(s[i].eye_z) - place(s[i - 1].eye_z), step, 1e-5);
    // A quarter of a slice beyond, at either end.
    EXPECT_NEAR(place(s[5].back) - place(s[5].eye_z), 0.75f * step, 1e-5);
    EXPECT_NEAR(place(s[5].eye_z) - place(s[5].front), 0.75f * step, 1e-5);
  }
}

TEST(LayeredImpostor, figures_count_what_is_there) {
  const Result<LayeredImpostor> impostor =
      make_layered_impostor(jug_pictures(64, ViewSpread::both_32), {.layers = 64});
  const LayeredStats stats = analyze_layered_impostor(*impostor);
  // Table 2: 32 images of 64 x 64.
  EXPECT_EQ(stats.paper_bytes, 524288u);
  EXPECT_EQ(stats.slices + stats.empty_slices, 32u * 64u);
  std::size_t texels = 0, slices = 0;
  for (const auto& list : impostor->slices)
    for (const Slice& s : list) texels += s.rect.area(), ++slices;
  EXPECT_EQ(stats.slices, slices);
  EXPECT_NEAR(stats.fill_saved, 1 - double(texels) / (32.0 * 64 * 64 * 64), 1e-12);
  EXPECT_GT(stats.fill_saved, 0.3);  // a round thing leaves much of each slice empty
}

TEST(LayeredImpostor, views_are_those_of_the_cameras) {
  const ViewSet views = make_view_set({.spread = ViewSpread::vertices_20});
  for (Projection kind : {Projection::back_perspective, Projection::perspective}) {
    const Result<LayeredImpostor> impostor = make_layered_impostor(
        test_shapes::cast_views(test_shapes::jug(), views, {.projection = kind, .size = 16}), {});
    ASSERT_TRUE(impostor.ok());
    for (int i = 0; i < 20; ++i)
      EXPECT_LT(glm::length(impostor->views.directions[i] - views.directions[i]), 1e-9);
    EXPECT_EQ(impostor->views.triangles, views.triangles);
  }
}

// Drawing looks up the object of every picture if the pictures show several.
TEST(LayeredImpostor, all_pictures_name_objects_if_one_does) {
  std::vector<DepthImage> pictures = jug_pictures(16);
  const Image<std::uint32_t> named = pictures[3].object;
  ASSERT_FALSE(named.empty());
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (i != 3) pictures[i].object = {};
  Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {});
  ASSERT_TRUE(impostor.ok()) << impostor.error().message();
  for (std::size_t i = 0; i < pictures.size(); ++i)
    EXPECT_EQ(impostor->pictures[i].object,
              i == 3 ? named : Image<std::uint32_t>(16, 16, kNoObject));
  pictures[3].object = {};
  impostor = make_layered_impostor(pictures, {});
  ASSERT_TRUE(impostor.ok()) << impostor.error().message();
  for (const DepthImage& picture : impostor->pictures) EXPECT_TRUE(picture.object.empty());
}

TEST(LayeredImpostor, what_is_not_one_is_refused) {
  const std::vector<DepthImage> good = jug_pictures(16);
  EXPECT_TRUE(make_layered_impostor(good, {}).ok());
  EXPECT_FALSE(make_layered_impostor({}, {}).ok());
  const auto refused = [&](auto spoil) {
    std::vector<DepthImage> pictures = good;
    spoil(pictures);
    return !make_layered_impostor(std::move(pictures), {}).ok();
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refused([&](auto& p) { p[3].depth(8, 8) = nan; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3].depth(8, 8) = -1; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3].color(8, 8).g = nan; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3].camera.world_from_eye[0] *= 2.0; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3].camera.projection = Projection::parallel; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3] = p[5]; }));
  EXPECT_TRUE(refused([&](auto& p) { p[3].depth = Image<float>(8, 8); }));
  EXPECT_TRUE(refused([&](auto& pictures) {
    for (DepthImage& p : pictures)
      for (float& d : p.depth.texels()) d = kNoDepth;
  }));
}

}  // namespace
}  // namespace rilievo
