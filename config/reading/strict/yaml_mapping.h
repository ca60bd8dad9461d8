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
  std::vector<Missing> missing;                     ///< those of them that are not optional and not there
  std::vector<std::shared_ptr<YamlMapping>> inner;  ///< sections that were requested
  KeyRecorder* recorder{nullptr};                   ///< null: values are read from a file
  std::string recorded_place;                       ///< place for the recorder, as "zones[]."

  /// @throws ConfigError if the node is not a mapping of different keys; `key` precedes the text.
  YamlMapping(std::filesystem::path file_in, const YAML::Node& node, int line_in, const std::string& key,
              std::optional<std::string> place_in = {}, const Base& base = {});
  /// A section that the file does not have.
  explicit YamlMapping(std::filesystem::path file_in) : file(std::move(file_in)), absent(true) {}
  /// A mapping of no file, whose keys are recorded (RecordKeys).
  YamlMapping(std::filesystem::path file_in, KeyRecorder& recorder_in, std::string place_in)
      : file(std::move(file_in)), absent(true), recorder(&recorder_in), recorded_place(std::move(place_in)) {}

  /// Records a key if this mapping is being recorded (RecordKeys). @returns whether it did
  bool Record(const std::string& key, KeyInfo info) const;

  /// @throws ConfigError at a line of the file
  [[noreturn]] void Fail(int at, const std::string& what) const;
  /// @throws ConfigError at a key's value: "key: found …, accepted …"
  [[noreturn]] void FailValue(const std::string& key, const YAML::Node& node,
                              const std::string& accepted) const;

  /// File and line of a key; of the mapping, if it does not have the key.
  [[nodiscard]] const std::filesystem::path& FileOf(const std::string& key) const;
  [[nodiscard]] int LineOfKey(const std::string& key) const;
  /// Line of a key's value. YAML marks an absent value at the next token, so the key's line is used instead.
  /// An override from the command line has no line.
  [[nodiscard]] int LineOfValue(const std::string& key, const YAML::Node& node) const;

  /// The value of a key, or null (and the gap is noted).
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
