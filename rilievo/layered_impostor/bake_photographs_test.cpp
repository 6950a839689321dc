#include "rilievo/layered_impostor/bake_photographs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "rilievo/capture/photograph_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/io/rgbd_test_helpers.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

// The jug on a table, photographed from an arc of `count` places.
std::vector<DepthImage> photographs_of_jug(const RayScene& rays, int count, double arc) {
  std::vector<DepthImage> pictures;
  for (int i = 0; i < count; ++i) {
    const double a = arc * (i - 0.5 * (count - 1)) / count;
    pictures.push_back(cast_picture(rays, look_at({6 * std::sin(a), 2, 6 * std::cos(a)}, {0, 0, 0},
                                                  {0, 1, 0}, 0.7, 160, 120, 0.5, 30)));
    pictures.back().object = {};
  }
  return pictures;
}

struct Shown {
  int both = 0, far = 0, missing = 0, inside = 0;
  double color_error = 0;
};

// Pixels whose neighbours show the same surface too.
Shown compare(const DepthImage& truth, const DepthImage& frame) {
  Shown shown;
  for (int y = 1; y + 1 < truth.camera.height; ++y)
    for (int x = 1; x + 1 < truth.camera.width; ++x) {
      bool inside = truth.covered(x, y);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          inside = inside && std::abs(truth.depth(x + dx, y + dy) - truth.depth(x, y)) < 0.2f;
      if (!inside) continue;
      ++shown.inside;
      if (!frame.covered(x, y)) {
        ++shown.missing;
        continue;
      }
      ++shown.both;
      shown.far += std::abs(truth.depth(x, y) - frame.depth(x, y)) > 0.15f;
      shown.color_error += double(glm::length(truth.color(x, y) - frame.color(x, y)));
    }
  return shown;
}

TEST(BakePhotographs, a_camera_between_the_others_sees_what_it_would) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  for (PhotographViews kind : {PhotographViews::at_cameras, PhotographViews::around}) {
    std::vector<DepthImage> photographs = photographs_of_jug(*rays, 9, 1.2);
    const DepthImage truth = photographs[4];
    photographs.erase(photographs.begin() + 4);
    PhotographBakeOptions options;
    options.kind = kind;
    options.reproject.box = measured_bounds(photographs, 0.0);
    options.camera.size = 160;
    const Result<PhotographBake> bake = bake_photographs(photographs, options);
    ASSERT_TRUE(bake) << bake.error().message();
    EXPECT_EQ(bake->stats.size(), kind == PhotographViews::around ? 32u : 8u);
    const Shown shown = compare(truth, warp_surfaces(bake->impostor, truth.camera));
    EXPECT_GT(shown.inside, 2000);
    // Half a texel is lost at every outline, and what the handle hides of the body.
    EXPECT_LT(shown.missing, 0.02 * shown.inside);
    EXPECT_LT(shown.far, 0.03 * shown.both);
    EXPECT_LT(shown.color_error, 0.03 * shown.both);
  }
}

TEST(BakePhotographs, its_default_view_is_upright_and_looks_from_where_it_was_photographed) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> photographs = photographs_of_jug(*rays, 5, 1.0);
  // A world in which +y is down and aslant.
  glm::dmat4 turn = glm::rotate(glm::dmat4(1), 2.8, glm::normalize(glm::dvec3(1, 0.2, 0.3)));
  turn[3] = {3, -2, 1, 1};
  for (DepthImage& p : photographs) p.camera.world_from_eye = turn * p.camera.world_from_eye;
  PhotographBakeOptions options;
  options.reproject.box = measured_bounds(photographs, 0.0);
  Result<PhotographBake> bake = bake_photographs(photographs, options);
  ASSERT_TRUE(bake) << bake.error().message();
  const Vantage& vantage = bake->impostor.vantage;
  // All look down by 18 degrees, and to one side by at most 23: part of it is taken for theirs.
  EXPECT_GT(glm::dot(vantage.up, glm::dvec3(turn[1])), std::cos(0.32));
  ASSERT_TRUE(vantage.gaze);
  EXPECT_EQ(vantage.gaze->eye, photographs[2].camera.position());
  const CameraPath path = orbit_path(bake->impostor.bounds, 1, vantage);
  const DepthImage frame = warp_surfaces(bake->impostor, camera_at(path, 0, 64, 48));
  EXPECT_TRUE(frame.covered(32, 24));  // the jug, at which all were pointed
  // Who knows better says so.
  options.up = glm::dvec3(0, 0, -7);
  bake = bake_photographs(photographs, options);
  ASSERT_TRUE(bake);
  EXPECT_EQ(bake->impostor.vantage.up, glm::dvec3(0, 0, -1));
}

TEST(BakePhotographs, a_hole_in_one_picture_does_not_hide_what_another_knows) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> pictures = photographs_of_jug(*rays, 2, 0.3);
  const Camera camera = pictures[0].camera;
  const DepthImage truth = pictures[0];
  // The first lost its middle.
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) pictures[0].depth(x, y) = kNoDepth;
  const auto missing = [&](const std::vector<DepthImage>& from) {
    const Result<LayeredImpostor> impostor = make_layered_impostor(from, {});
    return compare(truth, warp_surfaces(*impostor, camera, {.handover = 0})).missing;
  };
  // With its colour there it is a hole, which the other fills.
  EXPECT_LT(missing(pictures), 160);
  const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {});
  EXPECT_FALSE(impostor->complete[0]);
  EXPECT_TRUE(impostor->complete[1]);
  // Without, nothing was there.
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) pictures[0].color(x, y) = glm::vec4(0);
  EXPECT_GT(missing(pictures), 800);
  EXPECT_TRUE(make_layered_impostor(pictures, {})->complete[0]);
}

TEST(BakePhotographs, a_picture_that_cuts_the_object_off_does_not_know_what_lies_beyond) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> pictures = photographs_of_jug(*rays, 2, 0.3);
  Camera half = pictures[0].camera;
  half.window.right = 0;
  half.width /= 2;
  pictures[0] = cast_picture(*rays, half);
  const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {});
  EXPECT_FALSE(impostor->complete[0]);
  EXPECT_TRUE(impostor->complete[1]);
}

TEST(BakePhotographs, what_cannot_be_baked_is_refused) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  const std::vector<DepthImage> photographs = photographs_of_jug(*rays, 3, 1);
  PhotographBakeOptions options;
  EXPECT_FALSE(bake_photographs(photographs, options));
  options.reproject.box = {{10, 10, 10}, {11, 11, 11}};
  EXPECT_FALSE(bake_photographs(photographs, options));
  options.kind = PhotographViews::around;
  EXPECT_FALSE(bake_photographs(photographs, options));
  EXPECT_FALSE(bake_photographs({}, options));
}

TEST(BakePhotographs, options_of_views_around_need_them) {
  const Scene scene = test_shapes::jug();
  PhotographSource source("photographs", photographs_of_jug(*RayScene::create(scene), 2, 1));
  for (const auto& [name, value] :
       {std::pair("views", "12"), {"ring", "4"}, {"hemisphere", "on"}, {"size", "16"}}) {
    OptionValues values(layered_impostor_kind().bake_options);
    ASSERT_TRUE(values.set(name, value).ok());
    const Result<Baked> baked = layered_impostor_kind().bake({source, {}}, values, {});
    ASSERT_FALSE(baked.ok()) << name;
    EXPECT_EQ(baked.error().where, std::string("--") + name);
  }
  OptionValues values(layered_impostor_kind().bake_options);
  for (const auto& [name, value] : {std::pair("around", "on"), {"views", "12"}, {"size", "16"}})
    ASSERT_TRUE(values.set(name, value).ok());
  const Result<Baked> baked = layered_impostor_kind().bake({source, {}}, values, {});
  EXPECT_TRUE(baked.ok()) << baked.error().message();
}

// From files of all three kinds the same pictures, but for millimetres and 8 bits.
TEST(BakePhotographs, files_of_every_kind_bake_alike) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  const std::vector<DepthImage> photographs = photographs_of_jug(*rays, 4, 1);
  PhotographBakeOptions options;
  options.kind = PhotographViews::at_cameras;
  options.reproject.box = measured_bounds(photographs, 0.0);
  const Result<PhotographBake> truth = bake_photographs(photographs, options);
  for (RgbdFormat format : {RgbdFormat::nerfstudio, RgbdFormat::redwood, RgbdFormat::pose_files}) {
    const TemporaryFolder folder;
    test_rgbd::write_capture(folder.path(), format, photographs);
    const Result<RgbdCapture> capture = open_rgbd_capture(folder.path());
    ASSERT_TRUE(capture) << capture.error().message();
    std::vector<DepthImage> read;
    for (const RgbdFrame& frame : capture->frames) read.push_back(*load_rgbd_frame(frame));
    for (std::size_t i = 0; i < read.size(); ++i)
      for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x) {
          ASSERT_EQ(read[i].covered(x, y), photographs[i].covered(x, y));
          if (read[i].covered(x, y)) {
            EXPECT_NEAR(read[i].depth(x, y), photographs[i].depth(x, y), 0.000501);
          }
        }
    const Result<PhotographBake> bake = bake_photographs(read, options);
    ASSERT_TRUE(bake) << bake.error().message();
    EXPECT_NEAR(double(bake->total.filled), double(truth->total.filled),
                0.01 * double(truth->total.filled));
  }
}

// Each capture without its middle photograph, which is drawn: the mean difference in linear light,
// and the share that is not drawn, of the pixels that were measured.
TEST(BakePhotographs, real_captures_show_the_photograph_that_was_left_out) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  // When this was written 0.015, and 0.059 where colours are not registered with depth; at most
  // 0.4 % missing.
  for (const auto& [name, difference] :
       {std::pair("tsdf_fusion_room", 0.09), {"open3d_redwood", 0.025}}) {
    if (kSanitized && name != std::string("tsdf_fusion_room")) continue;
    const Result<RgbdCapture> capture =
        open_rgbd_capture(std::filesystem::path(data) / "rgbd" / name);
    ASSERT_TRUE(capture) << capture.error().message();
    std::vector<DepthImage> photographs;
    for (const RgbdFrame& frame : capture->frames) photographs.push_back(*load_rgbd_frame(frame));
    const std::ptrdiff_t middle = std::ptrdiff_t(photographs.size() / 2);
    const DepthImage truth = photographs[std::size_t(middle)];
    photographs.erase(photographs.begin() + middle);
    PhotographBakeOptions options;
    options.reproject.box = measured_bounds(photographs, 0.0);
    const Result<PhotographBake> bake = bake_photographs(photographs, options);
    ASSERT_TRUE(bake) << bake.error().message();
    const DepthImage frame = warp_surfaces(bake->impostor, truth.camera);
    double sum = 0, drawn = 0, missing = 0;
    for (int y = 0; y < truth.camera.height; ++y)
      for (int x = 0; x < truth.camera.width; ++x) {
        if (!truth.covered(x, y)) continue;
        if (!frame.covered(x, y)) {
          ++missing;
          continue;
        }
        ++drawn;
        for (int c = 0; c < 3; ++c)
          sum += double(std::abs(truth.color(x, y)[c] - frame.color(x, y)[c])) / 3;
      }
    EXPECT_LT(sum / drawn, difference) << name;
    EXPECT_LT(missing / (drawn + missing), 0.01) << name;
  }
}

}  // namespace
}  // namespace rilievo
