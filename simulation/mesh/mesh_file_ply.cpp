#include <array>
#include <bit>
#include <cstring>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_polygons.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kMaxHeader = 65536;  // bytes
constexpr std::int64_t kMaxCorners = 255;  // of a face
constexpr const char* kTypeNames = "char, uchar, short, ushort, int, uint, float or double";

enum class PlyFormat : std::uint8_t { kText, kLittleEndian, kBigEndian };

/// A type of number: its two names in headers, its size, and whether it is signed, unsigned or real.
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

/// @returns the type of this name; null if there is none.
const PlyType* FindType(std::string_view name) {
  for (const PlyType& type : kTypes)
    if (name == type.names[0] || name == type.names[1]) return &type;
  return nullptr;
}

/// A property of an element, as the header declares it.
struct PlyProperty {
  std::string name;
  const PlyType* type{nullptr};
  const PlyType* count_type{nullptr};  ///< type of the count before a list's values; null: no list
  int axis{-1};                        ///< 0 … 2: x, y or z of a vertex; -1: another property
  bool is_corners{false};              ///< true: a face's list of vertex indices
};

/// An element (vertex, face, …): all of its rows have the same properties.
struct PlyElement {
  std::string name;
  std::size_t count{0};
  int line{0};  ///< line of its declaration in the header
  std::vector<PlyProperty> properties;
};

/// Reads the values of a PLY file's body one after the other, from text or from bytes.
class PlyBody {
 public:
  PlyBody(std::string_view content, std::size_t begin, int line, PlyFormat format)
      : content_(content), at_(begin), format_(format), lines_(content.substr(begin), line + 1) {}

  /// Begins a row of an element. In a text file a row is a line.
  [[nodiscard]] bool NextRow() {
    if (format_ != PlyFormat::kText) return true;
    do {
      const auto row = lines_.Next();
      if (!row) return false;
      SplitWords(*row, words_);
    } while (words_.empty());
    word_ = 0;
    return true;
  }
  /// Skips a value that is not used. Returns false if the file or the row ends, or the word is no number.
  [[nodiscard]] bool Skip(const PlyType& type) {
    if (format_ != PlyFormat::kText) {
      if (content_.size() - at_ < type.bytes) return false;
      at_ += type.bytes;
      return true;
    }
    if (word_ >= words_.size() || !IsUnusedNumber(words_[word_])) return false;
    ++word_;
    return true;
  }
  /// Reads the next value. Returns nothing if the file or the row ends, or the word is no number of this
  /// type.
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
  /// The current line or byte, for an error that is found later (DamageAt).
  [[nodiscard]] std::size_t place() const {
    return format_ == PlyFormat::kText ? static_cast<std::size_t>(lines_.line()) : at_;
  }
  /// Amount of content after the last row of the last element: bytes, or lines that are not empty in a text
  /// file. A single line end does not count.
  [[nodiscard]] std::size_t CountRest() {
    if (format_ != PlyFormat::kText)
      return Trimmed(content_.substr(at_)).empty() && content_.size() - at_ <= 2 ? 0 : content_.size() - at_;
    std::size_t rows = 0;
    while (NextRow()) ++rows;
    return rows;
  }
  /// Whether all words of the current line were read; always true in a binary file.
  [[nodiscard]] bool RowIsUsedUp() const { return format_ != PlyFormat::kText || word_ == words_.size(); }
  /// Text of the next value, for messages.
  [[nodiscard]] std::string Found() const {
    if (format_ != PlyFormat::kText) return "the end of the file";
    return word_ < words_.size() ? Shown(words_[word_]) : "the end of the line";
  }
  /// An error at the current place().
  [[nodiscard]] MeshError Damage(const std::string& name, const std::string& what,
                                 MeshErrorKind kind = MeshErrorKind::kUnreadable) const {
    return DamageAt(name, place(), what, kind);
  }
  /// An error at an earlier place().
  [[nodiscard]] MeshError DamageAt(const std::string& name, std::size_t place, const std::string& what,
                                   MeshErrorKind kind = MeshErrorKind::kUnreadable) const {
    return format_ == PlyFormat::kText ? DamageAtLine(name, static_cast<int>(place), what, kind)
                                       : DamageAtByte(name, place, what, kind);
  }

 private:
  std::string_view content_;
  std::size_t at_;  // position in a binary file [bytes]; the position in a text file is in lines_
  PlyFormat format_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  std::size_t word_{0};
};

/// Reads and checks header and body. Faces are stored as polygons, which are cut into triangles at the end.
class PlyReader {
 public:
  PlyReader(std::string_view content, const std::string& name) : content_(content), name_(name) {}

  tl::expected<RawMesh, MeshError> Read() {
    if (auto damage = ReadHeader()) return tl::make_unexpected(*damage);
    PlyBody body(content_, body_begin_, header_lines_, format_);
    for (const PlyElement& element : elements_)
      for (std::size_t row = 0; row < element.count; ++row)
        if (auto damage = ReadRow(body, element, row)) return tl::make_unexpected(*damage);
    if (auto damage = CheckRest(body)) return tl::make_unexpected(*damage);
    RawMesh raw;
    if (const auto refused = TriangulatePolygons(mesh_, raw))
      return tl::make_unexpected(body.DamageAt(name_, refused->place, refused->what));
    if (raw.triangles.empty())
      return tl::make_unexpected(
          MeshError{.kind = MeshErrorKind::kEmpty,
                    .message = fmt::format("{}: found no faces and {} vertices in a PLY file (a cloud of "
                                           "points?), accepted a closed surface",
                                           name_, mesh_.vertices.size())});
    raw.parts.emplace_back();  // a PLY file has no groups
    return raw;
  }

 private:
  /// Reads the header and finds where the body begins. This function and the following ones return an error
  /// if the file is refused.
  std::optional<MeshError> ReadHeader() {
    const std::size_t mark = content_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    const std::string_view head = content_.substr(mark, kMaxHeader);
    LineReader lines(head);
    std::vector<std::string_view> words;
    const auto first = lines.Next();
    if (!first || Trimmed(*first) != "ply")
      return DamageAtLine(name_, 1, fmt::format("found {}, accepted 'ply'", Shown(first.value_or(""))));
    // If the header's lines end in CR alone, an LF after its last CR is the body's first byte.
    const bool ends_in_cr =
        head.substr(first->size()).starts_with('\r') && !head.substr(first->size()).starts_with("\r\n");
    bool has_format = false;
    while (const auto line = lines.Next()) {
      header_lines_ = lines.line();
      SplitWords(*line, words);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") {
        if (!has_format) return Refuse("found no format in the header, accepted ascii or binary");
        body_begin_ = mark + head.size() - lines.rest().size();
        if (ends_in_cr && format_ != PlyFormat::kText && content_.substr(body_begin_ - 2, 2) == "\r\n")
          --body_begin_;
        return CheckHeader();
      }
      if (auto damage = ReadHeaderLine(*line, words, has_format)) return damage;
    }
    return DamageAtLine(name_, lines.line(),
                        fmt::format("found no end of the header in the first {} bytes, accepted \"ply\" … "
                                    "\"end_header\"",
                                    kMaxHeader));
  }

  /// An error at the header's current line.
  [[nodiscard]] MeshError Refuse(const std::string& what) const {
    return DamageAtLine(name_, header_lines_, what);
  }

  std::optional<MeshError> ReadHeaderLine(std::string_view line, const std::vector<std::string_view>& words,
                                          bool& has_format) {
    if (words[0] == "format" && words.size() == 3 && words[2] == "1.0" &&
        (words[1] == "ascii" || words[1] == "binary_little_endian" || words[1] == "binary_big_endian")) {
      if (has_format) return Refuse("found a second format, accepted one");
      format_ = words[1] == "ascii"                  ? PlyFormat::kText
                : words[1] == "binary_little_endian" ? PlyFormat::kLittleEndian
                                                     : PlyFormat::kBigEndian;
      has_format = true;
      return std::nullopt;
    }
    if (words[0] == "element" && words.size() == 3) {
      const auto count = ParseWord<std::uint32_t>(words[2]);
      if (!count)
        return Refuse(
            fmt::format("found {} of element {}, accepted a count", Shown(words[2]), Shown(words[1])));
      for (const PlyElement& known : elements_)
        if (known.name == words[1])
          return Refuse(
              fmt::format("found element {} a second time (first in line {}), accepted each "
                          "element once",
                          Shown(words[1]), known.line));
      if (elements_.size() >= kMaxElements)
        return Refuse(fmt::format("found more than {} elements, accepted so many", kMaxElements));
      elements_.push_back(
          {.name = std::string(words[1]), .count = *count, .line = header_lines_, .properties = {}});
      return std::nullopt;
    }
    if (words[0] == "property" && !elements_.empty() &&
        (words.size() == 3 || (words.size() == 5 && words[1] == "list")))
      return ReadProperty(words);
    return Refuse(fmt::format("found {}, accepted a line of a PLY 1.0 header", Shown(line)));
  }

  std::optional<MeshError> ReadProperty(const std::vector<std::string_view>& words) {
    const bool is_list = words.size() == 5;
    PlyElement& element = elements_.back();
    PlyProperty property{.name = std::string(words.back()),
                         .type = FindType(words[words.size() - 2]),
                         .count_type = is_list ? FindType(words[2]) : nullptr};
    if (!property.type)
      return Refuse(fmt::format("found type {}, accepted {}", Shown(words[words.size() - 2]), kTypeNames));
    if (is_list && (!property.count_type || property.count_type->is_float))
      return Refuse(
          fmt::format("found type {} of a list's count, accepted a whole number's", Shown(words[2])));
    const std::array<std::string_view, 3> axes{"x", "y", "z"};
    if (element.name == "vertex" && !is_list)
      for (int i = 0; i < 3; ++i)
        if (property.name == axes[static_cast<std::size_t>(i)]) property.axis = i;
    property.is_corners = element.name == "face" && is_list &&
                          (property.name == "vertex_indices" || property.name == "vertex_index");
    for (const PlyProperty& known : element.properties)
      if ((property.axis >= 0 && known.axis == property.axis) || (property.is_corners && known.is_corners))
        return Refuse(fmt::format("found property {} of element {} behind {}, accepted one of them",
                                  Shown(property.name), Shown(element.name), Shown(known.name)));
    element.properties.push_back(std::move(property));
    return std::nullopt;
  }

  /// Checks that the header declares vertices and faces, and no more rows than fit into the file.
  std::optional<MeshError> CheckHeader() {
    std::size_t min_bytes = 0;
    bool has_corners = false, has_vertices = false;
    for (const PlyElement& element : elements_) {
      // smallest size of a row [bytes]; a value in a text file has at least a digit and a space
      std::size_t row = 0;
      for (const PlyProperty& p : element.properties)
        row += format_ == PlyFormat::kText ? 2 : p.count_type ? p.count_type->bytes : p.type->bytes;
      min_bytes += element.count * row;
      if (element.count > 0 &&
          element.properties
              .empty())  // rows without properties take no bytes, so no file size would limit their number
        return Refuse(
            fmt::format("found element {} without properties, accepted one and more", Shown(element.name)));
      const auto has_axis = [&element](int axis) {
        return std::any_of(element.properties.begin(), element.properties.end(),
                           [axis](const PlyProperty& p) { return p.axis == axis; });
      };
      if (element.name == "vertex") {
        has_vertices = true;
        vertices_ = element.count;
        for (int axis = 0; axis < 3; ++axis)
          if (!has_axis(axis))
            return Refuse(fmt::format("found no property {:c} of element vertex, accepted x, y and z",
                                      static_cast<char>('x' + axis)));
      }
      has_corners |= std::any_of(element.properties.begin(), element.properties.end(),
                                 [](const PlyProperty& p) { return p.is_corners; });
    }
    if (!has_vertices || !has_corners)
      return Refuse(fmt::format("found no {}, accepted elements vertex and face with a list vertex_indices",
                                has_vertices ? "list vertex_indices of element face" : "element vertex"));
    const std::size_t rest = content_.size() - body_begin_;
    if (rest + 1 < min_bytes)  // + 1: a text file's last line may lack its line end
      return Refuse(
          fmt::format("found elements announced that take {} bytes and more, and {} bytes behind "
                      "the header, accepted as many as are announced",
                      min_bytes, rest));
    return std::nullopt;
  }

  /// Reads one row of an element, and keeps a vertex's coordinates or a face's corners.
  std::optional<MeshError> ReadRow(PlyBody& body, const PlyElement& element, std::size_t row) {
    const auto here = [&] { return fmt::format("{} {}", Printable(element.name), row); };
    if (!body.NextRow())
      return body.Damage(name_, fmt::format("found the end of the file before {}, accepted {} of them",
                                            here(), element.count));
    const std::size_t place = body.place();
    std::array<float, 3> vertex{};
    for (const PlyProperty& property : element.properties) {
      const auto too_short = [&] {
        return body.Damage(name_, fmt::format("{}: found {}, accepted a number for {}", here(), body.Found(),
                                              Printable(property.name)));
      };
      std::int64_t values = 1;
      if (property.count_type) {
        const auto count = body.Next(*property.count_type);
        if (!count) return too_short();
        values = static_cast<std::int64_t>(std::clamp(*count, -1.0, 1e15));
        if (property.is_corners && (values < 3 || values > kMaxCorners))
          return body.Damage(
              name_, fmt::format("{}: found {:.0f} corners, accepted 3 … {}", here(), *count, kMaxCorners));
        if (values < 0)
          return body.Damage(name_,
                             fmt::format("{}: found a list of {:.0f}, accepted 0 and more", here(), *count));
      }
      for (std::int64_t i = 0; i < values; ++i) {
        if (property.axis < 0 && !property.is_corners) {
          if (!body.Skip(*property.type)) return too_short();
          continue;
        }
        const auto value = body.Next(*property.type);
        if (!value) return too_short();
        if (property.axis >= 0) {
          // turns -0 into +0, so that equal places have equal bits
          const float x = static_cast<float>(*value) + 0.0f;
          if (!std::isfinite(x))
            return body.Damage(
                name_,
                fmt::format("{}: found {} = {}, accepted a finite number", here(), property.name, *value),
                MeshErrorKind::kNotFinite);
          vertex[static_cast<std::size_t>(property.axis)] = x;
          continue;
        }
        if (!(*value >= 0.0 && *value < static_cast<double>(vertices_)) || *value != std::floor(*value))
          return body.Damage(name_, fmt::format("{}: found vertex index {:.10g}, accepted 0 … {}", here(),
                                                *value, static_cast<std::int64_t>(vertices_) - 1));
        mesh_.corners.push_back(static_cast<std::uint32_t>(*value));
      }
      if (property.is_corners)
        mesh_.polygons.push_back({.corners = static_cast<std::size_t>(values), .part = 0, .place = place});
    }
    if (element.name == "vertex") mesh_.vertices.push_back(vertex);
    if (!body.RowIsUsedUp())
      return body.Damage(
          name_, fmt::format("{}: found {} behind its last value, accepted the end of the line", here(),
                             body.Found()));
    return std::nullopt;
  }

  /// Checks that nothing follows the last declared row: otherwise a count is wrong.
  std::optional<MeshError> CheckRest(PlyBody& body) {
    const std::size_t place = body.place();
    const std::size_t rest = body.CountRest();
    if (rest == 0) return std::nullopt;
    const PlyElement& last = elements_.back();
    const std::string name = Printable(last.name);
    if (format_ != PlyFormat::kText)
      return body.DamageAt(name_, place,
                           fmt::format("found {} bytes behind the last {}, accepted the end of the file ({} "
                                       "rows of it are announced in line {})",
                                       rest, name, last.count, last.line));
    return body.DamageAt(name_, place + 1,
                         fmt::format("found {} rows of {}, accepted the {} that are announced in line {}",
                                     last.count + rest, name, last.count, last.line));
  }

  /// A name from the header in a form that messages can show.
  static std::string Printable(const std::string& name) {
    const std::string shown = Shown(name);
    return shown.substr(1, shown.size() - 2);
  }

  static constexpr std::size_t kMaxElements = 64;

  std::string_view content_;
  const std::string& name_;
  PlyFormat format_{PlyFormat::kText};
  std::size_t body_begin_{0};
  int header_lines_{1};
  std::size_t vertices_{0};
  std::vector<PlyElement> elements_;
  PolygonMesh mesh_;
};

}  // namespace

tl::expected<RawMesh, MeshError> ReadPly(std::string_view content, const std::string& name) {
  return PlyReader(content, name).Read();
}

}  // namespace osteon::simulation
