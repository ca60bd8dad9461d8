#pragma once

#include <array>
#include <string>
#include <string_view>

namespace osteon::report {

/// Series colours: Okabe and Ito's palette, distinguishable with every common colour blindness ("Color
/// Universal Design", 2008).
inline constexpr std::array<const char*, 6> kPalette{"#0072b2", "#d55e00", "#009e73",
                                                     "#cc79a7", "#b07d00", "#56b4e9"};
inline constexpr const char* kTextColor = "#1b1f24";
inline constexpr const char* kMutedColor = "#59636e";
inline constexpr const char* kGridColor = "#e4e8ec";
inline constexpr const char* kAxisColor = "#8a939c";
inline constexpr const char* kLimitColor = "#b3261e";
inline constexpr const char* kFontFamily =
    "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif";

/// Escapes `text` for an HTML or XML text node or quoted attribute: the five markup characters are escaped;
/// bytes that are not UTF-8 and control characters other than tab and newline become U+FFFD.
[[nodiscard]] std::string Escape(std::string_view text);

/// Upper estimate of the width [px] of `text` at a font size, by DejaVu Sans, the widest font of kFontFamily.
[[nodiscard]] double TextWidth(std::string_view text, double size_px);

/// Formats a pixel coordinate with one decimal, without a trailing ".0"; 0 if `value` is not finite, so that
/// no "nan" reaches a path.
[[nodiscard]] std::string Pixels(double value);

/// Formats a number for readers, with a fixed count of decimals and thin spaces between thousands: "12
/// 345.6". "n/a" if it is not finite; never "-0".
[[nodiscard]] std::string Number(double value, int decimals);

/// Formats a number for readers with about three significant digits.
[[nodiscard]] std::string Number(double value);

}  // namespace osteon::report
