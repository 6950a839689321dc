// What the readers of all formats share: faults, warnings, the memory bound, neighbouring files.
//
// Internal to loading. Inside it a fault is thrown as LoadFault; load_scene turns it into an Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rilievo {

using Bytes = std::span<const std::uint8_t>;

[[nodiscard]] inline Bytes bytes_of(const std::string& s) {
  return {reinterpret_cast<const std::uint8_t*>(s.data()), s.size()};
}

struct LoadFault {
  std::string reason;  // one clause, as Error::reason
};

[[noreturn]] inline void refuse(std::string reason) { throw LoadFault{std::move(reason)}; }

// ", but there are only 7": the end of a sentence about a number that is too large.
[[nodiscard]] std::string but_there_are(std::uint64_t count);

// Counts what is allocated for a file, against two bounds: a limit on all of it, and what the file
// has earned: kFree bytes, and kTimes as many as were read. Nobody who sends a kilobyte gets a
// gigabyte; decoded pixels, which small files hold in earnest, count against the limit alone.
//
// What is taken is not given back, even if it is freed before the end: the bounds are then ones on
// time, too.
class MemoryBudget {
 public:
  // 64 MiB less what a process takes that has loaded nothing.
  static constexpr std::uint64_t kFree = std::uint64_t(40) << 20;
  static constexpr std::uint64_t kTimes = 32;

  explicit MemoryBudget(std::uint64_t limit) : limit_(limit), left_(limit) {}
  // Bytes that were read from a file, which are taken with it.
  void earn(std::uint64_t bytes);
  // Bytes that `packed` ones of a compressed mesh become, which are not taken yet. Draco makes a
  // hundred bytes of one in earnest: they earn memory, too, half as much, as far as they are
  // likely.
  void earn_decompressed(std::uint64_t packed, std::uint64_t unpacked);
  // Throws if `count` things of `each` bytes are more than is left.
  void take(std::uint64_t count, std::uint64_t each = 1);
  // The same of decoded pixels, which need not be earned.
  void take_pixels(std::uint64_t count, std::uint64_t each);
  // The same for what is freed again at once.
  void borrow(std::uint64_t count, std::uint64_t each = 1) const;
  // Of the limit.
  [[nodiscard]] std::uint64_t left() const { return left_; }

  // "--memory-limit-mb" is what the command line calls the limit.
  [[noreturn]] void refuse_limit() const;

 private:
  [[nodiscard]] std::uint64_t within_limit(std::uint64_t count, std::uint64_t each) const;

  std::uint64_t limit_, left_;
  std::uint64_t read_ = 0, earned_ = kFree;  // earned and not yet taken
};

struct LoadContext {
  std::string name;                             // of the scene
  std::optional<std::filesystem::path> folder;  // nothing: no other file may be read
  double time = 0.0;
  MemoryBudget budget;
  bool allow_outside = false;  // files that do not lie below `folder`
  std::vector<std::string> warnings;
  bool skipped_points_or_lines = false;

  // Says the same thing once, and stops after a hundred.
  void warn(const std::string& what);
  void skip_points_or_lines();
};

// Is `path` in `folder` or below it, once ".." and links are resolved?
[[nodiscard]] bool lies_within(const std::filesystem::path& folder,
                               const std::filesystem::path& path);

// Where `relative` (UTF-8, '/' or '\' between names) leads from the scene's own folder, all links
// resolved: two names of a file are one path. Throws if that lies outside of the folder, unless the
// context allows it, or if the scene came from memory.
[[nodiscard]] std::filesystem::path neighbor_path(const LoadContext& context,
                                                  const std::string& relative);

// The file there.
[[nodiscard]] std::string read_neighbor(LoadContext& context, const std::string& relative);

}  // namespace rilievo
