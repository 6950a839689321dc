#include "rilievo/io/text_scan.h"

#include <algorithm>
#include <array>
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

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// std::from_chars takes no plus sign.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return word.substr(plus ? 1 : 0);
}

// "1.#INF", "-1.#IND00", "1.#QNAN": what is not finite.
std::optional<double> microsofts_number(std::string_view word) {
  const bool negative = word.starts_with('-');
  word.remove_prefix(negative ? 1 : 0);
  if (!word.starts_with("1.#")) return {};
  word.remove_prefix(3);
  while (word.ends_with('0')) word.remove_suffix(1);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (word == "INF") return negative ? -kInfinity : kInfinity;
  if (word == "IND" || word == "QNAN" || word == "SNAN")
    return std::numeric_limits<double>::quiet_NaN();
  return {};
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
  constexpr std::size_t kMaxDigits = 400;  // more than a double's, written without an exponent
  std::array<char, kMaxDigits> pointed;
  if (const std::size_t comma = word.find(','); comma != word.npos) {
    const bool one = word.find(',', comma + 1) == word.npos && word.find('.') == word.npos;
    // A comma between digits: one at an end separates what is beside it.
    const auto is_digit = [&](std::size_t at) {
      return at < word.size() && word[at] >= '0' && word[at] <= '9';
    };
    if (!one || comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1) ||
        word.size() > kMaxDigits)
      return {};
    std::copy(word.begin(), word.end(), pointed.begin());
    pointed[comma] = '.';
    word = {pointed.data(), word.size()};
  }
  double value = 0.0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure == std::errc::invalid_argument) return {};
  if (end != word.data() + word.size()) return microsofts_number(word);
  // Too large, or too small: which of the two, the exponent's sign tells.
  if (failure == std::errc::result_out_of_range) {
    const bool small = word.find("e-") != word.npos || word.find("E-") != word.npos;
    const double huge = std::numeric_limits<double>::infinity();
    return small ? 0.0 : word[0] == '-' ? -huge : huge;
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

std::string line_name(std::string_view text, const char* at) {
  std::string_view before = text.substr(0, std::size_t(at - text.data()));
  std::size_t line = 1;
  while (!before.empty()) {
    const std::size_t end = before.find_first_of("\r\n");
    if (end == before.npos) break;
    before.remove_prefix(before.substr(end).starts_with("\r\n") ? end + 2 : end + 1);
    ++line;
  }
  return "line " + std::to_string(line);
}

std::string no_number(std::string_view word) {
  if (word.empty()) return "lacks a number";
  return "has '" + std::string(word.substr(0, 20)) + "' where a number belongs";
}

}  // namespace rilievo
