#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace calibrato {

/// "12", "-3", "+7"; nothing if the text is anything else or does not fit 64 bits.
std::optional<int64_t> ParseWholeNumber(std::string_view text);

/// "0.5", "-1e-3", "+7", ".5", "1."; nothing if the text is anything else, hexadecimal, infinite,
/// not a number or beyond the range of a double. The locale does not matter.
std::optional<double> ParseDecimal(std::string_view text);

/// In double quotes, escaped: read back by JSON and by YAML. Bytes that are not UTF-8 (file names
/// may have such) are replaced by U+FFFD.
std::string QuoteText(const std::string& text);

/// The first 40 bytes and "...", of a longer text: for messages.
std::string ShortenText(const std::string& text);

}  // namespace calibrato
