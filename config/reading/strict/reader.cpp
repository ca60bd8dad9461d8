#include "config/reading/strict/reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "config/reading/config_file_tracker.h"
#include "config/reading/named_file.h"
#include "config/reading/strict/key_aliases.h"
#include "config/reading/strict/key_table.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/units.h"
#include "config/reading/strict/yaml_document.h"
#include "config/reading/strict/yaml_mapping.h"

namespace osteon::config {
namespace {

// Factor from the unit that a key names to SI.
double UnitOrThrow(const std::string& key) {
  const std::optional<double> unit = UnitOf(key);
  if (!unit) throw std::logic_error("config: the key \"" + key + "\" names no unit");
  return *unit;
}

}  // namespace

Reader Reader::Load(const std::filesystem::path& path) {
  if (KeyRecorder* recorder = KeyRecorder::Present())
    return Reader(std::make_shared<YamlMapping>(path, *recorder, ""));
  return Parse(ReadYamlText(path), path);
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
  const auto is_same_file = [](const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    return std::filesystem::equivalent(a, b, error);
  };
  if (is_same_file(base_file, path))
    own.Refuse("extends",
               fmt::format("found {}, which is this file, accepted another one", base_file.string()));
  // The extended file gets its own reader, so that errors in it (no mapping, or keys that are not unique)
  // name that file.
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
  // Make a new mapping of this file's entries, then those of the extended file, then the overrides.
  Reader merged(std::make_shared<YamlMapping>(path, document, LineOf(document), "", Overlay::PlaceOf(path),
                                              YamlMapping::Base{base_file, base_document}));
  merged.mapping_->known = {"extends", "remove"};
  return merged;
}

Reader Reader::Parse(const std::string& text, const std::filesystem::path& name) {
  const YAML::Node document = ParseYamlDocument(text, name);
  return Reader(std::make_shared<YamlMapping>(name, document, LineOf(document), "", Overlay::PlaceOf(name)));
}

std::filesystem::path Reader::Extended() const { return mapping_->base_file; }

bool Reader::Has(const std::string& key) {
  if (mapping_->recorder) return mapping_->recorder->NoteOptional(mapping_->recorded_place, key);
  mapping_->known.push_back(key);
  return std::any_of(mapping_->entries.begin(), mapping_->entries.end(),
                     [&](const YamlMapping::Entry& entry) { return entry.key == key; });
}

double Reader::Number(const std::string& key, double min, double max) {
  const double unit = UnitOrThrow(key);
  if (mapping_->Record(key, {.type = KeyInfo::Type::kNumber, .min = min, .max = max}))
    return unit * std::clamp(0.0, min, max);
  const YamlMapping::Entry* entry = mapping_->Find(key, DescribeRange(min, max));
  return unit * (entry ? mapping_->NumberIn(key, entry->value, min, max) : min);
}

std::vector<double> Reader::Numbers(const std::string& key, std::size_t size, double min, double max) {
  const double unit = UnitOrThrow(key);
  const std::string accepted = fmt::format("a list of {} numbers {}", size, DescribeRange(min, max));
  std::vector<double> values(size, unit * min);
  if (mapping_->Record(key, {.type = KeyInfo::Type::kNumbers, .min = min, .max = max, .size = size}))
    return std::vector<double>(size, unit * std::clamp(0.0, min, max));
  const YamlMapping::Entry* entry = mapping_->Find(key, accepted);
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
  // for a missing key an accepted value is returned, and Finish() reports the key
  const auto has_key = [&](const YamlMapping::Entry& entry) { return entry.key == key; };
  if (std::none_of(mapping_->entries.begin(), mapping_->entries.end(), has_key)) return Vector3::UnitZ();
  if (!(std::abs(found.norm() - 1.0) <= 1e-3))
    Refuse(key, fmt::format("found a length of {:.6g}, accepted 1", found.norm()));
  return found.normalized();
}

int Reader::WholeNumber(const std::string& key, int min, int max) {
  static_cast<void>(UnitOrThrow(key));
  if (mapping_->Record(key, {.type = KeyInfo::Type::kWhole, .min = double(min), .max = double(max)}))
    return std::clamp(0, min, max);
  const std::string accepted = fmt::format("a whole number {} … {}", min, max);
  const YamlMapping::Entry* entry = mapping_->Find(key, accepted);
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
  const YamlMapping::Entry* entry = mapping_->Find(key, accepted);
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
  const YamlMapping::Entry* entry = mapping_->Find(key, words);
  if (!entry) return 0;
  std::size_t index = 0;
  for (const char* word : accepted) {
    if (entry->value.IsScalar() && entry->value.Scalar() == word) return index;
    ++index;
  }
  mapping_->FailValue(key, entry->value, words);
}

std::vector<std::size_t> Reader::Words(const std::string& key, std::initializer_list<const char*> accepted) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kWords, .words = {accepted.begin(), accepted.end()}}))
    return {};
  std::string words = "a list of any of ";
  for (const char* word : accepted) words += word == *accepted.begin() ? word : std::string(", ") + word;
  std::vector<std::size_t> indices;
  const YamlMapping::Entry* entry = mapping_->Find(key, words);
  if (!entry) return indices;
  if (!entry->value.IsSequence()) mapping_->FailValue(key, entry->value, words);
  for (const YAML::Node& each : entry->value) {
    const auto found = std::find_if(accepted.begin(), accepted.end(), [&](const char* word) {
      return each.IsScalar() && each.Scalar() == word;
    });
    if (found == accepted.end()) mapping_->FailValue(key, each, words);
    const auto index = static_cast<std::size_t>(found - accepted.begin());
    if (std::find(indices.begin(), indices.end(), index) != indices.end())
      mapping_->FailValue(key, each, words + ", none twice");
    indices.push_back(index);
  }
  return indices;
}

std::filesystem::path Reader::File(const std::string& key) { return File(key, ""); }

std::filesystem::path Reader::File(const std::string& key, const std::string& kind) {
  const std::filesystem::path path = FindFile(key, kind);
  if (mapping_->place && !path.empty()) Overlay::RecordNamedFile(path, *mapping_->place + key + ".");
  return path;
}

std::filesystem::path Reader::FindFile(const std::string& key, const std::string& kind) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kFile, .folder = kind})) return "recorded";
  const YamlMapping::Entry* entry = mapping_->Find(key, "a file's path");
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
    return Reader(std::make_shared<YamlMapping>(mapping_->file, *mapping_->recorder,
                                                mapping_->recorded_place + key + "."));
  const YamlMapping::Entry* entry = mapping_->Find(key, "a mapping");
  std::optional<std::string> place;
  if (mapping_->place) place = *mapping_->place + key + ".";
  auto inner = entry ? std::make_shared<YamlMapping>(
                           entry->file, entry->value, mapping_->LineOfValue(key, entry->value), key + ": ",
                           place, YamlMapping::Base{mapping_->base_file, entry->base})
                     : std::make_shared<YamlMapping>(mapping_->file);
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
  return Reader(std::make_shared<YamlMapping>(mapping_->file));
}

std::vector<Reader> Reader::Sections(const std::string& key, std::size_t min, std::size_t max) {
  if (mapping_->Record(key, {.type = KeyInfo::Type::kList, .min = double(min), .max = double(max)})) {
    std::vector<Reader> all;
    for (std::size_t i = 0; i < std::max<std::size_t>(min, 1); ++i)
      all.push_back(Reader(std::make_shared<YamlMapping>(mapping_->file, *mapping_->recorder,
                                                         mapping_->recorded_place + key + "[].")));
    return all;
  }
  const std::string accepted = min == max ? fmt::format("a list of {} mappings", min)
                                          : fmt::format("a list of {} … {} mappings", min, max);
  const YamlMapping::Entry* entry = mapping_->Find(key, accepted);
  std::vector<Reader> sections;
  if (!entry) {
    for (std::size_t i = 0; i < min; ++i)
      sections.push_back(Reader(std::make_shared<YamlMapping>(mapping_->file)));
    return sections;
  }
  const YAML::Node& list = entry->value;
  if (!list.IsSequence() || list.size() < min || list.size() > max) mapping_->FailValue(key, list, accepted);
  for (const YAML::Node& node : list) {
    mapping_->inner.push_back(
        std::make_shared<YamlMapping>(entry->file, node, mapping_->LineOfValue(key, node), key + ": "));
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
