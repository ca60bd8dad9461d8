#include "config/reading/strict/reader.h"

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

#include "config/reading/config_file_tracker.h"
#include "config/reading/named_file.h"
#include "config/reading/strict/key_aliases.h"
#include "config/reading/strict/key_table.h"
#include "config/reading/strict/nearest_key.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/units.h"

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

ConfigError::ConfigError(const std::string& text, const ConfigError& error)
    : std::runtime_error(text), file_(error.file_), line_(error.line_) {}

ConfigError ConfigError::With(const std::string& remark) const {
  return {std::string(what()) + remark, *this};
}

// One mapping and the keys requested of it. A missing section is a Mapping too: it is absent, and notes
// nothing.
struct Reader::Mapping {
  struct Entry {
    std::string key;
    int line{0};  // of the key
    YAML::Node value;
    std::filesystem::path file;        // that contains the entry; an overlay's is another file
    std::optional<YAML::Node> base{};  // the mapping of the extended file below this one
  };
  struct Missing {
    std::string key, accepted;
  };

  std::filesystem::path file;
  std::filesystem::path base_file;   // that this file extends; empty: none
  std::optional<std::string> place;  // key prefix within an overlay; empty: no overlay concerns it
  bool absent{false};
  int line{0};
  YAML::Node document;  // that the own entries come from
  std::vector<Entry> entries;
  std::vector<std::string> known;
  std::vector<Missing> missing;
  std::vector<std::shared_ptr<Mapping>> inner;
  KeyRecorder* recorder{nullptr};
  std::string recorded_place;

  // A mapping of the extended file.
  struct Base {
    std::filesystem::path file;
    std::optional<YAML::Node> node;
  };

  Mapping(std::filesystem::path file_in, const YAML::Node& node, int line_in, const std::string& key,
          std::optional<std::string> place_in = {}, const Base& base = {})
      : file(std::move(file_in)), base_file(base.file), place(std::move(place_in)), line(line_in) {
    if (!node.IsMap()) Fail(line, fmt::format("{}found {}, accepted a mapping", key, DescribeNode(node)));
    document = node;
    AddEntries(node);
    if (base.node) Extend(*base.node);
    if (!place) return;
    Overlay::ApplyTo(*place, [&](const OverlaidValue& over) {
      const Entry entry{CurrentKey(over.key), over.line, over.value, over.file, {}};
      const auto same = std::ranges::find(entries, entry.key, &Entry::key);
      if (same == entries.end())
        entries.push_back(entry);
      else if (!over.only_where_missing)
        *same = entry;
    });
  }
  explicit Mapping(std::filesystem::path file_in) : file(std::move(file_in)), absent(true) {}
  // A mapping of no file, whose keys are recorded (RecordKeys).
  Mapping(std::filesystem::path file_in, KeyRecorder& recorder_in, std::string place_in)
      : file(std::move(file_in)), absent(true), recorder(&recorder_in), recorded_place(std::move(place_in)) {}

  // Records a key, if this is what is done. @returns whether
  bool Record(const std::string& key, KeyInfo info) const {
    if (recorder) recorder->Note(recorded_place, key, std::move(info));
    return recorder != nullptr;
  }

  void AddEntries(const YAML::Node& node) {
    std::unordered_map<std::string, int> lines;  // of the keys; a map, as a hostile file may have a hundred
                                                 // thousand
    for (const auto& pair : node) {
      if (!pair.first.IsScalar()) Fail(LineOf(pair.first), "a key must be a word");
      const std::string& written = pair.first.Scalar();
      const Entry entry{CurrentKey(written), LineOf(pair.first), pair.second, file, {}};
      const auto [earlier, is_new] = lines.try_emplace(entry.key, entry.line);
      if (!is_new)
        Fail(entry.line, fmt::format("key \"{}\" again{}, first in line {}", entry.key,
                                     written == entry.key ? "" : " (by its older name \"" + written + "\")",
                                     earlier->second));
      entries.push_back(entry);
    }
  }

  // Adds the values of the extended file that this one does not have.
  void Extend(const YAML::Node& base) {
    const Mapping extended(base_file, base, LineOf(base), "");
    for (const Entry& entry : extended.entries) {
      const auto own = std::ranges::find(entries, entry.key, &Entry::key);
      if (own == entries.end())
        entries.push_back(entry);
      else if (own->value.IsMap() && entry.value.IsMap())
        own->base = entry.value;
    }
  }

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

  [[nodiscard]] int LineOfKey(const std::string& key) const {
    const auto entry = std::ranges::find(entries, key, &Entry::key);
    return entry == entries.end() ? line : entry->line;
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

namespace {

std::string TextOf(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw ConfigError(path.string(), 0, "no such file");
  if (std::filesystem::file_size(path, error) > kMaxFile)
    throw ConfigError(path.string(), 0, "larger than 1 MiB: not a configuration");
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw ConfigError(path.string(), 0, "can not be read");
  ConfigFileTracker::RecordFile(path);
  return text.str();
}

YAML::Node DocumentOf(const std::string& text, const std::filesystem::path& name) {
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
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.is_null() ? 0 : error.mark.line + 1;
    if (HasTabInIndentation(text, line))
      throw ConfigError(name.string(), line, "not YAML: found a tab before the text, accepted blanks alone");
    throw ConfigError(name.string(), line, "not YAML: " + error.msg);
  }
}

// Removes the key "start.arm_angle_deg" of a mapping. @returns whether it was there
bool RemoveKey(YAML::Node mapping, const std::string& key) {
  if (!mapping.IsDefined() || !mapping.IsMap()) return false;
  const std::size_t dot = key.find('.');
  const std::string first = key.substr(0, dot);
  if (dot == std::string::npos) return mapping.remove(WrittenKey(mapping, first));
  return RemoveKey(mapping[first], key.substr(dot + 1));
}

}  // namespace

Reader Reader::Load(const std::filesystem::path& path) {
  if (KeyRecorder* recorder = KeyRecorder::Present())
    return Reader(std::make_shared<Mapping>(path, *recorder, ""));
  return Parse(TextOf(path), path);
}

Reader Reader::LoadExtending(const std::filesystem::path& path, const std::string& kind) {
  Reader own = Load(path);
  if (own.mapping_->recorder) {
    if (own.Has("extends")) static_cast<void>(own.File("extends", kind));
    static_cast<void>(own.Has("remove"));
    return own;
  }
  const YAML::Node document = own.mapping_->document;
  if (!own.Has("extends")) {
    if (own.Has("remove")) own.Refuse("remove", "found without extends, accepted with it");
    return own;
  }
  const std::filesystem::path base_file = own.FindFile("extends", kind);
  const auto same = [](const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    return std::filesystem::equivalent(a, b, error);
  };
  if (same(base_file, path))
    own.Refuse("extends",
               fmt::format("found {}, which is this file, accepted another one", base_file.string()));
  // its own reader, for its own errors: a mapping of different keys
  Reader base = Load(base_file);
  if (base.Has("extends")) {
    const std::string next = base.mapping_->Find("extends", "")->value.as<std::string>("");
    own.Refuse(
        "extends",
        fmt::format("found {}, which extends {} itself ({}:{}), accepted a file that extends "
                    "none: one level",
                    base_file.string(), next, base_file.string(), base.mapping_->LineOfKey("extends")));
  }
  const YAML::Node base_document = base.mapping_->document;
  if (own.Has("remove")) {
    const YAML::Node list = own.mapping_->Find("remove", "")->value;
    constexpr const char* kAccepted = "a list of keys of the extended file, e.g. [start.arm_angle_deg]";
    if (!list.IsSequence()) own.mapping_->FailValue("remove", list, kAccepted);
    for (const YAML::Node& key : list) {
      if (!key.IsScalar()) own.mapping_->FailValue("remove", key, kAccepted);
      if (!RemoveKey(base_document, key.Scalar()))
        own.mapping_->FailValue("remove", key, "a key that " + base_file.string() + " has");
    }
  }
  // Overrides apply to the file that is loaded, so a mapping is made anew with the other one beneath it.
  Reader merged(std::make_shared<Mapping>(path, document, LineOf(document), "", Overlay::PlaceOf(path),
                                          Mapping::Base{base_file, base_document}));
  merged.mapping_->known = {"extends", "remove"};
  return merged;
}

Reader Reader::Parse(const std::string& text, const std::filesystem::path& name) {
  const YAML::Node document = DocumentOf(text, name);
  return Reader(std::make_shared<Mapping>(name, document, LineOf(document), "", Overlay::PlaceOf(name)));
}

std::filesystem::path Reader::Extended() const { return mapping_->base_file; }

bool Reader::Has(const std::string& key) {
  if (mapping_->recorder) return mapping_->recorder->NoteOptional(mapping_->recorded_place, key);
  mapping_->known.push_back(key);
  return std::any_of(mapping_->entries.begin(), mapping_->entries.end(),
                     [&](const Mapping::Entry& entry) { return entry.key == key; });
}

double Reader::Number(const std::string& key, double min, double max) {
  const double unit = UnitOrThrow(key);
  if (mapping_->Record(key, {.type = KeyInfo::Type::kNumber, .min = min, .max = max}))
    return unit * std::clamp(0.0, min, max);
  const Mapping::Entry* entry = mapping_->Find(key, DescribeRange(min, max));
  return unit * (entry ? mapping_->NumberIn(key, entry->value, min, max) : min);
}

std::vector<double> Reader::Numbers(const std::string& key, std::size_t size, double min, double max) {
  const double unit = UnitOrThrow(key);
  const std::string accepted = fmt::format("a list of {} numbers {}", size, DescribeRange(min, max));
  std::vector<double> values(size, unit * min);
  if (mapping_->Record(key, {.type = KeyInfo::Type::kNumbers, .min = min, .max = max, .size = size}))
    return std::vector<double>(size, unit * std::clamp(0.0, min, max));
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
  if (mapping_->recorder) return Vector3::UnitZ();
  const auto is_this = [&](const Mapping::Entry& entry) { return entry.key == key; };
  if (std::none_of(mapping_->entries.begin(), mapping_->entries.end(), is_this)) return Vector3::UnitZ();
  if (!(std::abs(found.norm() - 1.0) <= 1e-3))
    Refuse(key, fmt::format("found a length of {:.6g}, accepted 1", found.norm()));
  return found.normalized();
}

int Reader::WholeNumber(const std::string& key, int min, int max) {
  static_cast<void>(UnitOrThrow(key));
  if (mapping_->Record(key, {.type = KeyInfo::Type::kWhole, .min = double(min), .max = double(max)}))
    return std::clamp(0, min, max);
  const std::string accepted = fmt::format("a whole number {} … {}", min, max);
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  int value = min;
  if (entry && (!ParseNumber(entry->value, value) || value < min || value > max))
    mapping_->FailValue(key, entry->value, accepted);
  return value;
}

bool Reader::Bool(const std::string& key) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kBool}))
    return mapping_->recorder->Decide("bool " + mapping_->recorded_place + key, 2) == 1;
  return Choice(key, {"false", "true"}) == 1;
}

std::string Reader::Text(const std::string& key) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kText})) return "text";
  const std::string accepted = "a text";
  const Mapping::Entry* entry = mapping_->Find(key, accepted);
  if (!entry) return {};
  if (!entry->value.IsScalar() || entry->value.Scalar().empty())
    mapping_->FailValue(key, entry->value, accepted);
  return entry->value.Scalar();
}

std::size_t Reader::Choice(const std::string& key, std::initializer_list<const char*> accepted) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kChoice, .words = {accepted.begin(), accepted.end()}})) {
    const std::size_t answer =
        mapping_->recorder->Decide("choice " + mapping_->recorded_place + key, accepted.size());
    mapping_->recorder->NoteWord(mapping_->recorded_place, key, accepted.begin()[answer]);
    return answer;
  }
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
  if (mapping_->Record(key, {.type = KeyInfo::Type::kWords, .words = {accepted.begin(), accepted.end()}}))
    return {};
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

std::filesystem::path Reader::File(const std::string& key) { return File(key, ""); }

std::filesystem::path Reader::File(const std::string& key, const std::string& kind) {
  const std::filesystem::path path = FindFile(key, kind);
  if (mapping_->place && !path.empty()) Overlay::RecordNamedFile(path, *mapping_->place + key + ".");
  return path;
}

std::filesystem::path Reader::FindFile(const std::string& key, const std::string& kind) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kFile, .folder = kind})) return "recorded";
  const Mapping::Entry* entry = mapping_->Find(key, "a file's path");
  if (!entry) return {};
  if (!entry->value.IsScalar() || entry->value.Scalar().empty())
    mapping_->FailValue(key, entry->value, "a file's path");
  const std::string& named = entry->value.Scalar();
  std::filesystem::path path;
  if (!kind.empty() && named.find('/') == std::string::npos && !named.ends_with(".yaml")) {
    path = ConfigFileTracker::FindByName(entry->file, kind, named);
    if (path.empty())
      mapping_->FailValue(key, entry->value,
                          fmt::format("a file's path, or one of {}: {}", (ShippedFolder() / kind).string(),
                                      YamlNamesIn(ShippedFolder() / kind)));
  } else {
    path = ConfigFileTracker::ResolveNamed(entry->file.parent_path(), named);
    if (path.empty()) mapping_->FailValue(key, entry->value, "a file beside it (this one is not among them)");
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
      mapping_->FailValue(key, entry->value, fmt::format("an existing file (there is no {})", path.string()));
  }
  return path;
}

Reader Reader::Section(const std::string& key) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kSection}))
    return Reader(
        std::make_shared<Mapping>(mapping_->file, *mapping_->recorder, mapping_->recorded_place + key + "."));
  const Mapping::Entry* entry = mapping_->Find(key, "a mapping");
  std::optional<std::string> place;
  if (mapping_->place) place = *mapping_->place + key + ".";
  auto inner =
      entry ? std::make_shared<Mapping>(entry->file, entry->value, mapping_->LineOfValue(key, entry->value),
                                        key + ": ", place, Mapping::Base{mapping_->base_file, entry->base})
            : std::make_shared<Mapping>(mapping_->file);
  mapping_->inner.push_back(inner);
  return Reader(inner);
}

Reader Reader::OneSection(std::initializer_list<const char*> keys) {
  std::string all;
  const char* found = nullptr;
  if (mapping_->recorder) {
    std::string question = "one " + mapping_->recorded_place;
    for (const char* key : keys) question += std::string(key) + " ";
    const std::size_t answer = mapping_->recorder->Decide(question, keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i)
      mapping_->recorder->Choose(mapping_->recorded_place, keys.begin()[i], i == answer);
    return Section(keys.begin()[answer]);
  }
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
  if (mapping_->Record(key, {.type = KeyInfo::Type::kList, .min = double(min), .max = double(max)})) {
    std::vector<Reader> all;
    for (std::size_t i = 0; i < std::max<std::size_t>(min, 1); ++i)
      all.push_back(Reader(std::make_shared<Mapping>(mapping_->file, *mapping_->recorder,
                                                     mapping_->recorded_place + key + "[].")));
    return all;
  }
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

void Reader::Finish() const {
  if (mapping_->recorder) return mapping_->recorder->Finish(mapping_->recorded_place);
  mapping_->Finish();
}

std::string Reader::PlaceOf(const std::string& key) const {
  return fmt::format("{}:{}", mapping_->FileOf(key).string(), mapping_->LineOfKey(key));
}

void Reader::Refuse(const std::string& key, const std::string& what) const {
  throw ConfigError(mapping_->FileOf(key).string(), mapping_->LineOfKey(key),
                    fmt::format("{}: {}", key, what));
}

}  // namespace osteon::config
