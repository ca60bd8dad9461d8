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

/// For Reader: one mapping and the keys requested of it. A missing section is also a YamlMapping, with
/// `absent` set; it records no missing keys. Entries come from the file itself, from the file that it
/// extends, and from an overlay. Each entry stores which file contains it.
struct YamlMapping {
  struct Entry {
    std::string key;
    int line{0};  ///< of the key
    YAML::Node value;
    /// the file that contains the entry: this one, the extended one, or the overlay's
    std::filesystem::path file;
    /// if the entry is a mapping: the extended file's mapping of the same key
    std::optional<YAML::Node> base{};
  };
  /// A key that was requested and is not in the file.
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
  bool absent{false};                ///< a section that the file does not have, or a recorded mapping
  int line{0};                       ///< of the mapping
  YAML::Node document;               ///< the source of this file's own entries
  std::vector<Entry> entries;
  std::vector<std::string> known;                   ///< keys that were requested
  std::vector<Missing> missing;                     ///< requested keys that are neither optional nor present
  std::vector<std::shared_ptr<YamlMapping>> inner;  ///< sections that were requested
  KeyRecorder* recorder{nullptr};                   ///< null: values are read from a file
  std::string recorded_place;                       ///< place for the recorder, as "zones[]."

  /// @throws ConfigError if the node is not a mapping of different keys; `key` precedes the text.
  YamlMapping(std::filesystem::path file_in, const YAML::Node& node, int line_in, const std::string& key,
              std::optional<std::string> place_in = {}, const Base& base = {});
  /// A section that the file does not have.
  explicit YamlMapping(std::filesystem::path file_in) : file(std::move(file_in)), absent(true) {}
  /// A mapping without a file, for RecordKeys: its requested keys are recorded.
  YamlMapping(std::filesystem::path file_in, KeyRecorder& recorder_in, std::string place_in)
      : file(std::move(file_in)), absent(true), recorder(&recorder_in), recorded_place(std::move(place_in)) {}

  /// Records a key if this mapping is being recorded (RecordKeys). @returns whether it did
  bool Record(const std::string& key, KeyInfo info) const;

  /// @throws ConfigError at a line of the file
  [[noreturn]] void Fail(int at, const std::string& what) const;
  /// @throws ConfigError at a key's value: "key: found …, accepted …"
  [[noreturn]] void FailValue(const std::string& key, const YAML::Node& node,
                              const std::string& accepted) const;

  /// File and line of a key. If the mapping does not have the key, file and line of the mapping.
  [[nodiscard]] const std::filesystem::path& FileOf(const std::string& key) const;
  [[nodiscard]] int LineOfKey(const std::string& key) const;
  /// Line of a key's value. For an absent value, the YAML parser reports the line of the next token; then the
  /// key's line is returned. An override from the command line has no line.
  [[nodiscard]] int LineOfValue(const std::string& key, const YAML::Node& node) const;

  /// The entry of a key. If there is none, returns null and records the key as missing.
  const Entry* Find(const std::string& key, const std::string& accepted);
  /// Reads the number in a key's node, in the unit of the key. @throws ConfigError outside the range
  [[nodiscard]] double NumberIn(const std::string& key, const YAML::Node& node, double min, double max) const;

  /// @throws ConfigError as Reader::Finish
  void Finish() const;
  /// @returns the keys that were asked for, in alphabetical order: "direction, from_s, wire"
  [[nodiscard]] std::string KnownKeys() const;

 private:
  // Adds the entries of this file's own mapping; refuses a key that occurs twice.
  void AddEntries(const YAML::Node& node);
  // Adds the values of the extended file that this one does not have.
  void Extend(const YAML::Node& base);
};

}  // namespace osteon::config
