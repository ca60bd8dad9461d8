#include <array>
#include <bit>
#include <cstring>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kLongestHeader = 65536;
constexpr std::int64_t kMostCorners = 255;

enum class PlyFormat : std::uint8_t { kText, kLittleEndian, kBigEndian };

struct PlyType {
  std::array<const char*, 2> names;
  std::size_t bytes;
  bool is_float;
  bool is_signed;
};

constexpr std::array<PlyType, 8> kTypes{{{{"char", "int8"}, 1, false, true},
                                         {{"uchar", "uint8"}, 1, false, false},
                                         {{"short", "int16"}, 2, false, true},
                                         {{"ushort", "uint16"}, 2, false, false},
                                         {{"int", "int32"}, 4, false, true},
                                         {{"uint", "uint32"}, 4, false, false},
                                         {{"float", "float32"}, 4, true, true},
                                         {{"double", "float64"}, 8, true, true}}};

const PlyType* FindType(std::string_view name) {
  for (const PlyType& type : kTypes)
    if (name == type.names[0] || name == type.names[1]) return &type;
  return nullptr;
}

struct PlyProperty {
  std::string name;
  const PlyType* type{nullptr};
  const PlyType* count_type{nullptr};  ///< of a list
};

struct PlyElement {
  std::string name;
  std::size_t count{0};
  std::vector<PlyProperty> properties;
};

/// The values of a PLY's body, one after the other, from text or bytes.
class PlyBody {
 public:
  PlyBody(std::string_view content, std::size_t begin, int line, PlyFormat format)
      : content_(content), at_(begin), line_(line), format_(format) {}

  /// Begins a row of an element. A text's row is a line.
  [[nodiscard]] bool NextRow() {
    if (format_ != PlyFormat::kText) return true;
    do {
      if (at_ >= content_.size()) return false;
      const std::size_t end = std::min(content_.find('\n', at_), content_.size());
      std::string_view row = content_.substr(at_, end - at_);
      if (row.ends_with('\r')) row.remove_suffix(1);
      SplitWords(row, words_);
      at_ = end + 1;
      ++line_;
    } while (words_.empty());
    word_ = 0;
    return true;
  }
  /// The next value; nothing where the file or the row ends, or the word is no number of this type.
  [[nodiscard]] std::optional<double> Next(const PlyType& type) {
    if (format_ == PlyFormat::kText) {
      if (word_ >= words_.size()) return std::nullopt;
      const auto value = ParseWord<double>(words_[word_]);
      if (!value || (!type.is_float && *value != std::floor(*value))) return std::nullopt;
      ++word_;
      return value;
    }
    if (content_.size() - at_ < type.bytes) return std::nullopt;
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), content_.data() + at_, type.bytes);
    at_ += type.bytes;
    if ((format_ == PlyFormat::kBigEndian) != (std::endian::native == std::endian::big))
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    if (type.bytes == 8) return std::bit_cast<double>(bytes);
    std::array<char, 4> four{};
    std::copy(bytes.begin(), bytes.begin() + 4, four.begin());
    if (type.is_float) return std::bit_cast<float>(four);
    std::uint32_t bits = 0;
    std::memcpy(&bits, four.data(), sizeof(bits));
    if constexpr (std::endian::native == std::endian::big) bits >>= 8 * (4 - type.bytes);
    if (!type.is_signed) return bits;
    const int shift = static_cast<int>(8 * (4 - type.bytes));
    return static_cast<std::int32_t>(bits << shift) >> shift;
  }
  [[nodiscard]] std::size_t rest_bytes() const { return content_.size() - std::min(at_, content_.size()); }
  [[nodiscard]] bool RowIsUsedUp() const { return format_ != PlyFormat::kText || word_ == words_.size(); }
  [[nodiscard]] std::string Found() const {
    if (format_ != PlyFormat::kText) return "the end of the file";
    return word_ < words_.size() ? Shown(words_[word_]) : "the end of the line";
  }
  [[nodiscard]] MeshError Damage(const std::string& name, const std::string& what,
                                 MeshErrorKind kind = MeshErrorKind::kUnreadable) const {
    return format_ == PlyFormat::kText ? DamageAtLine(name, line_, what, kind)
                                       : DamageAtByte(name, std::min(at_, content_.size()), what, kind);
  }

 private:
  std::string_view content_;
  std::size_t at_;
  int line_;
  PlyFormat format_;
  std::vector<std::string_view> words_;
  std::size_t word_{0};
};

class PlyReading {
 public:
  PlyReading(std::string_view content, const std::string& name) : content_(content), name_(name) {}

  std::optional<MeshError> Read() {
    if (auto damage = ReadHeader()) return damage;
    PlyBody body(content_, body_begin_, header_lines_, format_);
    for (const PlyElement& element : elements_)
      for (std::size_t row = 0; row < element.count; ++row)
        if (auto damage = ReadRow(body, element, row)) return damage;
    return std::nullopt;
  }

 private:
  std::optional<MeshError> ReadHeader() {
    const std::string_view head = content_.substr(0, kLongestHeader);
    LineReader lines(head);
    std::vector<std::string_view> words;
    const auto refuse = [&](const std::string& what) { return DamageAtLine(name_, lines.line(), what); };
    const auto first = lines.Next();
    if (!first || *first != "ply")
      return DamageAtLine(name_, 1, fmt::format("found {}, accepted 'ply'", Shown(first.value_or(""))));
    bool has_format = false;
    while (const auto line = lines.Next()) {
      SplitWords(*line, words);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") {
        if (!has_format) return refuse("found no format in the header, accepted ascii or binary");
        body_begin_ = head.size() - lines.rest().size();
        header_lines_ = lines.line();
        return CheckHeader();
      }
      if (words[0] == "format" && words.size() == 3 && words[2] == "1.0" &&
          (words[1] == "ascii" || words[1] == "binary_little_endian" || words[1] == "binary_big_endian")) {
        format_ = words[1] == "ascii"                  ? PlyFormat::kText
                  : words[1] == "binary_little_endian" ? PlyFormat::kLittleEndian
                                                       : PlyFormat::kBigEndian;
        has_format = true;
        continue;
      }
      if (words[0] == "element" && words.size() == 3) {
        const auto count = ParseWord<std::uint32_t>(words[2]);
        if (!count)
          return refuse(fmt::format("found {} of element {}, accepted a count", Shown(words[2]), words[1]));
        elements_.push_back({.name = std::string(words[1]), .count = *count, .properties = {}});
        continue;
      }
      if (words[0] == "property" && !elements_.empty()) {
        const bool is_list = words.size() == 5 && words[1] == "list";
        if (is_list || words.size() == 3) {
          const PlyProperty property{.name = std::string(words.back()),
                                     .type = FindType(words[words.size() - 2]),
                                     .count_type = is_list ? FindType(words[2]) : nullptr};
          if (property.type && (!is_list || (property.count_type && !property.count_type->is_float))) {
            elements_.back().properties.push_back(property);
            continue;
          }
        }
      }
      return refuse(fmt::format("found {}, accepted a line of a PLY 1.0 header", Shown(*line)));
    }
    return DamageAtLine(name_, lines.line(),
                        fmt::format("found no end of the header in the first {} bytes, accepted \"ply\" … "
                                    "\"end_header\"",
                                    kLongestHeader));
  }

  std::optional<MeshError> CheckHeader() {
    const auto refuse = [this](const std::string& what) { return DamageAtLine(name_, header_lines_, what); };
    std::size_t least_bytes = 0;
    bool has_faces = false, has_vertices = false;
    for (const PlyElement& element : elements_) {
      std::size_t row = 0;
      for (const PlyProperty& p : element.properties)
        row += format_ == PlyFormat::kText ? 2 : p.count_type ? p.count_type->bytes : p.type->bytes;
      least_bytes += element.count * row;
      if (element.count > 0 && element.properties.empty())  // any number of them would take no room
        return refuse(
            fmt::format("found element {} without properties, accepted one and more", element.name));
      if (element.name == "vertex") {
        has_vertices = true;
        vertices_ = element.count;
        for (const char* axis : {"x", "y", "z"}) {
          const auto is_axis = [axis](const PlyProperty& p) { return IsAxis(p) && p.name == axis; };
          if (std::none_of(element.properties.begin(), element.properties.end(), is_axis))
            return refuse(fmt::format("found no property {} of element vertex, accepted x, y and z", axis));
        }
      }
      if (element.name == "face") {
        if (!has_vertices) return refuse("found element face before vertex, accepted vertices first");
        has_faces = std::any_of(element.properties.begin(), element.properties.end(), IsCornerList);
      }
    }
    if (!has_vertices || !has_faces)
      return refuse(fmt::format("found no {}, accepted elements vertex and face with a list vertex_indices",
                                has_vertices ? "list vertex_indices of element face" : "element vertex"));
    const std::size_t rest = content_.size() - body_begin_;
    if (rest + 1 < least_bytes)  // a text may end without a line end
      return refuse(
          fmt::format("found elements announced that take {} bytes and more, and {} bytes behind the "
                      "header, accepted as many as are announced",
                      least_bytes, rest));
    return std::nullopt;
  }

  static bool IsAxis(const PlyProperty& p) {
    return !p.count_type && (p.name == "x" || p.name == "y" || p.name == "z");
  }
  static bool IsCornerList(const PlyProperty& p) {
    return p.count_type && !p.type->is_float && (p.name == "vertex_indices" || p.name == "vertex_index");
  }

  std::optional<MeshError> ReadRow(PlyBody& body, const PlyElement& element, std::size_t row) {
    const std::string here = fmt::format("{} {}", element.name, row);
    if (!body.NextRow())
      return body.Damage(name_, fmt::format("found the end of the file before {}, accepted {} of them", here,
                                            element.count));
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    for (const PlyProperty& property : element.properties) {
      std::int64_t values = 1;
      const bool is_corners = is_face && IsCornerList(property);
      if (property.count_type) {
        const auto count = body.Next(*property.count_type);
        if (!count) return Short(body, here, property);
        values = static_cast<std::int64_t>(*count);
        if (is_corners && (values < 3 || values > kMostCorners))
          return body.Damage(
              name_, fmt::format("{}: found {} corners, accepted 3 … {}", here, values, kMostCorners));
        if (values < 0)
          return body.Damage(name_, fmt::format("{}: found a list of {}, accepted 0 and more", here, values));
      }
      corners_.clear();
      for (std::int64_t i = 0; i < values; ++i) {
        const auto value = body.Next(*property.type);
        if (!value) return Short(body, here, property);
        if (is_vertex && IsAxis(property) && !std::isfinite(static_cast<float>(*value)))
          return body.Damage(
              name_, fmt::format("{}: found {} = {}, accepted a finite number", here, property.name, *value),
              MeshErrorKind::kNotFinite);
        if (!is_corners) continue;
        if (*value < 0.0 || *value >= static_cast<double>(vertices_))
          return body.Damage(name_, fmt::format("{}: found vertex index {:.0f}, accepted 0 … {}", here,
                                                *value, static_cast<std::int64_t>(vertices_) - 1));
        corners_.push_back(static_cast<std::int64_t>(*value));
      }
      if (is_corners && IsPinched(corners_))
        return body.Damage(name_,
                           fmt::format("{}: found a polygon that visits a vertex twice (around a hole?), "
                                       "accepted simple polygons",
                                       here));
    }
    if (!body.RowIsUsedUp())
      return body.Damage(name_,
                         fmt::format("{}: found {} behind its last value, accepted the end of the line", here,
                                     body.Found()));
    return std::nullopt;
  }

  [[nodiscard]] MeshError Short(const PlyBody& body, const std::string& here,
                                const PlyProperty& property) const {
    return body.Damage(
        name_, fmt::format("{}: found {}, accepted a number for {}", here, body.Found(), property.name));
  }

  std::string_view content_;
  const std::string& name_;
  PlyFormat format_{PlyFormat::kText};
  std::size_t body_begin_{0};
  int header_lines_{0};
  std::size_t vertices_{0};
  std::vector<PlyElement> elements_;
  std::vector<std::int64_t> corners_;
};

}  // namespace

std::optional<MeshError> FindPlyDamage(std::string_view content, const std::string& name) {
  return PlyReading(content, name).Read();
}

}  // namespace osteon::simulation
