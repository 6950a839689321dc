// Reading and writing whole files.
//
// A file is written under a temporary name beside its place and renamed when it is complete: a
// reader sees the old file or the new one, and a full disk leaves the old one as it was. A link
// stays a link: the file that it points to is replaced. A file that is replaced hands its
// permissions on, and its owner where that is allowed. Devices and pipes are written straight into;
// /dev/stdout and /dev/fd/N are the process's own descriptors, whatever they are.
//
// A signal handler can remove the temporary files: core/unfinished_files.h.
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

// Can `path` be written, as far as that can be told beforehand? Folders that are missing count as
// there, if they could be made. Leaves everything as it was: call it before long work whose result
// goes to `path`.
[[nodiscard]] Result<> expect_writable(const std::filesystem::path& path);

}  // namespace rilievo
