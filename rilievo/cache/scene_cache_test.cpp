// What does the cache learn of the frames that were drawn? Choices alone: nothing is drawn here.
#include "rilievo/cache/scene_cache.h"
#include "rilievo/nailboard/software/software_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kBoxes = 9;

// Boxes that are cheaper as polygons than as pictures, far apart, not in the order of their places;
// the last one moves.
Scene boxes_around() {
  Scene scene;
  for (std::uint32_t i = 0; i < kBoxes; ++i) {
    const float angle = 0.2f * (float(i * 4 % kBoxes) - 4), distance = 20 + 10 * float(i % 3);
    test_shapes::add(
        scene, test_shapes::box(glm::vec3(0.5f)), glm::vec3(0.5f),
        glm::translate(glm::mat4(1), distance * glm::vec3(std::sin(angle), 0, -std::cos(angle))));
  }
  Object& last = scene.objects.back();
  scene.nodes.emplace_back();
  last.node = 0;
  Channel slide;
  slide.path = Channel::Path::translation;
  slide.times = {0, 1}, slide.values = {{0, 0, 0, 0}, {0, 0.01f, 0, 0}};
  scene.channels = {slide};
  scene.duration = 1;
  finish(scene);
  EXPECT_TRUE(last.moving);
  return scene;
}

// None, of each object.
std::vector<ObjectWork> no_work() {
  std::vector<ObjectWork> work;
  for (std::uint32_t object = 0; object < kBoxes; ++object) work.push_back({object});
  return work;
}

// Whose last work is what the test says.
class ChoosingCache {
 public:
  ChoosingCache()
      : scene_(boxes_around()),
        placed_(scene_),
        cache_(placed_, std::move(*make_software_store(placed_, {})), {}) {
    cache_.add_sets(content_);
  }

  // The eye strides aside. `work`: of objects that are polygons for all pixels; of others nothing.
  void choose(const std::vector<ObjectWork>& work) {
    const glm::dvec3 eye(0.2 * frame_++, 0, 0);
    const Camera camera =
        look_at(eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 2.0, 640, 200, 0.1, 200);
    content_.clear();
    ASSERT_TRUE(cache_.choose(camera, placed_, content_, stats_).ok());
    std::vector<ObjectWork> done;
    for (std::uint32_t object = 0; object < kBoxes; ++object)
      done.push_back(is_polygons(object) ? work[object] : ObjectWork{object});
    const std::vector<float> shares(content_.sets[0].instances.size(), 1.0f);
    cache_.learn(done, shares);
  }
  void drop_pictures() { cache_.invalidate(); }
  // A few frames in which polygons took nothing; then there are no pictures.
  void choose_without_work() {
    for (int f = 0; f < 3; ++f) choose(no_work());
    drop_pictures();
    choose(no_work());
  }
  [[nodiscard]] bool is_polygons(std::uint32_t object) const {
    return std::count(content_.polygons.begin(), content_.polygons.end(), object) > 0;
  }
  [[nodiscard]] bool fades(std::uint32_t object) const {
    return std::any_of(content_.fading.begin(), content_.fading.end(),
                       [&](const CrossFade& one) { return one.object == object; });
  }
  // The objects of each picture.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> pictures() const {
    std::vector<std::vector<std::uint32_t>> pictures;
    for (const SceneCache::Shown& shown : cache_.shown()) pictures.push_back(shown.objects);
    return pictures;
  }

 private:
  Scene scene_;
  PlacedScene placed_;
  FrameContent content_;
  FrameStats stats_;
  SceneCache cache_;
  int frame_ = 0;
};

// One that took a lot of one kind of work, among others that took none.
TEST(SceneCache, what_took_a_lot_as_polygons_is_captured_whatever_it_was_and_nothing_else) {
  for (std::uint32_t dear = 0; dear < kBoxes; ++dear)
    for (std::uint64_t ObjectWork::*const kind :
         {&ObjectWork::projected, &ObjectWork::filled, &ObjectWork::shaded}) {
      std::vector<ObjectWork> work = no_work();
      ChoosingCache cache;
      cache.choose_without_work();
      EXPECT_TRUE(cache.pictures().empty());
      work[dear].*kind = 10'000'000;
      for (int f = 0; f < 3; ++f) cache.choose(work);
      // Perhaps with neighbours, on the whole.
      EXPECT_FALSE(cache.pictures().empty()) << dear;
      for (const std::vector<std::uint32_t>& objects : cache.pictures())
        EXPECT_EQ(std::count(objects.begin(), objects.end(), dear), 1) << dear;
    }
}

// How many of one kind of work make an object dear enough for a picture?
double least_for_a_picture(std::uint64_t ObjectWork::*kind) {
  double low = 1, high = 1e7;
  while (high - low > 1 && high > 1.001 * low) {
    const double middle = std::sqrt(low * high);
    std::vector<ObjectWork> work = no_work();
    ChoosingCache cache;
    cache.choose_without_work();
    work[0].*kind = std::uint64_t(middle);
    for (int f = 0; f < 3; ++f) cache.choose(work);
    (cache.pictures().empty() ? low : high) = middle;
  }
  return high;
}

TEST(SceneCache, work_is_priced_by_its_kind) {
  const CostModel price;
  const DrawTimes times = builtin_software_costs().draw_software;
  const double projected = least_for_a_picture(&ObjectWork::projected),
               filled = least_for_a_picture(&ObjectWork::filled),
               shaded = least_for_a_picture(&ObjectWork::shaded);
  EXPECT_GT(filled, 50);  // whole numbers
  EXPECT_NEAR(projected * price.projected_triangle / (filled * price.filled_triangle), 1, 0.03);
  // A pixel's time is that of the machine's polygons.
  EXPECT_NEAR(
      shaded * times.polygon_pixel_ns / times.triangle_ns / (filled * price.filled_triangle), 1,
      0.03);
}

// While a picture fades in, its object is polygons at some pixels only: what that takes says
// nothing of what all of them take.
TEST(SceneCache, what_fading_polygons_take_is_not_learned) {
  for (std::uint32_t dear = 0; dear < kBoxes; ++dear) {
    std::vector<ObjectWork> work = no_work();
    ChoosingCache cache;
    cache.choose_without_work();
    // So dear that a picture pays, and so little that it does not at the half of it.
    work[dear].shaded = 100'000;
    int faded = 0;
    for (int f = 0; f < 20; ++f) {
      cache.choose(work);
      faded += cache.fades(dear);
    }
    EXPECT_GT(faded, 1) << dear;
    cache.drop_pictures();
    cache.choose(work);
    EXPECT_FALSE(cache.is_polygons(dear)) << dear;
  }
}

}  // namespace
}  // namespace rilievo
