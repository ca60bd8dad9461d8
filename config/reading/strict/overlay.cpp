#include "config/reading/strict/overlay.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "config/reading/named_file.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

// the overlay of this thread, while it exists; otherwise null
thread_local Overlay* present_overlay = nullptr;

// Whether a text consists of words separated by dots, as "limits.max_force_N".
bool IsKey(const std::string& key) {
  return !key.empty() && key.front() != '.' && key.back() != '.' && key.find("..") == std::string::npos;
}

constexpr const char* kAcceptedKey = "accepted keys with dots between them, e.g. limits.max_force_N";

}  // namespace

struct Overlay::Value {
  std::string key;  // the complete key
  YAML::Node value;
  std::filesystem::path file;
  int line{0};
  bool used{false};
};

Overlay::Overlay(const std::filesystem::path& root) {
  if (present_overlay) throw std::logic_error("config: an Overlay inside another");
  named_.push_back({.file = AbsolutePath(root), .place = ""});
  present_overlay = this;
}

Overlay::~Overlay() { present_overlay = nullptr; }

void Overlay::SetFromFile(const std::filesystem::path& file, const std::string& key) {
  const YAML::Node all = YAML::LoadFile(file.string());
  const YAML::Node mapping = all[key];
  if (!mapping) return;
  if (!mapping.IsMap())
    throw ConfigError(file.string(), mapping.Mark().line + 1,
                      fmt::format("{}: found no mapping, accepted one of keys and values", key));
  std::set<std::string> known;
  for (const auto& pair : mapping) {
    const int line = pair.first.Mark().line + 1;
    const std::string name = pair.first.IsScalar() ? pair.first.Scalar() : "";
    if (!IsKey(name))
      throw ConfigError(file.string(), line, fmt::format("{}: found \"{}\", {}", key, name, kAcceptedKey));
    if (!known.insert(name).second)
      throw ConfigError(file.string(), line, fmt::format("{}: key \"{}\" again", key, name));
    values_.push_back({.key = name, .value = pair.second, .file = file, .line = line});
  }
}

void Overlay::Set(const std::string& assignment, const std::string& said_by) {
  const std::string name = said_by + " " + assignment;
  const std::size_t equal = assignment.find('=');
  const std::string key = assignment.substr(0, equal);
  if (equal == std::string::npos || !IsKey(key))
    throw ConfigError(name, 0, fmt::format("found no KEY=VALUE, {}", kAcceptedKey));
  YAML::Node value;
  try {
    value = YAML::Load(assignment.substr(equal + 1));
  } catch (const YAML::Exception& error) {
    throw ConfigError(name, 0, "not YAML: " + error.msg);
  }
  // A new list is made, because assigning to a YAML::Node would change the node that it shares with the file.
  std::vector<Value> kept;
  for (Value& earlier : values_)
    if (earlier.key != key) kept.push_back(std::move(earlier));
  values_ = std::move(kept);
  values_.push_back({.key = key, .value = value, .file = name});
}

void Overlay::Finish() const {
  for (const Value& value : values_)
    if (!value.used)
      throw ConfigError(
          value.file.string(), value.line,
          fmt::format("{}: found no such section, accepted a key of {} or of a file that it names", value.key,
                      named_.front().file.filename().string()));
}

std::optional<std::string> Overlay::PlaceOf(const std::filesystem::path& file) {
  if (!present_overlay) return {};
  const auto named = std::ranges::find(present_overlay->named_, AbsolutePath(file), &Named::file);
  if (named == present_overlay->named_.end()) return {};
  return named->place;
}

void Overlay::RecordNamedFile(const std::filesystem::path& file, const std::string& place) {
  if (present_overlay) present_overlay->named_.push_back({.file = AbsolutePath(file), .place = place});
}

void Overlay::ApplyTo(const std::string& place, const std::function<void(const OverlaidValue&)>& take) {
  if (!present_overlay) return;
  for (Value& value : present_overlay->values_) {
    if (!value.key.starts_with(place)) continue;
    const std::string remaining_key = value.key.substr(place.size());
    const std::size_t dot = remaining_key.find('.');
    const std::string key = remaining_key.substr(0, dot);
    if (dot == std::string::npos) {
      value.used = true;
      take({.key = key, .line = value.line, .value = value.value, .file = value.file});
    } else {
      const YAML::Node empty(YAML::NodeType::Map);
      take({.key = key, .line = value.line, .value = empty, .file = value.file, .only_where_missing = true});
    }
  }
}

}  // namespace osteon::config
