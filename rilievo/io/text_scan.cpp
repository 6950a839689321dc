#include "rilievo/io/text_scan.h"

#include <charconv>
#include <limits>

namespace rilievo {
namespace {

void append_utf8(std::uint32_t c, std::string& to) {
  const auto tail = [&](int shift) { to += char(0x80 | (c >> shift & 0x3F)); };
  if (c < 0x80) {
    to += char(c);
  } else if (c < 0x800) {
    to += char(0xC0 | c >> 6), tail(0);
  } else if (c < 0x10000) {
    to += char(0xE0 | c >> 12), tail(6), tail(0);
  } else {
    to += char(0xF0 | c >> 18), tail(12), tail(6), tail(0);
  }
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v'; }

// std::from_chars takes no plus sign.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return word.substr(plus ? 1 : 0);
}

}  // namespace

std::string_view utf8_from(Bytes text, std::string& converted) {
  const bool little = text.size() >= 2 && text[0] == 0xFF && text[1] == 0xFE;
  const bool big = text.size() >= 2 && text[0] == 0xFE && text[1] == 0xFF;
  if (!little && !big) {
    const bool mark = text.size() >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF;
    const Bytes body = text.subspan(mark ? 3 : 0);
    return {reinterpret_cast<const char*>(body.data()), body.size()};
  }
  constexpr std::uint32_t kReplacement = 0xFFFD;
  converted.clear();
  std::uint32_t high = 0;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    std::uint32_t c = little ? text[i] | text[i + 1] << 8 : text[i] << 8 | text[i + 1];
    if (c >= 0xD800 && c < 0xDC00) {
      high = c;  // the first half of a pair
      continue;
    }
    if (c >= 0xDC00 && c < 0xE000)
      c = high ? 0x10000 + ((high - 0xD800) << 10) + (c - 0xDC00) : kReplacement;
    high = 0;
    append_utf8(c, converted);
  }
  return converted;
}

std::optional<std::string_view> take_line(std::string_view& text) {
  if (text.empty()) return {};
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end);
  if (text.starts_with("\r\n"))
    text.remove_prefix(2);
  else if (!text.empty())
    text.remove_prefix(1);
  return line;
}

std::string_view take_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_space(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_space(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return out;
}

std::optional<double> number_of(std::string_view word) {
  word = without_plus(word);
  double value = 0.0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure == std::errc::invalid_argument) return {};
  // Too large, or too small: which of the two, the exponent's sign tells.
  if (failure == std::errc::result_out_of_range) {
    const std::string_view read(word.data(), std::size_t(end - word.data()));
    const bool small = read.find("e-") != read.npos || read.find("E-") != read.npos;
    return small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

std::optional<std::int64_t> whole_number_of(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

}  // namespace rilievo
