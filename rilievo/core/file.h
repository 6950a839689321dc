// How are whole files read and written?
//
// A file is written under a temporary name in the same folder and renamed when it is complete: a
// reader sees either the old file or the new one, and a full disk leaves the old one untouched. A
// symbolic link stays a link: the file that it points to is replaced. The new file keeps the
// permissions of the old one, and its owner where the system allows it. Devices and pipes are
// written directly; /dev/stdout and /dev/fd/N are the process's own descriptors, of any kind.
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

// Reads a regular file of at most `max_bytes` bytes.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uint64_t max_bytes);

// Replaces the contents of `path` by the pieces, in their order.
[[nodiscard]] Result<> write_file(const std::filesystem::path& path,
                                  std::span<const std::span<const std::byte>> pieces);
[[nodiscard]] Result<> write_file(const std::filesystem::path& path, std::string_view text);

// Checks, before long work, that its result can be written to `path`. Missing folders are accepted
// if they could be created. Changes nothing.
[[nodiscard]] Result<> expect_writable(const std::filesystem::path& path);

}  // namespace rilievo
