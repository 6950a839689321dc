// What do the readers of all formats share? Errors, warnings, memory limits, access to other files.
//
// Internal to loading. Inside, an error is thrown as LoadError; load_scene returns it as an Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rilievo/io/warnings.h"

namespace rilievo {

// The contents of a file.
using Bytes = std::span<const std::uint8_t>;

// The same memory as bytes.
[[nodiscard]] inline Bytes bytes_of(const std::string& s) {
  return {reinterpret_cast<const std::uint8_t*>(s.data()), s.size()};
}

// The exception for bad input.
struct LoadError {
  std::string reason;  // one clause, as Error::reason
};

// Throws a LoadError.
[[noreturn]] inline void refuse(std::string reason) { throw LoadError{std::move(reason)}; }

// ", but there are only 7": ends a sentence about a number that is too large.
[[nodiscard]] std::string but_there_are(std::uint64_t count);

// Limits what is allocated for a file, in two ways. All allocations together stay within a limit
// that the caller sets. They also stay within what the file has *earned*: kFree bytes plus kTimes
// its own size, so that a kilobyte cannot cost a gigabyte. Decoded pixels are exempt from the
// second rule, because small files legitimately contain large pictures.
//
// Memory that is freed is not given back to the budget, so both also bound the time spent.
class MemoryBudget {
 public:
  // 64 MiB less the memory of a process that has loaded nothing.
  static constexpr std::uint64_t kFree = std::uint64_t(40) << 20;
  static constexpr std::uint64_t kTimes = 32;

  explicit MemoryBudget(std::uint64_t limit) : limit_(limit), left_(limit) {}
  // Adds to what is earned after `bytes` were read from a file, and takes them.
  void earn(std::uint64_t bytes);
  // Adds to what is earned before `packed` bytes of a compressed mesh expand to `unpacked`. Draco
  // legitimately expands a byte to a hundred, so plausible expanded bytes earn half as much as
  // bytes of a file. Takes nothing.
  void earn_decompressed(std::uint64_t packed, std::uint64_t unpacked);
  // Takes `count` items of `each` bytes; throws if that exceeds either bound.
  void take(std::uint64_t count, std::uint64_t each = 1);
  // Takes decoded pixels, against the limit only.
  void take_pixels(std::uint64_t count, std::uint64_t each);
  // Throw like take() and take_pixels(), but take nothing: for memory that is freed at once, as a
  // decoder's own copy of a picture is.
  void borrow(std::uint64_t count, std::uint64_t each = 1) const;
  void borrow_pixels(std::uint64_t count, std::uint64_t each) const {
    (void)within_limit(count, each);
  }
  // What is left of the limit, in bytes.
  [[nodiscard]] std::uint64_t left() const { return left_; }

  // Throws the fault that names the limit, as the command line calls it: "--memory-limit-mb".
  [[noreturn]] void refuse_limit() const;

 private:
  [[nodiscard]] std::uint64_t within_limit(std::uint64_t count, std::uint64_t each) const;

  std::uint64_t limit_, left_;
  std::uint64_t read_ = 0, earned_ = kFree;  // earned and not yet taken
};

struct Deformations;

// The state of one load.
struct LoadContext {
  std::string name;                             // of the scene
  std::optional<std::filesystem::path> folder;  // of the scene; none: no other file may be read
  double time = 0.0;
  MemoryBudget budget;
  bool allow_outside = false;  // files outside `folder`
  Warnings warnings = {};
  Deformations* deformations = nullptr;  // where what bends meshes goes; null: it is not kept

  void warn(const std::string& what) { warnings.add(what); }
};

// Does `path` lie in `folder` or below it, after ".." and symbolic links are resolved?
[[nodiscard]] bool lies_within(const std::filesystem::path& folder,
                               const std::filesystem::path& path);

// The path of the file `relative` that a manifest in `folder` names; if there is none, with each
// backslash as a slash, for Windows writes paths so.
[[nodiscard]] std::filesystem::path manifest_path(const std::filesystem::path& folder,
                                                  const std::string& relative);

// The path of the file `relative` (UTF-8, names separated by '/' or '\') in the scene's folder,
// with all symbolic links resolved, so that equal files have equal paths. Throws if it lies outside
// the folder (unless the context allows it) or if the scene was loaded from memory.
[[nodiscard]] std::filesystem::path neighbor_path(const LoadContext& context,
                                                  const std::string& relative);

// The contents of the file at neighbor_path().
[[nodiscard]] std::string read_neighbor(LoadContext& context, const std::string& relative);

}  // namespace rilievo
