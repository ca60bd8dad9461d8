#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

// Tables of the keys that each kind of file has, recorded from the readers themselves. A loader runs without
// a file, and its Reader notes each requested key with its type, range and accepted words. Schemas are made
// from these tables, so that they cannot differ from the readers. Which keys a loader requests depends on the
// values that it has read ("kind: drilling"). The loader therefore runs several times, each time with other
// values.

namespace osteon::config {

struct KeyTable;

/// One key of a mapping.
struct KeyInfo {
  enum class Type : std::uint8_t {
    kNumber,
    kWhole,
    kNumbers,
    kBool,
    kText,
    kChoice,
    kWords,
    kFile,
    kSection,
    kList,
    kAny
  };
  Type type{Type::kText};
  double min{0.0}, max{0.0};         ///< range of a number, of a list's numbers, or of a list's length
  std::size_t size{0};               ///< length of a list of numbers; 0: any
  std::vector<std::string> words{};  ///< accepted words
  std::string folder{};  ///< folder of files that may be named without a path, e.g. "tools"; empty: none
  bool required{true};
};

/// The keys of a mapping that depend on the value of another of its keys.
struct KeyCase {
  std::string key, word;                     ///< the other key and its value: "kind", "drilling"
  std::set<std::string> required, excluded;  ///< in addition to the keys that do not depend on this word
};

/// The keys of a mapping, and of the mappings in it.
struct KeyTable {
  std::map<std::string, KeyInfo> keys;
  std::map<std::string, KeyTable> inner;  ///< tables of its sections, and of its lists' elements
  std::vector<KeyCase> cases;
};

/// Records the keys of a kind of file. Runs its loader with all values on which keys depend.
/// @param load  e.g. LoadScene; it reads no file
[[nodiscard]] KeyTable RecordKeys(const std::function<void(const std::filesystem::path&)>& load);

/// Used by Reader during RecordKeys: receives the keys that a loader requests, and supplies values in place
/// of a file.
class KeyRecorder {
 public:
  /// The recorder of this thread during RecordKeys; null otherwise, when files are read.
  [[nodiscard]] static KeyRecorder* Present();
  /// Returns this run's answer to a question: a number from 0 to `answers` - 1.
  [[nodiscard]] std::size_t Decide(const std::string& question, std::size_t answers);
  /// Notes a key that the loader reads in the mapping at a place.
  void Note(const std::string& place, const std::string& key, KeyInfo info);
  /// Notes an optional key. @returns whether this run treats it as present
  [[nodiscard]] bool NoteOptional(const std::string& place, const std::string& key);
  /// Sets whether this run treats a key as present, without making it a question.
  void Choose(const std::string& place, const std::string& key, bool is_there);
  /// Notes the word that this run gives for a key.
  void NoteWord(const std::string& place, const std::string& key, const std::string& word);
  /// Marks a mapping and those in it as finished: the reader has asked for all of their keys.
  /// @throws Ended for the file's outermost mapping: it ends the run, because the loader would then use the
  ///   values
  void Finish(const std::string& place);
  struct Ended {};

  /// The notes of one run about one mapping.
  struct Mapping {
    std::map<std::string, KeyInfo> keys;
    std::map<std::string, bool> optional;  // optional keys, and whether this run treats them as present
    std::map<std::string, std::string> words;
    bool finished{false};
  };
  /// The notes of one run of the loader.
  struct Run {
    std::map<std::string, Mapping> mappings;  // by place in the file: "", "limits.", "zones[]."
  };

 private:
  friend KeyTable RecordKeys(const std::function<void(const std::filesystem::path&)>& load);
  // this run's answer to each question; without an entry the answer is 0
  std::map<std::string, std::size_t> answers_;
  std::vector<std::pair<std::string, std::size_t>>
      asked_;  // questions of this run, with their numbers of answers
  Run run_;
};

}  // namespace osteon::config
