#include "rilievo/layered_impostor/file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr.h"

namespace rilievo {
namespace {

class Files : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

  static LayeredImpostor jug(ViewSpread spread = ViewSpread::faces_12) {
    Result<LayeredImpostor> impostor = make_layered_impostor(
        test_shapes::cast_views(test_shapes::jug(), make_view_set({.spread = spread, .ring = 5}),
                                {.size = 32}),
        {.layers = 24, .overlap = 0.3f, .spacing = SliceSpacing::window_z});
    return std::move(*impostor);
  }

  // Saves the jug with one attribute, or picture, spoilt, and expects a reason that tells so.
  template <class Spoil>
  void expect_refused(Spoil spoil, const std::string& reason) {
    const LayeredImpostor impostor = jug();
    ASSERT_TRUE(save_layered_impostor(file("good.exr"), impostor).ok());
    Result<PictureFile> pictures = load_picture_file(file("good.exr"));
    ASSERT_TRUE(pictures.ok());
    spoil(*pictures);
    ASSERT_TRUE(save_pictures(file("bad.exr"), pictures->pictures, pictures->attributes).ok());
    const Result<LayeredImpostor> loaded = load_layered_impostor(file("bad.exr"));
    ASSERT_FALSE(loaded.ok()) << reason;
    const std::string message = loaded.error().message();
    EXPECT_TRUE(message.starts_with(file("bad.exr").string() + ": ")) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

 private:
  const TemporaryFolder folder_;
};

TEST_F(Files, what_is_saved_is_loaded) {
  for (ViewSpread spread : {ViewSpread::faces_12, ViewSpread::ring}) {
    LayeredImpostor impostor = jug(spread);
    impostor.fills = neighbor_pairs(impostor.views);
    for (FillSlices& fill : impostor.fills) {
      const std::vector<Slice>& slices = impostor.slices[fill.neighbor];
      for (int s = fill.view % 3; s < int(slices.size()); s += 4)
        fill.slices.push_back({s, slices[s].rect});
    }
    ASSERT_TRUE(save_layered_impostor(file("jug.exr"), impostor).ok());
    const Result<LayeredImpostor> again = load_layered_impostor(file("jug.exr"));
    ASSERT_TRUE(again.ok()) << again.error().message();
    EXPECT_EQ(again->name, "jug");
    EXPECT_EQ(again->bounds.min, impostor.bounds.min);
    EXPECT_EQ(again->bounds.max, impostor.bounds.max);
    EXPECT_EQ(again->slicing.layers, 24);
    EXPECT_EQ(again->slicing.overlap, 0.3f);
    EXPECT_EQ(again->slicing.spacing, SliceSpacing::window_z);
    EXPECT_TRUE(again->slicing.pieces);
    EXPECT_EQ(again->views.directions, impostor.views.directions);
    EXPECT_EQ(again->views.triangles, impostor.views.triangles);
    ASSERT_EQ(again->pictures.size(), impostor.pictures.size());
    for (std::size_t v = 0; v < impostor.pictures.size(); ++v) {
      EXPECT_EQ(again->pictures[v].camera, impostor.pictures[v].camera);
      EXPECT_EQ(again->pictures[v].depth, impostor.pictures[v].depth);
      EXPECT_EQ(again->pictures[v].object, impostor.pictures[v].object);
      ASSERT_EQ(again->slices[v].size(), impostor.slices[v].size());
      for (std::size_t s = 0; s < impostor.slices[v].size(); ++s) {
        EXPECT_EQ(again->slices[v][s].rect, impostor.slices[v][s].rect);
        EXPECT_EQ(again->slices[v][s].eye_z, impostor.slices[v][s].eye_z);
      }
    }
    ASSERT_EQ(again->fills.size(), impostor.fills.size());
    for (std::size_t f = 0; f < impostor.fills.size(); ++f) {
      EXPECT_EQ(again->fills[f].view, impostor.fills[f].view);
      EXPECT_EQ(again->fills[f].neighbor, impostor.fills[f].neighbor);
      EXPECT_EQ(again->fills[f].slices, impostor.fills[f].slices);
    }
  }
}

TEST_F(Files, holes_not_looked_for_stay_so) {
  ASSERT_TRUE(save_layered_impostor(file("jug.exr"), jug()).ok());
  const Result<LayeredImpostor> again = load_layered_impostor(file("jug.exr"));
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(again->fills.empty());
}

TEST_F(Files, the_vantage_is_kept_and_older_files_have_the_usual_one) {
  LayeredImpostor impostor = jug();
  ASSERT_TRUE(save_layered_impostor(file("jug.exr"), impostor).ok());
  Result<PictureFile> older = load_picture_file(file("jug.exr"));
  ASSERT_TRUE(older.ok());
  // Files written before there was a vantage have neither attribute; nor have those of scenes.
  EXPECT_EQ(older->attributes.file.count("up") + older->attributes.file.count("gaze"), 0u);
  EXPECT_EQ(load_layered_impostor(file("jug.exr"))->vantage, Vantage{});
  impostor.vantage.up = glm::normalize(glm::dvec3(0.1, -0.9, 0.3));
  impostor.vantage.gaze = Vantage::Gaze{{0.1, 1e-17, -3}, {1.0 / 3, 2, 5e5}};
  ASSERT_TRUE(save_layered_impostor(file("jug.exr"), impostor).ok());
  const Result<LayeredImpostor> again = load_layered_impostor(file("jug.exr"));
  ASSERT_TRUE(again.ok()) << again.error().message();
  // 1e-15: it is made of unit length again.
  EXPECT_LT(glm::distance(again->vantage.up, impostor.vantage.up), 1e-15);
  EXPECT_EQ(again->vantage.gaze, impostor.vantage.gaze);
}

TEST_F(Files, a_vantage_that_is_none_is_refused) {
  for (const char* up : {"", "0 0 0", "0 1", "0 1 0 0", "nan 1 0", "0 inf 0", "y"})
    expect_refused([&](PictureFile& f) { f.attributes.file["up"] = up; }, "could be up");
  for (const char* gaze :
       {"", "0 0 0", "0 0 0 0 0 0", "1 2 3 1 5 3", "0 0 0 nan 1 1", "0 0 0 1 1 1 1", "0 0 0 1 1 x"})
    expect_refused([&](PictureFile& f) { f.attributes.file["gaze"] = gaze; }, "looks at");
}

TEST_F(Files, what_is_no_layered_impostor_is_refused_with_its_name_and_a_reason) {
  expect_refused([](PictureFile& f) { f.attributes.file.erase("representation"); },
                 "not a layered impostor");
  expect_refused([](PictureFile& f) { f.attributes.file["representation"] = "nailboards"; },
                 "not a layered impostor");
  expect_refused([](PictureFile& f) { f.attributes.file.erase("slicing"); }, "sliced");
  for (const char* slicing :
       {"", "64", "0 0 eye_z pieces", "64 -1 eye_z pieces", "64 nan eye_z pieces",
        "64 0 1/z pieces", "64 0 eye_z", "9999999999 0 eye_z pieces", "64 0 eye_z pieces more"})
    expect_refused([&](PictureFile& f) { f.attributes.file["slicing"] = slicing; },
                   "not a way to slice");
  expect_refused([](PictureFile& f) { f.pictures[2] = f.pictures[1]; }, "same way");
  expect_refused([](PictureFile& f) { f.pictures[2].camera.projection = Projection::parallel; },
                 "parallel");
  expect_refused(
      [](PictureFile& f) {
        for (DepthImage& p : f.pictures)
          for (float& d : p.depth.texels()) d = kNoDepth;
      },
      "empty");
}

TEST_F(Files, fills_that_contradict_the_views_are_refused) {
  const auto fills = [&](const std::string& text) {
    return [text](PictureFile& f) {
      for (Attributes& a : f.attributes.pictures) a["fills"] = "";
      f.attributes.pictures[0]["fills"] = text;
    };
  };
  expect_refused([](PictureFile& f) { f.attributes.pictures[4]["fills"] = ""; }, "not all");
  expect_refused(fills("a few"), "fills holes");
  expect_refused(fills("1 2 3 4 5"), "fills holes");
  expect_refused(fills("0 2 0 0 1 1"), "no neighbour");
  expect_refused(fills("99 2 0 0 1 1"), "no neighbour");
  const LayeredImpostor impostor = jug();
  const std::string neighbor = std::to_string(neighbor_pairs(impostor.views)[0].neighbor);
  expect_refused(fills(neighbor + " 2000 0 0 1 1"), "empty");
  expect_refused(fills(neighbor + " 12 0 0 33 1"), "fills holes");
  expect_refused(fills(neighbor + " 12 5 0 5 1"), "fills holes");
}

TEST_F(Files, other_peoples_files_are_refused) {
  EXPECT_FALSE(load_layered_impostor(file("missing.exr")).ok());
  DepthImage picture = jug().pictures[0];
  ASSERT_TRUE(save_pictures(file("picture.exr"), std::span(&picture, 1)).ok());
  const Result<LayeredImpostor> loaded = load_layered_impostor(file("picture.exr"));
  ASSERT_FALSE(loaded.ok());
  EXPECT_NE(loaded.error().message().find("not a layered impostor"), std::string::npos);
}

}  // namespace
}  // namespace rilievo
