#include <cctype>
#include <cstring>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // bytes of a binary file

bool IsWord(std::string_view word, std::string_view expected) {
  return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// The lines of a facet, and of what surrounds it, in their order.
std::optional<MeshError> ReadText(std::string_view content, const std::string& name) {
  if (auto damage = FindBinaryByte(content, name)) return damage;
  struct Step {
    std::vector<std::string_view> words;  // that the line begins with
    std::size_t numbers;                  // that follow
  };
  static const std::vector<Step> kFacet{{{"facet", "normal"}, 3}, {{"outer", "loop"}, 0}, {{"vertex"}, 3},
                                        {{"vertex"}, 3},          {{"vertex"}, 3},        {{"endloop"}, 0},
                                        {{"endfacet"}, 0}};
  LineReader lines(content);
  std::vector<std::string_view> words;
  std::size_t step = 0;
  bool in_solid = false;
  while (const auto line = lines.Next()) {
    SplitWords(*line, words);
    if (words.empty()) continue;
    const auto refuse = [&](const std::string& accepted) {
      return DamageAtLine(name, lines.line(), fmt::format("found {}, accepted {}", Shown(*line), accepted));
    };
    if (!in_solid) {
      if (!IsWord(words[0], "solid")) return refuse("'solid'");
      in_solid = true;
      continue;
    }
    if (step == 0 && IsWord(words[0], "endsolid")) {
      in_solid = false;
      continue;
    }
    const Step& expected = kFacet[step];
    std::string begin;
    for (const std::string_view word : expected.words)
      begin += (begin.empty() ? "" : " ") + std::string(word);
    const std::string accepted = fmt::format("'{}'{}{}", begin,
                                             expected.numbers == 0 ? ""
                                             : step == 0           ? " and 3 numbers"
                                                                   : " and 3 finite numbers",
                                             step == 0 ? ", or 'endsolid'" : "");
    if (words.size() != expected.words.size() + expected.numbers) return refuse(accepted);
    for (std::size_t i = 0; i < expected.words.size(); ++i)
      if (!IsWord(words[i], expected.words[i])) return refuse(accepted);
    for (std::size_t i = expected.words.size(); i < words.size(); ++i) {
      const bool is_number = ParseWord<double>(words[i]).has_value();
      // a normal is not used: exporters write nan for needles. What is no number at all assimp stops at
      if (step == 0 && !is_number) return refuse(accepted);
      if (step != 0 && !IsCoordinate(words[i]))
        return DamageAtLine(name, lines.line(),
                            fmt::format("found coordinate {}, accepted a finite number", Shown(words[i])),
                            is_number ? MeshErrorKind::kNotFinite : MeshErrorKind::kUnreadable);
    }
    step = (step + 1) % kFacet.size();
  }
  if (in_solid)
    return DamageAtLine(name, lines.line(),
                        fmt::format("found the end of the file {}, accepted 'endsolid' at its end",
                                    step == 0 ? "within a solid" : "within a facet"));
  return std::nullopt;
}

std::optional<MeshError> ReadBinary(std::string_view content, const std::string& name) {
  if (content.size() < kHeader)
    return DamageAtByte(name, content.size(),
                        fmt::format("found the end of the file, accepted a header of {} bytes (or text that "
                                    "begins with 'solid')",
                                    kHeader));
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
  const std::size_t found = content.size() - kHeader;
  if (found != count * kTriangle)
    return DamageAtByte(
        name, kHeader - sizeof(count),
        fmt::format("found {} triangles announced and {} bytes behind the header, accepted {} "
                    "({} bytes a triangle)",
                    count, found, count * kTriangle, kTriangle));
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t i = 3; i < 12; ++i) {  // the first three are the normal
      const std::size_t byte = kHeader + t * kTriangle + i * sizeof(float);
      float x = 0.0f;
      std::memcpy(&x, content.data() + byte, sizeof(x));
      if (!std::isfinite(x))
        return DamageAtByte(name, byte,
                            fmt::format("triangle {}: found coordinate {}, accepted a finite number", t, x),
                            MeshErrorKind::kNotFinite);
    }
  return std::nullopt;
}

}  // namespace

std::optional<MeshError> FindStlDamage(std::string_view content, const std::string& name) {
  // A binary file may begin with "solid" as well: its size decides.
  std::uint32_t count = 0;
  if (content.size() >= kHeader) std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
  const bool sized_as_binary = content.size() >= kHeader && content.size() - kHeader == count * kTriangle;
  const std::size_t begin = std::min(content.find_first_not_of(" \t\r\n"), content.size());
  const bool is_text = IsWord(content.substr(begin, 5), "solid") &&
                       content.substr(0, kHeader).find('\0') == std::string_view::npos;
  return is_text && !sized_as_binary ? ReadText(content, name) : ReadBinary(content, name);
}

}  // namespace osteon::simulation
