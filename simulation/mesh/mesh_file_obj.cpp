#include <algorithm>
#include <array>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_polygons.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

// Statements that do not change the surface and consist of a keyword and a name. The name is the whole rest
// of the line; a '\' at its end belongs to the name, and does not continue the line.
constexpr std::array<std::string_view, 6> kNames{"mtllib", "usemtl",     "usemap",
                                                 "maplib", "shadow_obj", "trace_obj"};
// Statements that are ignored: curves bound no solid, and attributes of free-form surfaces only matter for
// 'surf', which is refused.
constexpr std::array<std::string_view, 22> kIgnored{
    "vp",   "s",      "mg",   "lod",   "bevel", "c_interp", "d_interp", "ctech", "stech", "deg", "bmat",
    "step", "cstype", "curv", "curv2", "parm",  "trim",     "hole",     "scrv",  "sp",    "end", "con"};

template <std::size_t N>
bool Contains(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// One of the file's lists: its number of entries, the largest index by which a corner refers to it, and the
/// line of that corner.
struct IndexedList {
  std::int64_t count{0}, greatest{0};
  int line{0};
};

/// Reads a file line by line. Faces are stored as polygons, which are cut into triangles after the last line.
class ObjReader {
 public:
  explicit ObjReader(const std::string& name) : name_(name) {}

  tl::expected<RawMesh, MeshError> Read(std::string_view content) {
    if (auto damage = FindBinaryByte(content, name_)) return tl::make_unexpected(*damage);
    if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
    LineReader lines(content);
    while (const auto line = lines.Next()) {
      line_ = lines.line();
      if (auto damage = ReadLine(Trimmed(*line), lines)) return tl::make_unexpected(*damage);
    }
    const std::array<const char*, 3> what{"vertex", "texture", "normal"};
    for (std::size_t i = 0; i < lists_.size(); ++i)
      if (lists_[i].greatest > lists_[i].count)
        return tl::make_unexpected(
            DamageAtLine(name_, lists_[i].line,
                         fmt::format("found {} index {}, accepted 1 … {} (as many are in the file)", what[i],
                                     lists_[i].greatest, lists_[i].count)));
    RawMesh raw;
    if (const auto refused = TriangulatePolygons(mesh_, raw))
      return tl::make_unexpected(DamageAtLine(name_, static_cast<int>(refused->place), refused->what));
    raw.parts = parts_.Take();
    if (raw.triangles.empty())
      return tl::make_unexpected(
          MeshError{.kind = MeshErrorKind::kEmpty,
                    .message = fmt::format("{}: found no faces and {} vertices in an OBJ file, accepted a "
                                           "closed surface",
                                           name_, mesh_.vertices.size())});
    return raw;
  }

 private:
  [[nodiscard]] MeshError At(const std::string& what) const { return DamageAtLine(name_, line_, what); }

  /// Reads a statement, including the lines that continue it. @returns an error if the statement is refused
  std::optional<MeshError> ReadLine(std::string_view line, LineReader& lines) {
    std::string_view key = line.substr(0, line.find_first_of(" \t\v\f"));
    if (key == "g" || key == "o") {
      part_name_ = Trimmed(line.substr(1));
      part_.reset();
      return std::nullopt;
    }
    if (Contains(kNames, key)) return std::nullopt;
    // The comment is cut off first: only a '\' before it continues the statement in the next line.
    std::string_view statement = Trimmed(line.substr(0, line.find('#')));
    if (statement.ends_with('\\')) {
      joined_.clear();
      while (statement.ends_with('\\')) {
        joined_.append(statement.substr(0, statement.size() - 1)).append(" ");
        const auto next = lines.Next();
        if (!next) return At("found '\\' at the end of the last line, accepted a line that it goes on in");
        statement = Trimmed(next->substr(0, next->find('#')));
      }
      joined_.append(statement);
      statement = joined_;
    }
    SplitWords(statement, words_);
    if (words_.empty()) return std::nullopt;
    key = words_[0];
    if (key == "v") return ReadVertex();
    if (key == "vt" || key == "vn") {  // only counted: the values are not used, so nan is accepted
      ++lists_[key == "vt" ? 1 : 2].count;
      return std::nullopt;
    }
    if (key == "f") return ReadCorners(3);
    if (key == "l") return ReadCorners(2);
    if (key == "p") return ReadCorners(1);
    if (Contains(kIgnored, key)) return std::nullopt;
    if (key == "surf") return At("found a free-form surface ('surf'), accepted polygons ('f')");
    if (key == "call" || key == "csh")
      return At(
          fmt::format("found '{}', which brings in what is not in this file, accepted v, vt, vn, f …", key));
    return At(fmt::format("found {}, accepted a statement of OBJ: v, vt, vn, f, g, o …", Shown(words_[0])));
  }

  /// Reads "v x y z", which a weight or a colour may follow. Coordinates are divided by the weight.
  std::optional<MeshError> ReadVertex() {
    ++lists_[0].count;
    const std::size_t numbers = words_.size() - 1;
    if (numbers != 3 && numbers != 4 && numbers != 6 && numbers != 7)
      return At(fmt::format(
          "found a vertex of {} numbers, accepted 3 (4 with a weight, 6 or 7 with a colour)", numbers));
    std::array<float, 7> values{};
    for (std::size_t i = 0; i < numbers; ++i)
      if (auto damage = ReadCoordinate(words_[i + 1], name_, line_, values[i])) return damage;
    std::array<float, 3> vertex{values[0], values[1], values[2]};
    if (numbers == 4) {
      if (values[3] == 0.0f) return At("found a vertex of weight 0, accepted another weight");
      for (float& x : vertex) {
        x /= values[3];
        if (!std::isfinite(x))
          return DamageAtLine(name_, line_,
                              fmt::format("found a vertex of weight {}, beyond floats when divided by it, "
                                          "accepted a finite place",
                                          Shown(words_[4])),
                              MeshErrorKind::kNotFinite);
        x += 0.0f;
      }
    }
    mesh_.vertices.push_back(vertex);
    return std::nullopt;
  }

  /// Reads the corners of a face (at least three), line or point. Only faces are stored. A negative index
  /// counts back from the list's last entry.
  std::optional<MeshError> ReadCorners(std::size_t min_corners) {
    if (words_.size() - 1 < min_corners)
      return At(fmt::format("found {} corners after {}, accepted {} and more", words_.size() - 1, words_[0],
                            min_corners));
    const bool is_face = min_corners == 3;
    for (std::size_t i = 1; i < words_.size(); ++i) {
      std::string_view rest = words_[i];
      for (std::size_t list = 0; list < lists_.size(); ++list) {  // vertex/texture/normal
        const std::size_t end = rest.find('/');
        const std::string_view word = rest.substr(0, end);
        if (!word.empty() || list == 0) {
          const auto index = ParseWord<std::int64_t>(word);
          if (!index)
            return At(fmt::format("found corner {}, accepted whole numbers as v/vt/vn", Shown(words_[i])));
          const std::int64_t count = lists_[list].count;
          const std::int64_t place = *index < 0 && *index >= -count ? count + 1 + *index : *index;
          if (place < 1 || place > kMaxIndex)
            return At(fmt::format("found index {} with {} before it, accepted 1 … {}, or -{} … -1", *index,
                                  count, kMaxIndex, count));
          if (place > lists_[list].greatest) lists_[list] = {count, place, line_};
          if (list == 0 && is_face) mesh_.corners.push_back(static_cast<std::uint32_t>(place - 1));
        }
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
        if (list + 1 == lists_.size())
          return At(fmt::format("found corner {}, accepted whole numbers as v/vt/vn", Shown(words_[i])));
      }
    }
    if (!is_face) return std::nullopt;
    if (!part_) part_ = parts_.NumberOf(part_name_);
    mesh_.polygons.push_back(
        {.corners = words_.size() - 1, .part = *part_, .place = static_cast<std::size_t>(line_)});
    return std::nullopt;
  }

  static constexpr std::int64_t kMaxIndex = 2'000'000'000;

  const std::string& name_;
  int line_{0};
  std::vector<std::string_view> words_;
  std::string joined_;
  std::array<IndexedList, 3> lists_{};  // vertices, texture coordinates, normals
  PolygonMesh mesh_;
  PartNames parts_;
  std::string part_name_;
  std::optional<std::uint32_t> part_;  // part that the following faces belong to; empty before the first face
};

}  // namespace

tl::expected<RawMesh, MeshError> ReadObj(std::string_view content, const std::string& name) {
  return ObjReader(name).Read(content);
}

}  // namespace osteon::simulation
