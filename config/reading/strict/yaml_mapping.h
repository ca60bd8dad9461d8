#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "config/reading/strict/key_table.h"

namespace osteon::config {

/// For Reader: one mapping and the keys requested of it. A missing section is a YamlMapping too: it is
/// absent, and notes nothing. Entries come from the file itself, from the file that it extends, and from an
/// overlay; each says which file it stands in.
struct YamlMapping {
  struct Entry {
    std::string key;
    int line{0};  ///< of the key
    YAML::Node value;
    std::filesystem::path file;        ///< the file that contains the entry; an overlay's is another file
    std::optional<YAML::Node> base{};  ///< the mapping of the extended file below this one
  };
  struct Missing {
    std::string key, accepted;
  };
  /// A mapping of the extended file.
  struct Base {
    std::filesystem::path file;
    std::optional<YAML::Node> node;
  };

  std::filesystem::path file;
  std::filesystem::path base_file;   ///< the file that this one extends; empty: none
  std::optional<std::string> place;  ///< key prefix within an overlay; empty: no overlay concerns it
  bool absent{false};
  int line{0};
  YAML::Node document;  ///< the source of this file's own entries
  std::vector<Entry> entries;
  std::vector<std::string> known;
  std::vector<Missing> missing;
  std::vector<std::shared_ptr<YamlMapping>> inner;
  KeyRecorder* recorder{nullptr};
  std::string recorded_place;

  /// @throws ConfigError if the node is not a mapping of different keys; `key` precedes the text.
  YamlMapping(std::filesystem::path file_in, const YAML::Node& node, int line_in, const std::string& key,
              std::optional<std::string> place_in = {}, const Base& base = {});
  explicit YamlMapping(std::filesystem::path file_in) : file(std::move(file_in)), absent(true) {}
  /// A mapping of no file, whose keys are recorded (RecordKeys).
  YamlMapping(std::filesystem::path file_in, KeyRecorder& recorder_in, std::string place_in)
      : file(std::move(file_in)), absent(true), recorder(&recorder_in), recorded_place(std::move(place_in)) {}

  /// Records a key if this mapping is being recorded (RecordKeys). @returns whether it did
  bool Record(const std::string& key, KeyInfo info) const;

  [[noreturn]] void Fail(int at, const std::string& what) const;
  [[noreturn]] void FailValue(const std::string& key, const YAML::Node& node,
                              const std::string& accepted) const;

  [[nodiscard]] const std::filesystem::path& FileOf(const std::string& key) const;
  [[nodiscard]] int LineOfKey(const std::string& key) const;
  /// YAML marks an absent value at the next token, so the key's line is used instead. An override from the
  /// command line has no line.
  [[nodiscard]] int LineOfValue(const std::string& key, const YAML::Node& node) const;

  /// The value of a key, or null (and the gap is noted).
  const Entry* Find(const std::string& key, const std::string& accepted);
  [[nodiscard]] double NumberIn(const std::string& key, const YAML::Node& node, double min, double max) const;

  /// @throws ConfigError as Reader::Finish
  void Finish() const;
  /// @returns the keys that were asked for, in alphabetical order: "direction, from_s, wire"
  [[nodiscard]] std::string KnownKeys() const;

 private:
  void AddEntries(const YAML::Node& node);
  // Adds the values of the extended file that this one does not have.
  void Extend(const YAML::Node& base);
};

}  // namespace osteon::config
