#include "config/reading/strict/yaml_mapping.h"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/reading/strict/config_error.h"
#include "config/reading/strict/key_aliases.h"
#include "config/reading/strict/nearest_key.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/yaml_document.h"

namespace osteon::config {

YamlMapping::YamlMapping(std::filesystem::path file_in, const YAML::Node& node, int line_in,
                         const std::string& key, std::optional<std::string> place_in, const Base& base)
    : file(std::move(file_in)), base_file(base.file), place(std::move(place_in)), line(line_in) {
  if (!node.IsMap()) Fail(line, fmt::format("{}found {}, accepted a mapping", key, DescribeNode(node)));
  document = node;
  AddEntries(node);
  if (base.node) Extend(*base.node);
  if (!place) return;
  Overlay::ApplyTo(*place, [&](const OverlaidValue& overlaid) {
    const Entry entry{CurrentKey(overlaid.key), overlaid.line, overlaid.value, overlaid.file, {}};
    const auto overridden = std::ranges::find(entries, entry.key, &Entry::key);
    if (overridden == entries.end())
      entries.push_back(entry);
    else if (!overlaid.only_where_missing)
      *overridden = entry;
  });
}

bool YamlMapping::Record(const std::string& key, KeyInfo info) const {
  if (recorder) recorder->Note(recorded_place, key, std::move(info));
  return recorder != nullptr;
}

void YamlMapping::AddEntries(const YAML::Node& node) {
  // Lines of the keys. A map is used because a hostile file may have a hundred thousand keys.
  std::unordered_map<std::string, int> lines;
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

void YamlMapping::Extend(const YAML::Node& base) {
  const YamlMapping extended(base_file, base, LineOf(base), "");
  for (const Entry& entry : extended.entries) {
    const auto own = std::ranges::find(entries, entry.key, &Entry::key);
    if (own == entries.end())
      entries.push_back(entry);
    else if (own->value.IsMap() && entry.value.IsMap())
      own->base = entry.value;
  }
}

void YamlMapping::Fail(int at, const std::string& what) const { throw ConfigError(file.string(), at, what); }

void YamlMapping::FailValue(const std::string& key, const YAML::Node& node,
                            const std::string& accepted) const {
  throw ConfigError(FileOf(key).string(), LineOfValue(key, node),
                    fmt::format("{}: found {}, accepted {}", key, DescribeNode(node), accepted));
}

const std::filesystem::path& YamlMapping::FileOf(const std::string& key) const {
  const auto entry = std::ranges::find(entries, key, &Entry::key);
  return entry == entries.end() ? file : entry->file;
}

int YamlMapping::LineOfKey(const std::string& key) const {
  const auto entry = std::ranges::find(entries, key, &Entry::key);
  return entry == entries.end() ? line : entry->line;
}

int YamlMapping::LineOfValue(const std::string& key, const YAML::Node& node) const {
  const auto entry = std::ranges::find(entries, key, &Entry::key);
  if (!node.IsNull() && !(entry != entries.end() && entry->line == 0)) return LineOf(node);
  return entry == entries.end() ? line : entry->line;
}

const YamlMapping::Entry* YamlMapping::Find(const std::string& key, const std::string& accepted) {
  known.push_back(key);
  for (const Entry& entry : entries)
    if (entry.key == key) return &entry;
  if (!absent) missing.push_back({key, accepted});
  return nullptr;
}

double YamlMapping::NumberIn(const std::string& key, const YAML::Node& node, double min, double max) const {
  double value = 0.0;
  if (!ParseNumber(node, value) || value < min || value > max) FailValue(key, node, DescribeRange(min, max));
  return value;
}

std::string YamlMapping::KnownKeys() const {
  std::vector<std::string> keys = known;
  std::ranges::sort(keys);
  keys.erase(std::ranges::unique(keys).begin(), keys.end());
  return fmt::format("{}", fmt::join(keys, ", "));
}

void YamlMapping::Finish() const {
  // Report an unknown key before the missing keys, because it is probably a misspelt missing key.
  for (const Entry& entry : entries) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    std::vector<std::string> candidates;
    for (const Missing& gap : missing) candidates.push_back(gap.key);
    std::string nearest = NearestKey(entry.key, candidates);
    if (nearest.empty()) nearest = NearestKey(entry.key, known);
    throw ConfigError(
        entry.file.string(), entry.line,
        fmt::format("unknown key \"{}\"{}", entry.key.substr(0, 60),
                    nearest.empty() ? ", accepted " + KnownKeys() : "; did you mean \"" + nearest + "\"?"));
  }
  if (!missing.empty())
    Fail(line, fmt::format("missing key \"{}\", accepted {}", missing.front().key, missing.front().accepted));
  for (const auto& mapping : inner) mapping->Finish();
}

}  // namespace osteon::config
