#include "report/svg_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "base/utf8.h"

namespace osteon::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD in UTF-8

/// Upper estimate of a character's width in em, by DejaVu Sans; `c` is its first byte in UTF-8.
double CharacterWidth(unsigned char c) {
  constexpr std::string_view narrow = "iljftrI.,:;'|!()[]/ -";
  constexpr std::string_view wide = "mwMW@%";
  if (narrow.find(static_cast<char>(c)) != std::string_view::npos) return 0.41;
  if (wide.find(static_cast<char>(c)) != std::string_view::npos) return 0.98;
  if (c >= 'A' && c <= 'Z') return 0.74;
  if (c >= 0x80) return 0.70;
  return 0.635;
}

}  // namespace

std::string Escape(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  while (!text.empty()) {
    const std::size_t length = base::Utf8Length(text);
    const auto c = static_cast<unsigned char>(text.front());
    if (length == 0 || (c < 0x20u && c != '\n' && c != '\t') || c == 0x7Fu) {
      out += kReplacement;
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

double TextWidth(std::string_view text, double size_px) {
  double em = 0.0;
  for (const char c : text)
    if (!base::IsTailByte(c)) em += CharacterWidth(static_cast<unsigned char>(c));
  return em * size_px;
}

std::string Pixels(double value) {
  if (!std::isfinite(value)) return "0";
  const double rounded = std::round(std::clamp(value, -1e6, 1e6) * 10.0) / 10.0;
  return fmt::format("{:g}", rounded == 0.0 ? 0.0 : rounded);
}

std::string Number(double value, int decimals) {
  if (!std::isfinite(value)) return "n/a";
  if (std::abs(value) >= 1e15) return fmt::format("{:.3g}", value);
  std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool negative = value < 0.0 && digits.find_first_of("123456789") != std::string::npos;
  const std::size_t point = std::min(digits.find('.'), digits.size());
  // numbers of five or more digits get thin spaces (U+2009), as in the SI brochure
  if (point > 4)
    for (std::size_t i = point - 3; i > 0 && i<point; i = i> 3 ? i - 3 : 0) digits.insert(i, "\xE2\x80\x89");
  return negative ? "\xE2\x88\x92" + digits : digits;
}

std::string Number(double value) {
  if (!std::isfinite(value)) return "n/a";
  if (value == 0.0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent < -6) return fmt::format("{:.2e}", value);
  return Number(value, std::clamp(2 - exponent, 0, 8));
}

}  // namespace osteon::report
