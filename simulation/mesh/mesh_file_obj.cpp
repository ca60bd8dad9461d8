#include <array>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::array<std::string_view, 32> kIgnored{
    "vp",     "o",          "g",         "s",        "mg",       "mtllib", "usemtl", "usemap",
    "maplib", "shadow_obj", "trace_obj", "lod",      "bevel",    "deg",    "bmat",   "step",
    "cstype", "curv",       "curv2",     "surf",     "parm",     "trim",   "hole",   "scrv",
    "sp",     "end",        "con",       "c_interp", "d_interp", "ctech",  "stech",  "call"};

/// How many of each list there are, and the index that reaches furthest into it.
struct IndexedList {
  std::int64_t count{0}, greatest{0};
  int line{0};
};

class ObjReading {
 public:
  explicit ObjReading(const std::string& name) : name_(name) {}

  std::optional<MeshError> Read(std::string_view content) {
    if (content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);  // byte order mark
    if (auto damage = FindBinaryByte(content, name_)) return damage;
    LineReader lines(content);
    while (const auto line = lines.Next()) {
      line_ = lines.line();
      SplitWords(line->substr(0, line->find('#')), words_);
      if (words_.empty()) continue;
      if (words_.back().ends_with('\\'))
        return At("found a line that goes on in the next ('\\' at its end), accepted whole lines");
      if (auto damage = ReadLine()) return damage;
    }
    const std::array<const char*, 3> what{"vertex", "texture", "normal"};
    for (std::size_t i = 0; i < lists_.size(); ++i)
      if (lists_[i].greatest > lists_[i].count)
        return DamageAtLine(name_, lists_[i].line,
                            fmt::format("found {} index {}, accepted 1 … {} (as many are in the file)",
                                        what[i], lists_[i].greatest, lists_[i].count));
    return std::nullopt;
  }

 private:
  [[nodiscard]] MeshError At(const std::string& what) const { return DamageAtLine(name_, line_, what); }

  std::optional<MeshError> ReadLine() {
    const std::string_view key = words_.front();
    if (key == "v") return ReadVertex();
    if (key == "vt" || key == "vn") {
      ++lists_[key == "vt" ? 1 : 2].count;
      for (std::size_t i = 1; i < words_.size(); ++i)
        if (!IsCoordinate(words_[i]))
          return At(fmt::format("found {} after {}, accepted a finite number", Shown(words_[i]), key));
      return std::nullopt;
    }
    if (key == "f") return ReadCorners(3);
    if (key == "l") return ReadCorners(2);
    if (key == "p") return ReadCorners(1);
    if (std::find(kIgnored.begin(), kIgnored.end(), key) != kIgnored.end()) return std::nullopt;
    return At(fmt::format("found {}, accepted a statement of OBJ: v, vt, vn, f, g, o …", Shown(key)));
  }

  std::optional<MeshError> ReadVertex() {
    ++lists_[0].count;
    const std::size_t numbers = words_.size() - 1;
    if (numbers != 3 && numbers != 4 && numbers != 6)
      return At(fmt::format("found a vertex of {} numbers, accepted 3 (4 with a weight, 6 with a colour)",
                            numbers));
    for (std::size_t i = 1; i < words_.size(); ++i)
      if (!IsCoordinate(words_[i])) {
        const bool is_number = ParseWord<double>(words_[i]).has_value();
        return DamageAtLine(name_, line_,
                            fmt::format("found coordinate {}, accepted a finite number", Shown(words_[i])),
                            is_number ? MeshErrorKind::kNotFinite : MeshErrorKind::kUnreadable);
      }
    if (numbers == 4 && *ParseWord<double>(words_[4]) == 0.0)
      return At("found a vertex of weight 0, accepted another weight");
    return std::nullopt;
  }

  std::optional<MeshError> ReadCorners(std::size_t least) {
    if (words_.size() - 1 < least)
      return At(fmt::format("found {} corners after {}, accepted {} and more", words_.size() - 1, words_[0],
                            least));
    corners_.clear();
    for (std::size_t i = 1; i < words_.size(); ++i) {
      std::string_view rest = words_[i];
      for (std::size_t list = 0; list < lists_.size(); ++list) {  // vertex/texture/normal
        const std::size_t end = rest.find('/');
        const std::string_view word = rest.substr(0, end);
        if (!word.empty() || list == 0) {
          const auto index = ParseWord<std::int64_t>(word);
          if (!index)
            return At(fmt::format("found corner {}, accepted whole numbers as v/vt/vn", Shown(words_[i])));
          const std::int64_t place = *index < 0 ? lists_[list].count + 1 + *index : *index;  // -1 is the last
          if (place < 1)
            return At(fmt::format("found index {} with {} before it, accepted 1 and more, or -{} … -1",
                                  *index, lists_[list].count, lists_[list].count));
          if (place > lists_[list].greatest) {
            lists_[list].greatest = place;
            lists_[list].line = line_;
          }
          if (list == 0) corners_.push_back(place);
        }
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
        if (list + 1 == lists_.size())
          return At(fmt::format("found corner {}, accepted whole numbers as v/vt/vn", Shown(words_[i])));
      }
    }
    if (least == 3 && IsPinched(corners_))
      return At("found a polygon that visits a vertex twice (around a hole?), accepted simple polygons");
    return std::nullopt;
  }

  const std::string& name_;
  int line_{0};
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> corners_;
  std::array<IndexedList, 3> lists_{};  // vertices, texture coordinates, normals
};

}  // namespace

std::optional<MeshError> FindObjDamage(std::string_view content, const std::string& name) {
  return ObjReading(name).Read(content);
}

}  // namespace osteon::simulation
