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

// Counts what is allocated for a file. What is taken is not given back, even if it is freed before
// the end: the bound is then one on time, too.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t bytes) : total_(bytes), left_(bytes) {}
  // Throws if `count` things of `each` bytes are more than is left.
  void take(std::uint64_t count, std::uint64_t each = 1);
  // The same for what is freed again at once.
  void borrow(std::uint64_t count, std::uint64_t each = 1) const;
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  std::uint64_t total_, left_;
};

struct LoadContext {
  std::string name;                             // of the scene
  std::optional<std::filesystem::path> folder;  // nothing: no other file may be read
  double time = 0.0;
  MemoryBudget budget;
  std::vector<std::string> warnings;
  bool skipped_points_or_lines = false;

  // Says the same thing once, and stops after a hundred.
  void warn(const std::string& what);
  void skip_points_or_lines();
};

// The file at `relative` (UTF-8, '/' or '\' between names) to the scene's own folder. Throws if the
// path is absolute or the scene came from memory.
[[nodiscard]] std::string read_neighbor(LoadContext& context, const std::string& relative);

}  // namespace rilievo
