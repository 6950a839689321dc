// SHA-256 (FIPS 180-4): the name of a file by its content.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace rilievo {

// The digest of the bytes.
[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes);

// Its first `digits` hexadecimal digits, in lower case. Requires 1 <= digits <= 64.
[[nodiscard]] std::string sha256_hex(std::span<const std::uint8_t> bytes, int digits = 64);

}  // namespace rilievo
