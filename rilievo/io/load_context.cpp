#include "rilievo/io/load_context.h"

#include <algorithm>

#include "rilievo/core/file.h"

namespace rilievo {

void MemoryBudget::borrow(std::uint64_t count, std::uint64_t each) const {
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(count, each, &bytes) || bytes > left_)
    refuse("needs more memory than the " + std::to_string(total_ >> 20) + " MiB allowed");
}

void MemoryBudget::take(std::uint64_t count, std::uint64_t each) {
  borrow(count, each);
  left_ -= count * each;
}

void LoadContext::warn(const std::string& what) {
  constexpr std::size_t kMost = 100;
  if (warnings.size() > kMost) return;
  if (std::find(warnings.begin(), warnings.end(), what) != warnings.end()) return;
  warnings.push_back(warnings.size() < kMost ? what : "more warnings follow and are left out");
}

void LoadContext::skip_points_or_lines() {
  skipped_points_or_lines = true;
  warn("points and lines are left out");
}

std::string read_neighbor(LoadContext& context, const std::string& relative) {
  if (!context.folder) refuse("refers to another file, which a scene in memory cannot");
  if (relative.find('\0') != std::string::npos) refuse("refers to a file by a name with a zero");
  std::string slashed = relative;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  const bool drive = slashed.size() > 1 && slashed[1] == ':';
  const std::filesystem::path path(slashed);
  if (path.is_absolute() || drive) refuse("refers to the absolute path '" + relative + "'");
  Result<std::string> bytes = read_file(*context.folder / path, context.budget.left());
  if (!bytes) refuse("'" + relative + "': " + bytes.error().reason);
  context.budget.take(bytes->size());
  return *std::move(bytes);
}

}  // namespace rilievo
