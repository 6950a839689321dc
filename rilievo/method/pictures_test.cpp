// Which pictures are captured, kept and let go? By a store that only counts them.
#include "rilievo/method/pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/nailboard/software/software_nailboard_set.h"

namespace rilievo {
namespace {

// Has room for so many pictures of any size, and notes what is captured.
class CountedPictures final : public NailboardStore {
 public:
  CountedPictures(const PlacedScene& placed, std::size_t most) : placed_(placed), most_(most) {}

  std::vector<std::uint32_t> captured;
  std::optional<DeltaRange> range;            // of all pictures
  PictureGeometry shown;                      // the last one
  std::map<std::uint32_t, glm::dmat4> poses;  // of the pictures held: the object's, at capture

  [[nodiscard]] int max_picture_size() const override { return 1024; }
  [[nodiscard]] int texel_cell() const override { return 1; }
  [[nodiscard]] std::uint64_t max_texels() const override { return 1 << 30; }
  [[nodiscard]] std::size_t bytes() const override { return 0; }
  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::software; }
  [[nodiscard]] PlacedRaster* rasterizer() override { return nullptr; }
  [[nodiscard]] bool allocate(std::uint32_t slot, int, int) override {
    return poses.size() < most_ && poses.emplace(slot, 1.0).second;
  }
  void free(std::uint32_t slot) override { EXPECT_EQ(poses.erase(slot), 1u); }
  void capture(std::uint32_t slot, const Camera&, std::span<const std::uint32_t> objects) override {
    ASSERT_EQ(objects.size(), 1u);
    poses.at(slot) = glm::dmat4(placed_.poses()[objects[0]]);
    captured.push_back(slot);
  }
  void write(std::uint32_t, const RasterPicture&, int) override {}
  [[nodiscard]] int written_bits() const override { return 8; }
  [[nodiscard]] GapTable gaps(const Camera&, std::span<const std::uint32_t>) override { return {}; }
  [[nodiscard]] std::optional<DeltaRange> delta_range(std::uint32_t) override { return range; }
  void finish() override {}
  void capture_objects(std::uint32_t, const Camera&, std::span<const std::uint32_t>) override {}
  void write_objects(std::uint32_t, std::span<const std::uint32_t>) override {}
  [[nodiscard]] Drawable& pictures() override { return set_; }
  void show(std::uint32_t slot, const PictureGeometry& geometry) override {
    EXPECT_TRUE(poses.count(slot));
    shown = geometry;
  }
  [[nodiscard]] Nailboard read(std::uint32_t, const PictureGeometry&) const override { return {}; }

 private:
  const PlacedScene& placed_;
  std::size_t most_;
  SoftwareNailboardSet set_{DepthMode::exact};
};

// A scene's frames, of which only the choice is made.
struct ChosenPictures {
  PlacedScene placed;
  CountedPictures* store;
  PictureChooser chooser;
  FrameContent content;
  FrameStats stats;

  ChosenPictures(const Scene& scene, std::size_t most)
      : ChosenPictures(scene, most, std::unique_ptr<CountedPictures>()) {}

  // The objects that are captured for the frame.
  std::vector<std::uint32_t> choose(const Camera& camera, double time = 0) {
    placed.set_time(time);
    content.clear();
    store->captured.clear();
    EXPECT_TRUE(chooser.choose(camera, placed, content, stats).ok());
    EXPECT_EQ(stats.captures, int(store->captured.size()));
    return store->captured;
  }

 private:
  ChosenPictures(const Scene& scene, std::size_t most, std::unique_ptr<CountedPictures> made)
      : placed(scene),
        store((made = std::make_unique<CountedPictures>(placed, most), made.get())),
        chooser(placed, std::move(made), {.min_triangles = 1}) {
    chooser.add_sets(content);
  }
};

// Boxes 10 m around the origin, half a radian apart.
Scene scene_of_boxes(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const float angle = 0.5f * float(i);
    const glm::vec3 at(10 * std::sin(angle), 0, -10 * std::cos(angle));
    test_shapes::add(scene, test_shapes::box(glm::vec3(0.5f)), glm::vec3(0.5f),
                     glm::translate(glm::mat4(1), at));
  }
  finish(scene);
  return scene;
}

// Looks between boxes `first` and `last`, and sees these and what is between them.
Camera looking_at_boxes(int first, int last) {
  const double angle = 0.25 * (first + last);
  Camera camera = look_at({0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)}, {0, 1, 0}, 0.5, 200,
                          200, 0.1, 100);
  const double wide = std::tan(0.25 + 0.25 * (last - first));
  camera.window.left = -wide, camera.window.right = wide;
  camera.width = int(200 * wide / std::tan(0.25));
  return camera;
}

using Objects = std::vector<std::uint32_t>;

TEST(PictureChooser, the_picture_that_was_not_drawn_for_longest_makes_room) {
  const Scene scene = scene_of_boxes(4);
  ChosenPictures frames(scene, 2);
  EXPECT_EQ(frames.choose(looking_at_boxes(0, 0)), Objects{0});
  EXPECT_EQ(frames.choose(looking_at_boxes(1, 1)), Objects{1});
  EXPECT_EQ(frames.choose(looking_at_boxes(2, 2)), Objects{2});  // 0 goes
  EXPECT_EQ(frames.choose(looking_at_boxes(1, 1)), Objects{});
  EXPECT_EQ(frames.choose(looking_at_boxes(3, 3)), Objects{3});  // 2 goes
  EXPECT_EQ(frames.choose(looking_at_boxes(1, 1)), Objects{});
  EXPECT_EQ(frames.choose(looking_at_boxes(2, 2)), Objects{2});
}

TEST(PictureChooser, no_picture_that_the_frame_needs_makes_room_for_another) {
  const Scene scene = scene_of_boxes(4);
  ChosenPictures frames(scene, 2);
  EXPECT_EQ(frames.choose(looking_at_boxes(1, 2)), (Objects{1, 2}));
  for (int f = 0; f < 2; ++f) {
    EXPECT_EQ(frames.choose(looking_at_boxes(0, 3)), Objects{});
    EXPECT_EQ(frames.content.polygons, (Objects{0, 3}));
  }
}

TEST(PictureChooser, a_frame_that_needs_finer_texels_captures_again) {
  const Scene scene = scene_of_boxes(1);
  ChosenPictures frames(scene, 1);
  Camera camera = looking_at_boxes(0, 0);
  EXPECT_EQ(frames.choose(camera), Objects{0});
  camera.width /= 2, camera.height /= 2;
  EXPECT_EQ(frames.choose(camera), Objects{});
  camera.width *= 4, camera.height *= 4;
  EXPECT_EQ(frames.choose(camera), Objects{0});
  EXPECT_EQ(frames.choose(camera), Objects{});
}

// Also in later frames.
TEST(PictureChooser, what_a_picture_shows_narrows_where_it_stands) {
  const Scene scene = scene_of_boxes(1);
  ChosenPictures whole(scene, 1), narrow(scene, 1);
  const DeltaRange range{0.3, 0.4};
  narrow.store->range = range;
  for (int f = 0; f < 2; ++f) {
    (void)whole.choose(looking_at_boxes(0, 0));
    (void)narrow.choose(looking_at_boxes(0, 0));
    PictureGeometry expected = whole.store->shown;
    narrow_slab(expected, range);
    EXPECT_EQ(narrow.store->shown.plane_z, expected.plane_z);
    EXPECT_EQ(narrow.store->shown.slab.front, expected.slab.front);
    EXPECT_EQ(narrow.store->shown.slab.back, expected.slab.back);
    EXPECT_LT(expected.slab.back, whole.store->shown.slab.back);
  }
}

// Captured again and again while it goes around the eye, which strides aside.
TEST(PictureChooser, a_picture_moves_as_its_object_has_since_the_capture) {
  Scene scene = scene_of_boxes(1);
  scene.nodes.emplace_back();
  scene.objects[0].node = 0;
  Channel turn;
  turn.path = Channel::Path::rotation;
  turn.times = {0, 1};
  turn.values = {{0, 0, 0, 1}, {0, std::sin(0.08f), 0, std::cos(0.08f)}};
  scene.channels = {turn};
  scene.duration = 1;
  finish(scene);
  ChosenPictures frames(scene, 1);
  int captured = 0, kept = 0, moved = 0;
  for (int f = 0; f < 60; ++f) {
    Camera camera = looking_at_boxes(0, 0);
    camera.world_from_eye[3].x = 0.02 * f;
    const bool again = !frames.choose(camera, f / 60.0).empty();
    const std::vector<Instance>& instances = frames.content.sets[0].instances;
    ASSERT_EQ(instances.size(), 1u);
    const glm::dmat4 expected =
        glm::dmat4(frames.placed.poses()[0]) * glm::inverse(frames.store->poses.at(0));
    for (int column = 0; column < 4; ++column)
      EXPECT_LT(glm::distance(instances[0].world_from_capture[column], expected[column]), 1e-5)
          << f;
    captured += again, kept += !again;
    moved += glm::distance(expected[0], glm::dvec4(1, 0, 0, 0)) > 1e-3;
  }
  EXPECT_GT(captured, 3);
  EXPECT_GT(kept, 10);
  EXPECT_GT(moved, 10);
}

}  // namespace
}  // namespace rilievo
