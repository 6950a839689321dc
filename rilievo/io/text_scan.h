// Lines, words and numbers out of text files. Internal to loading.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "rilievo/io/load_context.h"

namespace rilievo {

// Text in UTF-16 (with its byte order mark) as UTF-8, in `converted`; other text as it is, less a
// mark.
[[nodiscard]] std::string_view utf8_from(Bytes text, std::string& converted);

// Takes the next line off `text`, ended by any of \n, \r, \r\n. Nothing at the end of the text.
[[nodiscard]] std::optional<std::string_view> take_line(std::string_view& text);

// Takes the next word (up to white space) off `text`; empty if there is none.
[[nodiscard]] std::string_view take_word(std::string_view& text);

// Without white space at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

// The number that a word begins with, whatever follows it ("3.1+e2" is 3.1); nothing if it begins
// with none. May be infinite.
[[nodiscard]] std::optional<double> number_of(std::string_view word);

// The whole word as a whole number, perhaps with a sign.
[[nodiscard]] std::optional<std::int64_t> whole_number_of(std::string_view word);

}  // namespace rilievo
