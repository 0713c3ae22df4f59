#include "calibrato/base/scalar_text.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrato/base/value.h"

namespace calibrato {
namespace {

template <typename Number>
std::optional<Number> ParseAll(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) return std::nullopt;
  return number;
}

}  // namespace

std::optional<int64_t> ParseWholeNumber(std::string_view text) { return ParseAll<int64_t>(text); }

std::optional<double> ParseDecimal(std::string_view text) {
  const std::optional<double> number = ParseAll<double>(text);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return number;
}

std::string QuoteText(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string ShortenText(const std::string& text) {
  constexpr size_t kMaxLength = 40;
  return text.size() <= kMaxLength ? text : text.substr(0, kMaxLength) + "...";
}

std::string FormatNumber(double value) {
  if (!std::isfinite(value)) return "null";
  // Readers of JSON take "-0" for the whole number, which has no sign.
  if (value == 0.0) return std::signbit(value) ? "-0.0" : "0";
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return std::string(text, end);
}

}  // namespace calibrato
