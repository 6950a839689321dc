// Warnings about a file that was read. Alike warnings become one line.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace rilievo {

// The warnings about one file.
class Warnings {
 public:
  static constexpr std::size_t kMaxLines = 10;

  // Adds a clause; the same words again add nothing.
  void add(const std::string& what);

  // At most kMaxLines lines, in the order of their first. Those that differ only in numbers and in
  // what stands between quotes are one: "'a.png' is missing (and 1271 more like it)".
  [[nodiscard]] std::vector<std::string> lines() const;
  [[nodiscard]] bool empty() const { return kinds_.empty(); }

 private:
  struct Kind {
    std::string first, pattern;
    std::uint64_t more = 0;
  };
  std::vector<Kind> kinds_;      // kMaxLines at most
  std::set<std::size_t> known_;  // hashes of what was added
  std::uint64_t others_ = 0;     // of further kinds
};

}  // namespace rilievo
