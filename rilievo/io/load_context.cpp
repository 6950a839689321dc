#include "rilievo/io/load_context.h"

#include <algorithm>

#include "rilievo/core/file.h"

namespace rilievo {

std::string but_there_are(std::uint64_t count) {
  if (count == 0) return ", but there are none";
  return count == 1 ? ", but there is only one" : ", but there are only " + std::to_string(count);
}

void MemoryBudget::refuse_limit() const {
  refuse("needs more memory than the " + std::to_string(limit_ >> 20) +
         " MiB that --memory-limit-mb allows");
}

std::uint64_t MemoryBudget::within_limit(std::uint64_t count, std::uint64_t each) const {
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(count, each, &bytes) || bytes > left_) refuse_limit();
  return bytes;
}

void MemoryBudget::earn(std::uint64_t bytes) {
  left_ -= within_limit(bytes, 1);
  read_ += bytes;
  earned_ += (kTimes - 1) * bytes;
}

void MemoryBudget::earn_decompressed(std::uint64_t packed, std::uint64_t unpacked) {
  // Draco's best is 2 faces a byte with 18 bytes each, meshoptimizer's 64 zeros.
  constexpr std::uint64_t kLikely = 64;
  std::uint64_t most = 0;
  if (__builtin_mul_overflow(packed, kLikely, &most)) return;
  earned_ += kTimes / 2 * std::min(unpacked, most);
}

void MemoryBudget::borrow(std::uint64_t count, std::uint64_t each) const {
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(count, each, &bytes) || bytes > earned_)
    refuse("would take more memory than 64 MiB + " + std::to_string(kTimes) + " times its " +
           std::to_string(read_) + " bytes, the most for a file within --memory-limit-mb (" +
           std::to_string(limit_ >> 20) + ")");
  (void)within_limit(bytes, 1);
}

void MemoryBudget::take(std::uint64_t count, std::uint64_t each) {
  borrow(count, each);
  left_ -= count * each;
  earned_ -= count * each;
}

void MemoryBudget::take_pixels(std::uint64_t count, std::uint64_t each) {
  left_ -= within_limit(count, each);
}

bool lies_within(const std::filesystem::path& folder, const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path top = fs::canonical(folder.empty() ? "." : folder, failed);
  const fs::path at = failed ? fs::path() : fs::weakly_canonical(path, failed);
  return !failed && std::mismatch(top.begin(), top.end(), at.begin(), at.end()).first == top.end();
}

std::filesystem::path manifest_path(const std::filesystem::path& folder,
                                    const std::string& relative) {
  std::error_code ignored;
  if (relative.find('\\') == std::string::npos ||
      std::filesystem::is_regular_file(folder / relative, ignored))
    return folder / relative;
  std::string slashed = relative;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  return folder / slashed;
}

std::filesystem::path neighbor_path(const LoadContext& context, const std::string& relative) {
  namespace fs = std::filesystem;
  if (!context.folder) refuse("refers to another file, which a scene in memory cannot");
  if (relative.find('\0') != std::string::npos)
    refuse("refers to a file whose name contains a zero byte");
  std::string slashed = relative;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  if (slashed.size() > 1 && slashed[1] == ':')
    refuse("refers to the absolute path '" + relative + "' of another system");
  std::error_code failed;
  const fs::path folder = context.folder->empty() ? "." : *context.folder;
  fs::path path = fs::weakly_canonical(folder / slashed, failed);
  if (failed) refuse("'" + relative + "': " + failed.message());
  if (!context.allow_outside && !lies_within(folder, path))
    refuse("refers to '" + relative +
           "', which is outside of the scene's folder (--allow-outside reads it)");
  return path;
}

std::string read_neighbor(LoadContext& context, const std::string& relative) {
  const std::filesystem::path path = neighbor_path(context, relative);
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  if (!unknown && size > context.budget.left()) context.budget.refuse_limit();
  Result<std::string> bytes = read_file(path, context.budget.left());
  if (!bytes) refuse("'" + relative + "': " + bytes.error().reason);
  context.budget.earn(bytes->size());
  return *std::move(bytes);
}

}  // namespace rilievo
