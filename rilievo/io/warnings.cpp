#include "rilievo/io/warnings.h"

#include <algorithm>
#include <functional>

namespace rilievo {
namespace {

// `text` with nothing between its quotes and 0 for each number. An apostrophe within a word, and a
// quote without a second one, are letters.
std::string pattern_of(const std::string& text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string pattern;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool opens = (c == '\'' || c == '"') && (i == 0 || text[i - 1] == ' ');
    const std::size_t end = opens ? text.find(c, i + 1) : text.npos;
    if (end != text.npos) {
      pattern += "''";
      i = end;
    } else if (is_digit(c)) {
      pattern += '0';
      while (i + 1 < text.size() && is_digit(text[i + 1])) ++i;
    } else {
      pattern += c;
    }
  }
  return pattern;
}

}  // namespace

void Warnings::add(const std::string& what) {
  // Beyond these, repetitions count as more.
  constexpr std::size_t kMaxKnown = 100'000;
  const std::size_t hash = std::hash<std::string>()(what);
  if (known_.contains(hash)) return;
  if (known_.size() < kMaxKnown) known_.insert(hash);
  std::string pattern = pattern_of(what);
  const auto kind = std::find_if(kinds_.begin(), kinds_.end(),
                                 [&](const Kind& k) { return k.pattern == pattern; });
  if (kind != kinds_.end()) {
    ++kind->more;
  } else if (kinds_.size() < kMaxLines) {
    kinds_.push_back({what, std::move(pattern)});
  } else {
    ++others_;
  }
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> lines;
  std::uint64_t left = others_;
  for (const Kind& kind : kinds_) {
    if (others_ > 0 && lines.size() + 1 == kMaxLines) {
      left += 1 + kind.more;
      break;
    }
    lines.push_back(kind.first);
    if (kind.more > 0) lines.back() += " (and " + std::to_string(kind.more) + " more like it)";
  }
  if (left > 0) lines.push_back("and " + std::to_string(left) + " more warnings of other kinds");
  return lines;
}

}  // namespace rilievo
