// What the tests of a walk's files read.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rilievo/core/file.h"

namespace rilievo {

inline std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
  const Result<std::string> text = read_file(path, 1 << 24);
  EXPECT_TRUE(text);
  return text ? std::vector<std::uint8_t>(text->begin(), text->end()) : std::vector<std::uint8_t>();
}

}  // namespace rilievo
