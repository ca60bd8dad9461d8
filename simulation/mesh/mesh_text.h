#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "simulation/mesh/triangle_mesh.h"

// Reading of text mesh files: lines, words, numbers and error messages that name the line.

namespace osteon::simulation {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // UTF-8

/// Lines of a text, counted from 1. A line ends in LF, CR LF, or CR alone.
class LineReader {
 public:
  explicit LineReader(std::string_view text, int first_line = 1) : rest_(text), line_(first_line - 1) {}

  /// The next line without its end, or nothing at the end of the text.
  [[nodiscard]] std::optional<std::string_view> Next() {
    if (rest_.empty()) return std::nullopt;
    ++line_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end);
    if (!rest_.empty()) rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : 1);
    return line;
  }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  int line_;
};

/// The text without leading and trailing blanks.
[[nodiscard]] inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\v\f\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// Splits a line at blanks into `words`, and reuses the memory of `words`.
inline void SplitWords(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  constexpr std::string_view kBlanks = " \t\v\f";
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
}

/// Parses a word that consists of a number only, independently of the locale. A real number too large for T
/// becomes infinite, one too small becomes zero.
template <typename T>
[[nodiscard]] std::optional<T> ParseWord(std::string_view word) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return std::nullopt;
  }
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if constexpr (std::numeric_limits<T>::has_infinity) {
    if (error == std::errc::result_out_of_range)
      return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
                 ? T{0}
                 : std::numeric_limits<T>::infinity();
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

/// True if the word is a number or a C library's spelling of NaN ("-nan(ind)", "1.#QNAN"). Both are accepted
/// for values that are not used.
[[nodiscard]] inline bool IsUnusedNumber(std::string_view word) {
  return ParseWord<double>(word) || word.find(".#") != std::string_view::npos;
}

/// A word from a file, shortened and made printable for a message.
[[nodiscard]] inline std::string Shown(std::string_view word) {
  std::string text(word.substr(0, 30));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  return "'" + text + "'";
}

/// An error at a line, or at a byte, of the file `name`. @param what  what was found and what is accepted
[[nodiscard]] inline MeshError DamageAtLine(const std::string& name, int line, const std::string& what,
                                            MeshErrorKind kind = MeshErrorKind::kUnreadable) {
  return {.kind = kind, .message = fmt::format("{}:{}: {}", name, line, what)};
}

[[nodiscard]] inline MeshError DamageAtByte(const std::string& name, std::size_t byte,
                                            const std::string& what,
                                            MeshErrorKind kind = MeshErrorKind::kUnreadable) {
  return {.kind = kind, .message = fmt::format("{}: byte {}: {}", name, byte, what)};
}

/// Reads a coordinate into `value`. The number must be finite, also as a float. -0 becomes +0, so that equal
/// places have equal bits.
[[nodiscard]] inline std::optional<MeshError> ReadCoordinate(std::string_view word, const std::string& name,
                                                             int line, float& value) {
  const auto number = ParseWord<double>(word);
  value = number ? static_cast<float>(*number) + 0.0f : 0.0f;
  if (number && std::isfinite(value)) return std::nullopt;
  return DamageAtLine(name, line,
                      fmt::format("found coordinate {}, accepted a finite number{}", Shown(word),
                                  word.find(',') == std::string_view::npos ? "" : " with a decimal point"),
                      number ? MeshErrorKind::kNotFinite : MeshErrorKind::kUnreadable);
}

/// Returns an error for the first byte that cannot occur in a text file, if there is one.
[[nodiscard]] inline std::optional<MeshError> FindBinaryByte(std::string_view text, const std::string& name) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c >= 0x20 || (c >= '\t' && c <= '\r')) continue;
    return DamageAtByte(name, i, fmt::format("found 0x{:02x}, accepted text", c));
  }
  return std::nullopt;
}

}  // namespace osteon::simulation
