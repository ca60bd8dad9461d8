#include "simulation/packing/packing_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "base/utf8.h"

namespace osteon::simulation {
namespace {

/// How a property of a material is written: a line with its key and value, then a line with the value's
/// source.
struct Figure {
  const char* key;
  double Material::*value;
  const char* source_key;      ///< key of the value's source ...
  const char* assumption_key;  ///< ... or of the reason why the value is assumed
  FigureSource Material::*source;
  bool may_be_zero;  ///< true: the value may be 0; false: it must be above 0
  double max_value;
};
constexpr double kNoBound = std::numeric_limits<double>::max();
/// All properties of a material, with the same bounds as in CheckMaterials.
constexpr std::array<Figure, 4> kFigures{{
    {"density_kg_per_m3", &Material::density_kg_per_m3, "density_source", "density_assumption",
     &Material::density_source, false, kNoBound},
    {"specific_cutting_energy_J_per_m3", &Material::specific_cutting_energy_J_per_m3, "cutting_energy_source",
     "cutting_energy_assumption", &Material::cutting_energy_source, false, kNoBound},
    {"cutting_force_ratio", &Material::cutting_force_ratio, "cutting_force_source",
     "cutting_force_assumption", &Material::cutting_force_source, false, kNoBound},
    {"friction", &Material::friction, "friction_source", "friction_assumption", &Material::friction_source,
     true, 2.0},
}};

/// The edge force is written only if it is known. The line kChipKey then follows, with the chip's thickness
/// at which the cutting energy was measured.
constexpr Figure kEdgeForce{"edge_force_N_per_m",
                            &Material::edge_force_N_per_m,
                            "edge_force_source",
                            "edge_force_assumption",
                            &Material::edge_force_source,
                            false,
                            kNoBound};
constexpr const char* kChipKey = "measured_chip_m";

constexpr const char* kCrcKey = "source_crc32";
constexpr const char* kTextAccepted = "UTF-8 without control characters";

/// Writes a line's end as \n and a backslash as two.
std::string Escaped(const std::string& value) {
  std::string out;
  for (const char c : value) {
    if (c == '\\' || c == '\n') out += '\\';
    out += c == '\n' ? 'n' : c;
  }
  return out;
}

/// Quotes a text for a message: printable and shortened.
std::string Shown(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 40))
    out +=
        c >= 0x20 && c < 0x7f ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return "\"" + out + (text.size() > 40 ? "…\"" : "\"");
}

/// Reads lines "key=value", one after the other. The first error is stored; after it, all values that are
/// read are empty.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  [[nodiscard]] bool AtEnd() const { return error_ || at_ == text_.size(); }
  [[nodiscard]] const std::optional<TextError>& error() const { return error_; }

  /// Reads the next line: its key and its unescaped value. `expected` describes the line in errors.
  std::pair<std::string, std::string> Next(const std::string& expected) {
    if (error_) return {};
    line_ = at_;
    const std::size_t end = text_.find('\n', at_);
    if (end == text_.npos) {
      Fail(at_ == text_.size() ? "the end of the text" : "a line without its end", expected);
      return {};
    }
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    const std::size_t equals = line.find('=');
    if (equals == line.npos) {
      Fail(Shown(line), expected);
      return {};
    }
    value_ = line_ + equals + 1;
    return {std::string(line.substr(0, equals)), Unescaped(line.substr(equals + 1))};
  }

  /// The value of the next line, which must have this key.
  std::string Value(const std::string& key) {
    auto [found, value] = Next("a line " + key + "=…");
    if (!error_ && found != key) Fail("a line " + Shown(found), "a line " + key + "=…");
    return value;
  }

  /// Whether the next line has this key.
  [[nodiscard]] bool NextIs(std::string_view key) const {
    const std::string_view rest = text_.substr(at_);
    return !error_ && rest.starts_with(key) && rest.substr(key.size()).starts_with('=');
  }

  /// The number of the next line, which must have this key; `max_value` kNoBound: any finite one.
  double ReadNumber(const char* key, double max_value, bool may_be_zero) {
    const std::string text = Value(key);
    double value = 0.0;
    const auto [rest, wrong] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool in_range = value <= max_value && (may_be_zero ? value >= 0.0 : value > 0.0);
    if (wrong != std::errc{} || rest != text.data() + text.size() || !in_range)
      FailValue(key, Shown(text),
                max_value == kNoBound ? "a finite number above 0" : fmt::format("0 … {}", max_value));
    return value;
  }

  /// Reads the two lines of a property, its value and its source, into the material.
  void ReadFigure(const Figure& figure, Material& material) {
    material.*figure.value = ReadNumber(figure.key, figure.max_value, figure.may_be_zero);
    const std::string accepted = fmt::format("a line {}=… or {}=…", figure.source_key, figure.assumption_key);
    auto [key, source] = Next(accepted);
    if (key != figure.source_key && key != figure.assumption_key) Fail("a line " + Shown(key), accepted);
    material.*figure.source = {.text = source, .assumed = key == figure.assumption_key};
  }

  /// Stores an error at the beginning of the last line.
  void Fail(const std::string& found, const std::string& accepted) { Keep(line_, "", found, accepted); }
  /// Stores an error at the last line's value.
  void FailValue(const std::string& key, const std::string& found, const std::string& accepted) {
    Keep(value_, key, found, accepted);
  }

 private:
  /// Stores an error, unless there is an earlier one.
  void Keep(std::size_t byte, const std::string& where, const std::string& found,
            const std::string& accepted) {
    if (!error_) error_ = TextError{.byte = byte, .where = where, .found = found, .accepted = accepted};
  }

  /// The value with \n and \\ resolved; empty after an error.
  std::string Unescaped(std::string_view raw) {
    std::string out;
    for (std::size_t i = 0; i < raw.size();) {
      const std::size_t length = base::Utf8Length(raw.substr(i));
      const auto c = static_cast<unsigned char>(raw[i]);
      if (length == 0 || c < 0x20 || c == 0x7f) {
        Keep(value_ + i, "", Shown(raw.substr(i, 1)), kTextAccepted);
        return {};
      }
      if (c == '\\') {
        const char next = i + 1 < raw.size() ? raw[i + 1] : '\0';
        if (next != '\\' && next != 'n') {
          Keep(value_ + i, "", Shown(raw.substr(i, 2)), "\\\\ or \\n");
          return {};
        }
        out += next == 'n' ? '\n' : '\\';
        i += 2;
        continue;
      }
      out += raw.substr(i, length);
      i += length;
    }
    return out;
  }

  std::string_view text_;
  /// First bytes of the next line, of the last line that was read, and of its value
  std::size_t at_{0}, line_{0}, value_{0};
  std::optional<TextError> error_;
};

/// Whether a text consists of letters, digits and _.
bool IsKey(const std::string& key) {
  return !key.empty() && std::ranges::all_of(key, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

// Reads an edge force, and the chip's thickness at which the cutting energy was measured.
void ReadEdgeForce(LineReader& reader, Material& material) {
  reader.ReadFigure(kEdgeForce, material);
  material.measured_chip_m = reader.ReadNumber(kChipKey, kNoBound, false);
  const double max_force = material.specific_cutting_energy_J_per_m3 * material.measured_chip_m;
  if (!(material.edge_force_N_per_m < max_force))
    reader.FailValue(kChipKey, fmt::format("{}", material.measured_chip_m),
                     fmt::format("more than {} over {}", kEdgeForce.key, kFigures[1].key));
}

/// The two lines of a property, its value and its source.
std::string FigureText(const Figure& figure, const Material& material) {
  const FigureSource& source = material.*figure.source;
  return fmt::format("{}={}\n{}={}\n", figure.key, material.*figure.value,
                     source.assumed ? figure.assumption_key : figure.source_key, Escaped(source.text));
}

}  // namespace

tl::expected<std::string, TextError> MaterialsToText(const std::vector<Material>& materials) {
  std::string text;
  for (const Material& material : materials) {
    text += fmt::format("material={}\n", Escaped(material.name));
    for (const Figure& figure : kFigures) text += FigureText(figure, material);
    if (material.edge_force_N_per_m != 0.0)
      text += fmt::format("{}{}={}\n", FigureText(kEdgeForce, material), kChipKey, material.measured_chip_m);
  }
  // Check the text by reading it, so that the rules exist only once: a text that the reader refuses is not
  // written.
  if (const auto read = MaterialsFromText(text); !read) return tl::make_unexpected(read.error());
  return text;
}

tl::expected<std::vector<Material>, TextError> MaterialsFromText(std::string_view text) {
  const std::string accepted = fmt::format("1 … {} materials", kMaxMaterials);
  std::vector<Material> materials;
  std::set<std::string> names;
  LineReader reader(text);
  if (reader.AtEnd()) return tl::make_unexpected(TextError{0, "", "no material", accepted});
  while (!reader.AtEnd()) {
    Material material;
    material.name = reader.Value("material");
    if (materials.size() == kMaxMaterials) reader.Fail("a material more", accepted);
    if (material.name.empty()) reader.FailValue("material", "no name", "a name");
    if (!names.insert(material.name).second)
      reader.FailValue("material", Shown(material.name) + " a second time", "each name once");
    for (const Figure& figure : kFigures) reader.ReadFigure(figure, material);
    if (reader.NextIs(kEdgeForce.key)) ReadEdgeForce(reader, material);
    materials.push_back(std::move(material));
  }
  if (reader.error()) return tl::make_unexpected(*reader.error());
  return materials;
}

tl::expected<std::string, TextError> ProvenanceToText(const NamedProvenance& value) {
  const PackingProvenance& provenance = value.provenance;
  std::string text = fmt::format("bone={}\nprogram={}\nsource={}\n", Escaped(value.name),
                                 Escaped(provenance.program), Escaped(provenance.source));
  if (provenance.source_crc) text += fmt::format("{}={:08x}\n", kCrcKey, *provenance.source_crc);
  for (const auto& [key, each] : provenance.parameters) text += fmt::format("{}={}\n", key, Escaped(each));
  if (const auto read = ProvenanceFromText(text); !read) return tl::make_unexpected(read.error());
  return text;
}

tl::expected<NamedProvenance, TextError> ProvenanceFromText(std::string_view text) {
  NamedProvenance value;
  LineReader reader(text);
  value.name = reader.Value("bone");
  value.provenance.program = reader.Value("program");
  value.provenance.source = reader.Value("source");
  std::set<std::string> keys{"bone", "program", "source"};
  while (!reader.AtEnd()) {
    auto [key, parameter] = reader.Next("a line key=value");
    if (!IsKey(key)) reader.Fail("a key " + Shown(key), "letters, digits and _");
    if (!keys.insert(key).second) reader.Fail("the key " + key + " a second time", "each key once");
    if (key != kCrcKey) {
      value.provenance.parameters.emplace_back(std::move(key), std::move(parameter));
      continue;
    }
    std::uint32_t crc = 0;
    const char* end = parameter.data() + parameter.size();
    const auto [rest, wrong] = std::from_chars(parameter.data(), end, crc, 16);
    if (parameter.size() != 8 || wrong != std::errc{} || rest != end || !value.provenance.parameters.empty())
      reader.FailValue(kCrcKey, Shown(parameter), "8 hexadecimal digits, before all parameters");
    value.provenance.source_crc = crc;
  }
  if (reader.error()) return tl::make_unexpected(*reader.error());
  return value;
}

}  // namespace osteon::simulation
