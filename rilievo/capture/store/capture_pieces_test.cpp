#include "rilievo/capture/store/capture_pieces.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/store/picture_folder.h"
#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

KeptOptions exactly() {
  KeptOptions options;
  options.content = "scene", options.shader = "shader", options.exact = true;
  return options;
}

class PiecesTest : public ::testing::Test {
 protected:
  PiecesTest()
      : built_(*make_builtin("builtin:teapots?triangles=10000")),
        rays_(*RayScene::create(built_.scene)),
        source_(rays_) {}

  CaptureRequest picture(double x, bool sky = false) const {
    return {.camera = look_at({x, 3, 12}, {0, 1, 0}, {0, 1, 0}, 1.1, 24, 20, 0.1, 100),
            .with_sky = sky};
  }
  LayersRequest layers() const {
    LayersRequest request;
    request.camera = look_at({3, 10, 8}, {0, 0, 0}, {0, 1, 0}, 1.0, 20, 30, 0.1, 40);
    request.camera.projection = Projection::parallel;
    request.camera.window = {-8, 8, -8, 8};
    request.merge = 1e-3;
    return request;
  }

  BuiltinScene built_;
  RayScene rays_;
  RaySource source_;
  TemporaryFolder folder_;
};

void expect_same_bits(const DepthImage& a, const DepthImage& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(std::ranges::equal(a.color.texels(), b.color.texels()));
  EXPECT_TRUE(std::ranges::equal(a.depth.texels(), b.depth.texels()));
  EXPECT_TRUE(std::ranges::equal(a.object.texels(), b.object.texels()));
}

void expect_same_bits(const LayeredDepthImage& a, const LayeredDepthImage& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.first, b.first);
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    EXPECT_EQ(a.samples[i].color, b.samples[i].color);
    EXPECT_EQ(a.samples[i].depth, b.samples[i].depth);
    EXPECT_EQ(a.samples[i].back, b.samples[i].back);
    EXPECT_EQ(a.samples[i].object, b.samples[i].object);
  }
}

TEST_F(PiecesTest, exact_pictures_and_layers_come_back_to_the_bit_from_store_and_folder) {
  auto store = PictureStore::open(folder_ / "store.db");
  ASSERT_TRUE(store);
  PictureFolder folder(folder_ / "pictures");
  for (PictureKeeper* keeper :
       {static_cast<PictureKeeper*>(&*store), static_cast<PictureKeeper*>(&folder)}) {
    KeptSource first(source_, keeper, exactly()), again(source_, keeper, exactly());
    for (KeptSource* kept : {&first, &again}) {
      for (const double x : {0.0, 1e-9, 2.0})
        for (const bool sky : {false, true})
          expect_same_bits(kept->capture(picture(x, sky))->picture,
                           source_.capture(picture(x, sky))->picture);
      expect_same_bits(*kept->capture_layers(layers()), *source_.capture_layers(layers()));
    }
    // An eye a millionth of a millimetre aside is another one.
    EXPECT_EQ(first.rendered(), 7u);
    EXPECT_EQ(first.found(), 0u);
    EXPECT_EQ(again.rendered(), 0u);
    EXPECT_EQ(again.found(), 7u);
  }
}

TEST_F(PiecesTest, every_number_of_a_camera_makes_another_key) {
  const Camera camera = picture(0).camera;
  std::vector<Camera> cameras(1, camera);
  for (int i = 0; i < 16; ++i) {
    cameras.push_back(camera);
    double& number = cameras.back().world_from_eye[i / 4][i % 4];
    number = std::nextafter(number, 2.0);
  }
  for (double Camera::*plane : {&Camera::z_near, &Camera::z_far}) {
    cameras.push_back(camera);
    cameras.back().*plane *= 2;
  }
  for (double ImageWindow::*side :
       {&ImageWindow::left, &ImageWindow::right, &ImageWindow::bottom, &ImageWindow::top}) {
    cameras.push_back(camera);
    cameras.back().window.*side *= 2;
  }
  cameras.push_back(camera), cameras.back().width += 1;
  cameras.push_back(camera), cameras.back().projection = Projection::parallel;
  std::set<std::string> names;
  for (const Camera& one : cameras)
    names.insert(picture_file_name(kept_key({.camera = one}, {}, exactly())));
  EXPECT_EQ(names.size(), cameras.size());
}

TEST_F(PiecesTest, a_damaged_file_counts_as_missing) {
  PictureFolder folder(folder_ / "pictures");
  const PictureKey key = kept_key(picture(0), {}, exactly());
  const DepthImage made = source_.capture(picture(0))->picture;
  EXPECT_FALSE(folder.has(key));
  ASSERT_TRUE(folder.insert(key, made).ok());
  const std::string path = (folder.path() / picture_file_name(key)).string();
  const std::string whole = *read_file(path, 1 << 24);
  Random random(1);
  for (int round = 0; round < 40; ++round) {
    std::string bytes = whole;
    const auto at = std::size_t(random.next() % bytes.size());
    if (round % 2)
      bytes.resize(at);
    else
      bytes[at] = char(bytes[at] ^ 0x40);
    ASSERT_TRUE(write_file(path, bytes).ok());
    const auto found = folder.find(key);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->has_value());
  }
  ASSERT_TRUE(write_file(path, whole).ok());
  expect_same_bits(**folder.find(key), made);
}

TEST_F(PiecesTest, what_was_recorded_and_made_elsewhere_is_found_by_the_bake) {
  PieceRecorder recorder(source_, &source_);
  ASSERT_TRUE(recorder.capture(picture(0, true)));
  ASSERT_TRUE(recorder.capture_layers(layers()));
  ASSERT_TRUE(recorder.capture(picture(3)));
  ASSERT_EQ(recorder.pieces().size(), 3u);
  PictureFolder folder(folder_ / "pictures");
  for (const CapturePiece& piece : recorder.pieces()) {
    const auto read = piece_from_json(piece_json(piece));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->camera, piece.camera);
    KeptSource kept(source_, &folder, exactly());
    for (const PictureKey& key : keys_of(*read, exactly())) EXPECT_FALSE(folder.has(key));
    ASSERT_TRUE(capture_piece(*read, kept).ok());
    for (const PictureKey& key : keys_of(*read, exactly())) EXPECT_TRUE(folder.has(key));
  }
  KeptSource bake(source_, &folder, exactly());
  ASSERT_TRUE(bake.capture(picture(0, true)));
  ASSERT_TRUE(bake.capture_layers(layers()));
  ASSERT_TRUE(bake.capture(picture(3)));
  EXPECT_EQ(bake.rendered(), 0u);
}

TEST_F(PiecesTest, a_piece_that_is_none_is_refused) {
  PieceRecorder recorder(source_, nullptr);
  ASSERT_TRUE(recorder.capture(picture(0)));
  const std::string good = piece_json(recorder.pieces()[0]);
  ASSERT_TRUE(piece_from_json(good));
  for (const char* bad : {"", "[]", "{}", "{\"camera\":1}", "{\"camera\":{},\"samples\":1}"})
    EXPECT_FALSE(piece_from_json(bad)) << bad;
  std::string other = good;
  other.replace(other.find("\"projection\":0"), 14, "\"projection\":7");
  EXPECT_FALSE(piece_from_json(other));
}

}  // namespace
}  // namespace rilievo
