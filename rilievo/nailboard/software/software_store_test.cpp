// Does the memory of pictures stay within its limit, whatever slots were used for before?
#include <gtest/gtest.h>

#include "rilievo/core/random.h"
#include "rilievo/nailboard/software/software_store.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class SoftwareStore : public testing::Test {
 protected:
  void SetUp() override {
    auto made = make_builtin("builtin:teapots?triangles=10000");
    ASSERT_TRUE(made.ok());
    builtin_ = std::move(*made);
    placed_.emplace(builtin_.scene);
    // As little as there can be, so that pictures do not fit.
    NailboardStoreOptions options;
    options.max_bytes = std::size_t(1) << 20;
    while (!check_software_store(options).ok()) options.max_bytes += std::size_t(1) << 20;
    store_ = std::move(*make_software_store(*placed_, options));
  }
  // A picture of the first object; false if there is no room.
  bool keep(std::uint32_t slot, int size) {
    if (!store_->allocate(slot, size, size)) return false;
    const Camera camera = look_at({0, 1, 5}, {0, 1, 0}, {0, 1, 0}, 1.0, size, size, 0.1, 100);
    const std::uint32_t object = 0;
    store_->capture(slot, camera, {&object, 1});
    store_->show(slot, picture_geometry(camera));
    return true;
  }
  // What the pictures shown so far hold, those that are free included.
  [[nodiscard]] std::size_t held() { return store_->pictures().bytes(); }

  BuiltinScene builtin_;
  std::optional<PlacedScene> placed_;
  std::unique_ptr<NailboardStore> store_;
};

TEST_F(SoftwareStore, small_pictures_in_slots_of_large_ones_count_with_all_that_they_hold) {
  std::vector<std::uint32_t> slots;
  while (keep(std::uint32_t(slots.size()), 400)) slots.push_back(std::uint32_t(slots.size()));
  ASSERT_GT(slots.size(), 3u);
  const std::size_t full = store_->bytes();
  EXPECT_EQ(held(), full);
  for (const std::uint32_t slot : slots) store_->free(slot);
  for (const std::uint32_t slot : slots) ASSERT_TRUE(keep(slot, 40));
  EXPECT_EQ(held(), store_->bytes());
  EXPECT_LT(store_->bytes(), full / 20);
}

TEST_F(SoftwareStore, holds_no_more_than_it_may_whatever_comes_and_goes) {
  Random random(3);
  // Colours and codes take six bytes a texel.
  const std::size_t limit = 6 * (store_->max_texels() + 1);
  std::vector<int> sizes(200, 0);  // 0: free
  int refused = 0;
  for (int step = 0; step < 1200; ++step) {
    const auto slot = std::uint32_t(random.below(int(sizes.size())));
    if (sizes[slot] > 0) {
      store_->free(slot);
      sizes[slot] = 0;
    } else {
      const int size = 1 << random.below(9);
      if (keep(slot, std::min(size + random.below(size), store_->max_picture_size())))
        sizes[slot] = size;
      refused += sizes[slot] == 0;
    }
    ASSERT_LE(store_->bytes(), held()) << step;
    ASSERT_LE(held(), limit) << step;
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace rilievo
