#include "rilievo/web_walk/sha256.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace rilievo {
namespace {

std::string hex_of(std::string_view text, int digits = 64) {
  return sha256_hex({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, digits);
}

// FIPS 180-4's own examples, and lengths about the end of a block.
TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(hex_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hex_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hex_of(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(hex_of("abc", 8), "ba7816bf");
}

TEST(Sha256, DependsOnEachByteOfEachLength) {
  std::vector<std::string> all;
  for (std::size_t length = 50; length < 70; ++length) {
    all.push_back(hex_of(std::string(length, 'x')));
    all.push_back(hex_of(std::string(length - 1, 'x') + "y"));
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

}  // namespace
}  // namespace rilievo
