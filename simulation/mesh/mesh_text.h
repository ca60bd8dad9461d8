#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "simulation/mesh/triangle_mesh.h"

// Reading of mesh files that are text: lines, words, numbers and refusals that name the line.

namespace osteon::simulation {

/// Lines of a text, counted from 1.
class LineReader {
 public:
  explicit LineReader(std::string_view text, int first_line = 1) : rest_(text), line_(first_line - 1) {}

  /// The next line without its end, or nothing at the end of the text.
  [[nodiscard]] std::optional<std::string_view> Next() {
    if (rest_.empty()) return std::nullopt;
    ++line_;
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  int line_;
};

/// Splits at blanks into `words`, whose memory it reuses.
inline void SplitWords(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  constexpr std::string_view kBlanks = " \t\v\f";
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
}

/// A number that fills the word; no locale.
template <typename T>
[[nodiscard]] std::optional<T> ParseWord(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// A coordinate: finite, also as the float that it becomes.
[[nodiscard]] inline bool IsCoordinate(std::string_view word) {
  const auto value = ParseWord<double>(word);
  return value && std::isfinite(static_cast<float>(*value));
}

/// What a file holds, short enough for a message and printable.
[[nodiscard]] inline std::string Shown(std::string_view word) {
  std::string text(word.substr(0, 30));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  return "'" + text + "'";
}

[[nodiscard]] inline MeshError DamageAtLine(const std::string& name, int line, const std::string& what,
                                            MeshErrorKind kind = MeshErrorKind::kUnreadable) {
  return {.kind = kind, .message = fmt::format("{}:{}: {}", name, line, what)};
}

[[nodiscard]] inline MeshError DamageAtByte(const std::string& name, std::size_t byte,
                                            const std::string& what,
                                            MeshErrorKind kind = MeshErrorKind::kUnreadable) {
  return {.kind = kind, .message = fmt::format("{}: byte {}: {}", name, byte, what)};
}

/// A byte that no text has, if there is one.
[[nodiscard]] inline std::optional<MeshError> FindBinaryByte(std::string_view text, const std::string& name) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c >= 0x20 || (c >= '\t' && c <= '\r')) continue;
    return DamageAtByte(name, i, fmt::format("found 0x{:02x}, accepted text", c));
  }
  return std::nullopt;
}

/// A corner list that visits one vertex twice, though it is no triangle (which would just be dropped).
[[nodiscard]] inline bool IsPinched(std::vector<std::int64_t> corners) {
  if (corners.size() <= 3) return false;
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

}  // namespace osteon::simulation
