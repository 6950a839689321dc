// How are lines, words and numbers read from text files? Internal to loading.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "rilievo/io/load_context.h"

namespace rilievo {

// The text as UTF-8 without a byte order mark. UTF-16 text (with a mark) is converted into
// `converted`.
[[nodiscard]] std::string_view utf8_from(Bytes text, std::string& converted);

// Removes the next line from `text` and returns it without its end (LF, CR or both); none at the
// end of the text.
[[nodiscard]] std::optional<std::string_view> take_line(std::string_view& text);

// Removes the next word (up to white space) from `text` and returns it; empty if there is none.
[[nodiscard]] std::string_view take_word(std::string_view& text);

// `text` without white space at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

// `text` with the letters A to Z as a to z.
[[nodiscard]] std::string lower_case(std::string_view text);

// The number that the whole word is; none if anything else is in it. The decimal sign is a point,
// or a comma if the word has one comma and no point ("0,95": some programs write as the user's
// language does; thousands are grouped by commas only by those who write points, "1,234.5", which
// is no number here). Can be infinite or NaN, which Microsoft's libraries write as "1.#INF" and
// "-1.#IND".
[[nodiscard]] std::optional<double> number_of(std::string_view word);

// The integer that the whole word is, with an optional sign.
[[nodiscard]] std::optional<std::int64_t> whole_number_of(std::string_view word);

// "line 7": of `text`, that of `at`, which points into it or to its end.
[[nodiscard]] std::string line_name(std::string_view text, const char* at);

// "has 'abc' where a number belongs": a clause about a word, which may be long.
[[nodiscard]] std::string no_number(std::string_view word);

}  // namespace rilievo
