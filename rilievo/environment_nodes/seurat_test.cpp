#include "rilievo/environment_nodes/seurat.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/seurat_test_helpers.h"
#include "rilievo/io/exr_channels.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

EnvironmentMap small_node() {
  return make_node(8, furnished_room(),
                   [](const glm::dvec3& d, double) {
                     return glm::vec4(0.5f + 0.1f * glm::vec3(glm::normalize(d)), 1.0f);
                   },
                   {0.5, -1, 2});
}

Json manifest_of(const fs::path& folder) {
  const Result<std::string> text = read_file(folder / "manifest.json", 1u << 20);
  EXPECT_TRUE(text.ok());
  return Json::parse(*text);
}

TEST(Seurat, six_faces_come_back_as_they_were) {
  const TemporaryFolder folder;
  const EnvironmentMap map = small_node();
  ASSERT_TRUE(save_seurat_capture(folder.path() / "new", map).ok());
  const Result<SeuratCapture> capture = load_seurat_capture(folder.path() / "new");
  ASSERT_TRUE(capture.ok()) << capture.error().message();
  EXPECT_EQ(capture->headbox_center, glm::dvec3(0.5, -1, 2));
  ASSERT_EQ(capture->groups.size(), 1u);
  const Result<EnvironmentMap> back = environment_from_views(capture->groups[0]);
  ASSERT_TRUE(back.ok()) << back.error().message();
  for (std::size_t f = 0; f < 6; ++f) {
    EXPECT_EQ(back->faces[f].color, map.faces[f].color);
    EXPECT_EQ(back->faces[f].depth, map.faces[f].depth);
    EXPECT_NEAR(back->faces[f].camera.z_near, 0.01, 1e-9);
  }
}

TEST(Seurat, each_kind_of_depth_is_the_same_surface) {
  const TemporaryFolder folder;
  const EnvironmentMap map = small_node();
  ASSERT_TRUE(save_seurat_capture(folder.path(), map).ok());
  const std::string channel[] = {"R"};
  for (const auto& [name, kind] : {std::pair("WINDOW_Z", DepthKind::window_z),
                                   {"RAY_DEPTH", DepthKind::ray},
                                   {"EYE_Z", DepthKind::eye_z}}) {
    const DepthImage& face = map.faces[2];
    std::vector<Image<float>> depth(1, Image<float>(8, 8));
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        depth[0](x, y) =
            float(depth_from_eye_z(kind, face.depth(x, y), face.camera, {x + 0.5, y + 0.5}));
    ASSERT_TRUE(save_exr_channels(folder.path() / "face2_depth.exr", channel, depth).ok());
    Json manifest = manifest_of(folder.path());
    manifest["view_groups"][0]["views"][2]["projective_camera"]["depth_type"] = name;
    ASSERT_TRUE(write_file(folder.path() / "manifest.json", manifest.dump()).ok());
    const Result<SeuratCapture> capture = load_seurat_capture(folder.path());
    ASSERT_TRUE(capture.ok()) << capture.error().message();
    const DepthImage& read = capture->groups[0][2];
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        // window_z in floats: 1e4 m away from 0.01 m, at 5 m a step of 1e-7 is 0.2 %.
        EXPECT_NEAR(eye_z_from(read.depth_kind, read.depth(x, y), read.camera, {x + 0.5, y + 0.5}),
                    face.depth(x, y), 0.02)
            << name;
  }
}

TEST(Seurat, views_that_are_turned_become_the_same_faces) {
  const EnvironmentMap map = small_node();
  std::vector<DepthImage> views(map.faces.begin(), map.faces.end());
  std::swap(views[0], views[4]);
  // A quarter turn about the axis: right becomes up.
  DepthImage& turned = views[1];
  const DepthImage before = turned;
  turned.camera.world_from_eye[0] = before.camera.world_from_eye[1];
  turned.camera.world_from_eye[1] = -before.camera.world_from_eye[0];
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const glm::dvec3 at = world_from_raster(turned.camera, {x + 0.5, y + 0.5}, 1);
      const glm::ivec2 from(glm::dvec2(raster_from_world(before.camera, at)));
      turned.color(x, y) = before.color(from.x, from.y);
      turned.depth(x, y) = before.depth(from.x, from.y);
    }
  const Result<EnvironmentMap> back = environment_from_views(views);
  ASSERT_TRUE(back.ok()) << back.error().message();
  for (std::size_t f = 0; f < 6; ++f) EXPECT_EQ(back->faces[f].depth, map.faces[f].depth) << f;
  EXPECT_FALSE(environment_from_views({views[0], views[1]}).ok());
  views[0] = views[1];
  EXPECT_NE(environment_from_views(views).error().message().find("looks where another"),
            std::string::npos);
}

TEST(Seurat, what_is_wrong_with_a_capture_is_said) {
  struct Case {
    const char* reason;
    std::function<void(Json&)> spoil;
  };
  const auto view = [](Json& m) -> Json& { return m["view_groups"][0]["views"][1]; };
  const Case cases[] = {
      {"has no \"view_groups\"", [](Json& m) { m.erase("view_groups"); }},
      {"group 0 has no \"views\"", [](Json& m) { m["view_groups"][0] = 7; }},
      {"no size of an image", [&](Json& m) { view(m)["projective_camera"]["image_width"] = -3; }},
      {"16 finite numbers",
       [&](Json& m) { view(m)["projective_camera"]["clip_from_eye_matrix"][3] = "x"; }},
      {"no projection",
       [&](Json& m) {
         for (int i = 0; i < 16; ++i)
           view(m)["projective_camera"]["clip_from_eye_matrix"][std::size_t(i)] = 0;
       }},
      {"not a rotation",
       [&](Json& m) { view(m)["projective_camera"]["world_from_eye_matrix"][0] = 1e30; }},
      {"none of WINDOW_Z", [&](Json& m) { view(m)["projective_camera"]["depth_type"] = "METRES"; }},
      {"missing.exr",
       [&](Json& m) { view(m)["depth_image_file"]["depth"]["path"] = "missing.exr"; }},
      {"has no channel Q",
       [&](Json& m) { view(m)["depth_image_file"]["color"]["channel_1"] = "Q"; }},
      {"but its camera is 16 x 8",
       [&](Json& m) { view(m)["projective_camera"]["image_width"] = 16; }},
  };
  for (const Case& one : cases) {
    const TemporaryFolder folder;
    ASSERT_TRUE(save_seurat_capture(folder.path(), small_node()).ok());
    Json manifest = manifest_of(folder.path());
    one.spoil(manifest);
    ASSERT_TRUE(write_file(folder.path() / "manifest.json", manifest.dump()).ok());
    const Result<SeuratCapture> capture = load_seurat_capture(folder.path());
    ASSERT_FALSE(capture.ok()) << one.reason;
    EXPECT_NE(capture.error().message().find(one.reason), std::string::npos)
        << capture.error().message();
  }
}

TEST(Seurat, images_outside_of_the_folder_are_refused_unless_they_are_allowed) {
  const TemporaryFolder folder;
  const fs::path inner = folder / "capture", secret = folder / "secret.exr";
  ASSERT_TRUE(save_seurat_capture(inner, small_node()).ok());
  fs::rename(inner / "face1_depth.exr", secret);
  fs::create_symlink(secret, inner / "link.exr");
  const Json whole = manifest_of(inner);
  for (const std::string& image : {std::string("../secret.exr"), secret.string(),
                                   std::string("link.exr"), std::string("../capture2/x.exr")}) {
    Json manifest = whole;
    manifest["view_groups"][0]["views"][1]["depth_image_file"]["depth"]["path"] = image;
    ASSERT_TRUE(write_file(inner / "manifest.json", manifest.dump()).ok());
    const Result<SeuratCapture> refused = load_seurat_capture(inner);
    ASSERT_FALSE(refused.ok()) << image;
    EXPECT_NE(refused.error().message().find("--allow-outside"), std::string::npos)
        << refused.error().message();
    EXPECT_EQ(load_seurat_capture(inner, true).ok(), image != "../capture2/x.exr") << image;
  }
}

TEST(Seurat, damaged_files_are_refused) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_seurat_capture(folder.path(), small_node()).ok());
  const fs::path face = folder.path() / "face3_color.exr";
  const std::string whole = *read_file(face, 1u << 20);
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 40) {
    ASSERT_TRUE(write_file(face, whole.substr(0, length)).ok());
    const Result<SeuratCapture> capture = load_seurat_capture(folder.path());
    ASSERT_FALSE(capture.ok()) << length;
    EXPECT_NE(capture.error().message().find("face3_color.exr"), std::string::npos);
  }
  ASSERT_TRUE(write_file(folder.path() / "manifest.json", "{\"view_groups\": [").ok());
  EXPECT_NE(load_seurat_capture(folder.path()).error().message().find("not valid JSON"),
            std::string::npos);
}

TEST(Seurat, googles_own_test_capture_is_read) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const fs::path folder = fs::path(data) / "rgbd/seurat_capture";
  if (!fs::exists(folder)) GTEST_SKIP() << "no Seurat capture";
  const Result<SeuratCapture> capture = load_seurat_capture(folder / "manifest_v3.json");
  ASSERT_TRUE(capture.ok()) << capture.error().message();
  EXPECT_EQ(capture->headbox_center, glm::dvec3(1, 2, 3));
  ASSERT_EQ(capture->groups[0].size(), 1u);
  const DepthImage& view = capture->groups[0][0];
  EXPECT_EQ(view.camera.width, 450);
  int covered = 0;
  for (const float d : view.depth.texels()) covered += d != kNoDepth;
  EXPECT_GT(covered, 1000);
  EXPECT_FALSE(load_seurat_capture(folder / "invalid_manifest.json").ok());
}

}  // namespace
}  // namespace rilievo
