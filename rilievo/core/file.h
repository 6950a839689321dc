// Reading and writing whole files.
//
// A file is written under a temporary name beside its place and renamed when it is complete: a
// reader sees the old file or the new one, and a full disk leaves the old one as it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "rilievo/core/result.h"

namespace rilievo {

// The bytes of a regular file that is at most `max_bytes` long.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uint64_t max_bytes);

// Replaces `path` by the pieces, one after the other.
[[nodiscard]] Result<> write_file(const std::filesystem::path& path,
                                  std::span<const std::span<const std::byte>> pieces);
[[nodiscard]] Result<> write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace rilievo
