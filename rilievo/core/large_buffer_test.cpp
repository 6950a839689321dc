#include "rilievo/core/large_buffer.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace rilievo {
namespace {

constexpr std::size_t kLargePage = std::size_t(1) << 21;

template <class T>
void expect_room(LargeBuffer<T>& buffer, std::size_t size) {
  buffer.require(size);
  ASSERT_GE(buffer.capacity(), size);
  for (std::size_t i = 0; i < buffer.capacity(); ++i) buffer[i] = T(3 * i + 1);
  for (std::size_t i = 0; i < buffer.capacity(); ++i) ASSERT_EQ(buffer[i], T(3 * i + 1)) << i;
}

TEST(LargeBuffer, has_room_for_what_is_required) {
  LargeBuffer<std::uint32_t> buffer;
  EXPECT_EQ(buffer.capacity(), 0u);
  std::mt19937 rng(1);
  // Small sizes and some of a few large pages.
  for (int round = 0; round < 40; ++round)
    expect_room(buffer, round % 4 != 0 ? 1 + rng() % 3000 : 1 + rng() % (3 * kLargePage / 4));
}

TEST(LargeBuffer, keeps_what_it_holds_while_there_is_room) {
  LargeBuffer<float> buffer;
  expect_room(buffer, 1000);
  const float* const before = buffer.data();
  buffer.require(0);
  buffer.require(999);
  buffer.require(1000);
  EXPECT_EQ(buffer.data(), before);
  for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(buffer[i], float(3 * i + 1));
}

TEST(LargeBuffer, begins_with_a_page_of_2_MB_where_it_is_large) {
  LargeBuffer<float> buffer;
  for (const std::size_t size : {kLargePage / sizeof(float), kLargePage + 1}) {
    buffer.require(size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % kLargePage, 0u);
    EXPECT_EQ(buffer.capacity(), size);
  }
}

}  // namespace
}  // namespace rilievo
