#include "config/reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <unordered_map>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "config/config_file_tracker.h"
#include "config/nearest_key.h"
#include "config/overlay.h"
#include "config/units.h"

namespace osteon::config {
namespace {

constexpr std::uintmax_t kMaxFile = 1 << 20;  // bytes; ours have a few kB

int LineOf(const YAML::Node& node) { return node.Mark().is_null() ? 0 : node.Mark().line + 1; }

// The user's input, shortened for an error.
std::string DescribeNode(const YAML::Node& node) {
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return fmt::format("a list of {}", node.size());
  if (node.IsNull()) return "nothing";
  std::string text = node.Scalar().substr(0, 40);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return node.Tag() == "!" ? '"' + text + '"' : text;
}

// Counts the documents that a parser finds, and notes whether they have content.
class DocumentCounter final : public YAML::EventHandler {
 public:
  int count{0};
  int line{0};  // first line of the last document
  bool has_content{false};

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++count;
    line = mark.line + 1;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { has_content = true; }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {
    has_content = true;
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    has_content = true;
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    has_content = true;
  }
  void OnMapEnd() override {}
};

std::string DescribeRange(double min, double max) { return fmt::format("{:.10g} … {:.10g}", min, max); }

// Plain scalars only ("25" in quotes is a text); no locale, no hexadecimal, no nan or inf.
template <typename T>
bool ParseNumber(const YAML::Node& node, T& value) {
  if (!node.IsScalar() || node.Tag() == "!") return false;
  const std::string& text = node.Scalar();
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(static_cast<double>(value));
}

// Whether a tab indents the line, which YAML forbids and its parser reports in several ways.
bool HasTabInIndentation(const std::string& text, int line) {
  std::istringstream lines(text);
  std::string each;
  for (int i = 0; i < line; ++i)
    if (!std::getline(lines, each)) return false;
  return each.substr(0, each.find_first_not_of(" \t")).find('\t') != std::string::npos;
}

double UnitOrThrow(const std::string& key) {
  const std::optional<double> unit = UnitOf(key);
  if (!unit) throw std::logic_error("config: the key \"" + key + "\" names no unit");
  return *unit;
}

}  // namespace

ConfigError::ConfigError(const std::string& file, int line, const std::string& what)
    : std::runtime_error(line > 0 ? fmt::format("{}:{}: {}", file, line, what)
                                  : fmt::format("{}: {}", file, what)),
      file_(file),
      line_(line) {}

// One mapping and the keys requested of it. A missing section is a Mapping too: it is absent, and notes
// nothing.
struct Reader::Mapping {
  struct Entry {
    std::string key;
    int line{0};  // of the key
    YAML::Node value;
    std::filesystem::path file;  // that contains the entry; an overlay's is another file
  };
  struct Missing {
    std::string key, accepted;
  };

  std::filesystem::path file;
  std::optional<std::string> place;  // key prefix within an overlay; empty: no overlay concerns it
  bool absent{false};
  int line{0};
  std::vector<Entry> entries;
  std::vector<std::string> known;
  std::vector<Missing> missing;
  std::vector<std::shared_ptr<Mapping>> inner;

  Mapping(std::filesystem::path file_in, const YAML::Node& node, int line_in, const std::string& key,
          std::optional<std::string> place_in = {})
      : file(std::move(file_in)), place(std::move(place_in)), line(line_in) {
    if (!node.IsMap()) Fail(line, fmt::format("{}found {}, accepted a mapping", key, DescribeNode(node)));
    std::unordered_map<std::string, int> lines;  // of the keys; a map, as a hostile file may have a hundred
                                                 // thousand
    for (const auto& pair : node) {
      if (!pair.first.IsScalar()) Fail(LineOf(pair.first), "a key must be a word");
      const Entry entry{pair.first.Scalar(), LineOf(pair.first), pair.second, file};
      const auto [earlier, is_new] = lines.try_emplace(entry.key, entry.line);
      if (!is_new)
        Fail(entry.line, fmt::format("key \"{}\" again, first in line {}", entry.key, earlier->second));
      entries.push_back(entry);
    }
    if (!place) return;
    Overlay::ApplyTo(*place, [&](const OverlaidValue& over) {
      const Entry entry{over.key, over.line, over.value, over.file};
      const auto same = std::ranges::find(entries, over.key, &Entry::key);
      if (same == entries.end())
        entries.push_back(entry);
      else if (!over.only_where_missing)
        *same = entry;
    });
  }
  explicit Mapping(std::filesystem::path file_in) : file(std::move(file_in)), absent(true) {}

  [[noreturn]] void Fail(int at, const std::string& what) const {
    throw ConfigError(file.string(), at, what);
  }

  [[noreturn]] void FailValue(const std::string& key, const YAML::Node& node,
                              const std::string& accepted) const {
    throw ConfigError(FileOf(key).string(), LineOfValue(key, node),
                      fmt::format("{}: found {}, accepted {}", key, DescribeNode(node), accepted));
  }

  [[nodiscard]] const std::filesystem::path& FileOf(const std::string& key) const {
    const auto entry = std::ranges::find(entries, key, &Entry::key);
    return entry == entries.end() ? file : entry->file;
  }

  // YAML marks an absent value at the next token, so the key's line is used instead. An override from the
  // command line has no line.
  [[nodiscard]] int LineOfValue(const std::string& key, const YAML::Node& node) const {
    const auto entry = std::ranges::find(entries, key, &Entry::key);
    if (!node.IsNull() && !(entry != entries.end() && entry->line == 0)) return LineOf(node);
    return entry == entries.end() ? line : entry->line;
  }

  // The value of a key, or null (and the gap is noted).
  const Entry* Find(const std::string& key, const std::string& accepted) {
    known.push_back(key);
    for (const Entry& entry : entries)
      if (entry.key == key) return &entry;
    if (!absent) missing.push_back({key, accepted});
    return nullptr;
  }

  double NumberIn(const std::string& key, const YAML::Node& node, double min, double max) const {
    double value = 0.0;
    if (!ParseNumber(node, value) || value < min || value > max)
      FailValue(key, node, DescribeRange(min, max));
    return value;
  }

  void Finish() const {
    // report an unknown key before the missing keys: it is probably one of them, misspelt
    for (const Entry& entry : entries) {
      if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
      std::vector<std::string> candidates;
      for (const Missing& gap : missing) candidates.push_back(gap.key);
      std::string nearest = NearestKey(entry.key, candidates);
      if (nearest.empty()) nearest = NearestKey(entry.key, known);
      throw ConfigError(entry.file.string(), entry.line,
                        fmt::format("unknown key \"{}\"{}", entry.key.substr(0, 60),
                                    nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
    }
    if (!missing.empty())
      Fail(line,
           fmt::format("missing key \"{}\", accepted {}", missing.front().key, missing.front().accepted));
    for (const auto& mapping : inner) mapping->Finish();
  }
};

Reader Reader::Load(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw ConfigError(path.string(), 0, "no such file");
  if (std::filesystem::file_size(path, error) > kMaxFile)
    throw ConfigError(path.string(), 0, "larger than 1 MiB: not a configuration");
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw ConfigError(path.string(), 0, "can not be read");
  ConfigFileTracker::RecordFile(path);
  return Parse(text.str(), path);
}

Reader Reader::Parse(const std::string& text, const std::filesystem::path& name) {
  YAML::Node document;
  try {
    // YAML::LoadAll loops for ever on a text that begins with an invalid token (", a"): it consumes nothing
    // and finds the same again. So documents are counted first, up to the second one.
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentCounter counter;
    while (counter.count < 2 && parser.HandleNextDocument(counter)) {
    }
    if (counter.count > 1 && !counter.has_content)
      throw ConfigError(name.string(), counter.line, "not YAML: a document can not begin like this");
    if (counter.count != 1)
      throw ConfigError(name.string(), 0, fmt::format("found {} documents, accepted 1", counter.count));
    document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.is_null() ? 0 : error.mark.line + 1;
    if (HasTabInIndentation(text, line))
      throw ConfigError(name.string(), line, "not YAML: found a tab before the text, accepted blanks alone");
    throw ConfigError(name.string(), line, "not YAML: " + error.msg);
  }
  return Reader(std::make_shared<Mapping>(name, document, LineOf(document), "", Overlay::PlaceOf(name)));
}

bool Reader::Has(const std::string& key) {
  mapping_->known.push_back(key);
  return std::any_of(mapping_->entries.begin(), mapping_->entries.end(),
                     [&](const Mapping::Entry& entry) { return entry.key == key; });
}

double Reader::Number(const std::string& key, double min, double max) {
  const double unit = UnitOrThrow(key);
  const Mapping::Entry* entry = mapping_->Find(key, DescribeRange(min, max));
  return unit * (entry ? mapping_->NumberIn(key, entry->value, min, max) : min);
}

std::vector<double> Reader::Numbers(const std::string& key, std::size_t size, double min, double max) {
  const double unit = UnitOrThrow(key);
  const std::string accepted = fmt::format("a list of {} numbers {}", size, DescribeRange(min, max));
  std::vector<double> values(size, unit * min);
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  if (!entry) return values;
  if (!entry->value.IsSequence() || entry->value.size() != size)
    mapping_->FailValue(key, entry->value, accepted);
  for (std::size_t i = 0; i < size; ++i)
    values[i] = unit * mapping_->NumberIn(key, entry->value[i], min, max);
  return values;
}

Vector3 Reader::Triple(const std::string& key, double min, double max) {
  return Vector3(Numbers(key, 3, min, max).data());
}

Vector3 Reader::Direction(const std::string& key) {
  const Vector3 found = Triple(key, -1.0, 1.0);
  const auto is_this = [&](const Mapping::Entry& entry) { return entry.key == key; };
  if (std::none_of(mapping_->entries.begin(), mapping_->entries.end(), is_this)) return Vector3::UnitZ();
  if (!(std::abs(found.norm() - 1.0) <= 1e-3))
    Refuse(key, fmt::format("found a length of {:.6g}, accepted 1", found.norm()));
  return found.normalized();
}

int Reader::WholeNumber(const std::string& key, int min, int max) {
  static_cast<void>(UnitOrThrow(key));
  const std::string accepted = fmt::format("a whole number {} … {}", min, max);
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  int value = min;
  if (entry && (!ParseNumber(entry->value, value) || value < min || value > max))
    mapping_->FailValue(key, entry->value, accepted);
  return value;
}

bool Reader::Bool(const std::string& key) { return Choice(key, {"false", "true"}) == 1; }

std::string Reader::Text(const std::string& key) {
  const std::string accepted = "a text";
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  if (!entry) return {};
  if (!entry->value.IsScalar() || entry->value.Scalar().empty())
    mapping_->FailValue(key, entry->value, accepted);
  return entry->value.Scalar();
}

std::size_t Reader::Choice(const std::string& key, std::initializer_list<const char*> accepted) {
  std::string words;
  for (const char* word : accepted) words += words.empty() ? word : std::string(", ") + word;
  const Mapping::Entry* entry = mapping_->Find(key, words);
  if (!entry) return 0;
  std::size_t place = 0;
  for (const char* word : accepted) {
    if (entry->value.IsScalar() && entry->value.Scalar() == word) return place;
    ++place;
  }
  mapping_->FailValue(key, entry->value, words);
}

std::vector<std::size_t> Reader::Words(const std::string& key, std::initializer_list<const char*> accepted) {
  std::string words = "a list of any of ";
  for (const char* word : accepted) words += word == *accepted.begin() ? word : std::string(", ") + word;
  std::vector<std::size_t> places;
  const Mapping::Entry* entry = mapping_->Find(key, words);
  if (!entry) return places;
  if (!entry->value.IsSequence()) mapping_->FailValue(key, entry->value, words);
  for (const YAML::Node& each : entry->value) {
    const auto found = std::find_if(accepted.begin(), accepted.end(), [&](const char* word) {
      return each.IsScalar() && each.Scalar() == word;
    });
    if (found == accepted.end()) mapping_->FailValue(key, each, words);
    const auto place = static_cast<std::size_t>(found - accepted.begin());
    if (std::find(places.begin(), places.end(), place) != places.end())
      mapping_->FailValue(key, each, words + ", none twice");
    places.push_back(place);
  }
  return places;
}

std::filesystem::path Reader::File(const std::string& key) {
  const Mapping::Entry* entry = mapping_->Find(key, "a file's path");
  if (!entry) return {};
  if (!entry->value.IsScalar() || entry->value.Scalar().empty())
    mapping_->FailValue(key, entry->value, "a file's path");
  const std::filesystem::path path =
      ConfigFileTracker::ResolveNamed(entry->file.parent_path(), entry->value.Scalar());
  if (path.empty()) mapping_->FailValue(key, entry->value, "a file beside it (this one is not among them)");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    mapping_->FailValue(key, entry->value, fmt::format("an existing file (there is no {})", path.string()));
  if (mapping_->place) Overlay::RecordNamedFile(path, *mapping_->place + key + ".");
  return path;
}

Reader Reader::Section(const std::string& key) {
  const Mapping::Entry* entry = mapping_->Find(key, "a mapping");
  std::optional<std::string> place;
  if (mapping_->place) place = *mapping_->place + key + ".";
  auto inner = entry ? std::make_shared<Mapping>(entry->file, entry->value,
                                                 mapping_->LineOfValue(key, entry->value), key + ": ", place)
                     : std::make_shared<Mapping>(mapping_->file);
  mapping_->inner.push_back(inner);
  return Reader(inner);
}

Reader Reader::OneSection(std::initializer_list<const char*> keys) {
  std::string all;
  const char* found = nullptr;
  for (const char* key : keys) {
    all += all.empty() ? key : std::string(", ") + key;
    if (!Has(key)) continue;
    if (found) Refuse(key, fmt::format("found beside {}, accepted one of {}", found, all));
    found = key;
  }
  if (found) return Section(found);
  if (!mapping_->absent)
    for (const char* key : keys) mapping_->missing.push_back({key, "one of " + all});
  return Reader(std::make_shared<Mapping>(mapping_->file));
}

std::vector<Reader> Reader::Sections(const std::string& key, std::size_t min, std::size_t max) {
  const std::string accepted = min == max ? fmt::format("a list of {} mappings", min)
                                          : fmt::format("a list of {} … {} mappings", min, max);
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  std::vector<Reader> sections;
  if (!entry) {
    for (std::size_t i = 0; i < min; ++i)
      sections.push_back(Reader(std::make_shared<Mapping>(mapping_->file)));
    return sections;
  }
  const YAML::Node& list = entry->value;
  if (!list.IsSequence() || list.size() < min || list.size() > max) mapping_->FailValue(key, list, accepted);
  for (const YAML::Node& node : list) {
    mapping_->inner.push_back(
        std::make_shared<Mapping>(entry->file, node, mapping_->LineOfValue(key, node), key + ": "));
    sections.push_back(Reader(mapping_->inner.back()));
  }
  return sections;
}

void Reader::Finish() const { mapping_->Finish(); }

void Reader::Refuse(const std::string& key, const std::string& what) const {
  const auto entry = std::ranges::find(mapping_->entries, key, &Mapping::Entry::key);
  throw ConfigError(mapping_->FileOf(key).string(),
                    entry == mapping_->entries.end() ? mapping_->line : entry->line,
                    fmt::format("{}: {}", key, what));
}

}  // namespace osteon::config
