#include <cctype>
#include <cstring>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_polygons.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // bytes of a binary file

/// Compares without regard to upper and lower case. @param expected  in lower case
bool IsWord(std::string_view word, std::string_view expected) {
  return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// A line of a facet: the words at its beginning, the number of numbers after them, and the text by which
/// messages describe the accepted line.
struct FacetLine {
  std::vector<std::string_view> words;
  std::size_t numbers;
  const char* accepted;
};
/// The lines of a facet, in order.
const std::vector<FacetLine>& FacetLines() {
  static const std::vector<FacetLine> kLines{
      {{"facet", "normal"}, 3, "'facet normal' and 3 numbers, or 'endsolid'"},
      {{"outer", "loop"}, 0, "'outer loop'"},
      {{"vertex"}, 3, "'vertex' and 3 finite numbers"},
      {{"vertex"}, 3, "'vertex' and 3 finite numbers"},
      {{"vertex"}, 3, "'vertex' and 3 finite numbers"},
      {{"endloop"}, 0, "'endloop'"},
      {{"endfacet"}, 0, "'endfacet'"}};
  return kLines;
}

/// Reads the text form: solids of facets.
tl::expected<RawMesh, MeshError> ReadText(std::string_view content, const std::string& name) {
  if (auto damage = FindBinaryByte(content, name)) return tl::make_unexpected(*damage);
  if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
  RawMesh raw;
  PartNames parts;
  LineReader lines(content);
  std::vector<std::string_view> words;
  std::string_view solid;
  std::size_t step = 0, corner = 0;  // index of the facet's next line, and of the triangle's next corner
  bool in_solid = false;
  std::array<std::array<float, 3>, 3> triangle{};
  while (const auto line = lines.Next()) {
    SplitWords(*line, words);
    if (words.empty()) continue;
    const auto refuse = [&](const std::string& accepted) {
      return tl::make_unexpected(DamageAtLine(
          name, lines.line(), fmt::format("found {}, accepted {}", Shown(Trimmed(*line)), accepted)));
    };
    if (!in_solid) {
      if (!IsWord(words[0], "solid")) return refuse("'solid'");
      in_solid = true;
      solid = Trimmed(Trimmed(*line).substr(words[0].size()));
      continue;
    }
    if (step == 0 && IsWord(words[0], "endsolid")) {
      in_solid = false;
      continue;
    }
    const FacetLine& expected = FacetLines()[step];
    if (words.size() != expected.words.size() + expected.numbers) return refuse(expected.accepted);
    for (std::size_t i = 0; i < expected.words.size(); ++i)
      if (!IsWord(words[i], expected.words[i])) return refuse(expected.accepted);
    if (step == 0) {  // the normal is only skipped: for triangles without area, exporters write nan
      corner = 0;
      for (std::size_t i = 2; i < words.size(); ++i)
        if (!IsUnusedNumber(words[i])) return refuse(expected.accepted);
    } else if (expected.numbers > 0) {
      for (std::size_t i = 0; i < 3; ++i)
        if (auto damage = ReadCoordinate(words[i + 1], name, lines.line(), triangle[corner][i]))
          return tl::make_unexpected(*damage);
      ++corner;
    }
    if (++step < FacetLines().size()) continue;
    step = 0;
    raw.triangles.push_back(triangle);
    raw.part_of_triangle.push_back(parts.NumberOf(solid));
  }
  if (in_solid)
    return tl::make_unexpected(
        DamageAtLine(name, lines.line(),
                     fmt::format("found the end of the file {}, accepted 'endsolid' at its end",
                                 step == 0 ? "within a solid" : "within a facet")));
  raw.parts = parts.Take();
  return raw;
}

/// Reads the binary form: a header that ends with the number of triangles, then 50 bytes for each.
tl::expected<RawMesh, MeshError> ReadBinary(std::string_view content, const std::string& name) {
  if (content.size() < kHeader)
    return tl::make_unexpected(
        DamageAtByte(name, content.size(),
                     fmt::format("found the end of the file, accepted a header of {} bytes (or text that "
                                 "begins with 'solid')",
                                 kHeader)));
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
  const std::size_t found = content.size() - kHeader;
  if (found != count * kTriangle)
    return tl::make_unexpected(
        DamageAtByte(name, kHeader - sizeof(count),
                     fmt::format("found {} triangles announced and {} bytes behind the header (room for {}), "
                                 "accepted {} ({} bytes a triangle)",
                                 count, found, found / kTriangle, count * kTriangle, kTriangle)));
  RawMesh raw;
  raw.triangles.resize(count);
  raw.part_of_triangle.assign(count, 0);
  if (count > 0)
    raw.parts.emplace_back();  // the part has no name: in the header, programs write their own name
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t i = 0; i < 9; ++i) {
      const std::size_t byte = kHeader + t * kTriangle + (3 + i) * sizeof(float);  // after the normal
      float x = 0.0f;
      std::memcpy(&x, content.data() + byte, sizeof(x));
      if (!std::isfinite(x))
        return tl::make_unexpected(DamageAtByte(
            name, byte, fmt::format("triangle {}: found coordinate {}, accepted a finite number", t, x),
            MeshErrorKind::kNotFinite));
      raw.triangles[t][i / 3][i % 3] = x + 0.0f;  // turns -0 into +0, so that equal places have equal bits
    }
  return raw;
}

}  // namespace

tl::expected<RawMesh, MeshError> ReadStl(std::string_view content, const std::string& name) {
  // A binary file, too, may begin with "solid", so the file's size decides. A file that is neither form is
  // reported as a damaged text file if it consists of text.
  std::uint32_t count = 0;
  if (content.size() >= kHeader) std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
  const bool sized_as_binary = content.size() >= kHeader && content.size() - kHeader == count * kTriangle;
  const bool is_text = !content.empty() && !FindBinaryByte(content.substr(0, kHeader), name);
  auto raw = is_text && !sized_as_binary ? ReadText(content, name) : ReadBinary(content, name);
  if (raw && raw->triangles.empty())
    return tl::make_unexpected(MeshError{
        .kind = MeshErrorKind::kEmpty,
        .message = fmt::format("{}: found no facets in an STL file, accepted a closed surface", name)});
  return raw;
}

}  // namespace osteon::simulation
