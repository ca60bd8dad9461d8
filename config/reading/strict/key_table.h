#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

// Which keys a kind of file has, recorded from the readers themselves: a loader runs without a file, and its
// Reader notes each key with its type, its range and its accepted words. So a schema and the readers can not
// differ. A reader asks for different keys after different answers ("kind: drilling"), so it runs once for
// each answer.

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
  double min{0.0}, max{0.0};         ///< of a number, of each of a list; of a list's length
  std::size_t size{0};               ///< of a list of numbers; 0: any
  std::vector<std::string> words{};  ///< accepted
  std::string folder{};              ///< of files that are named without a path: "tools"; empty: a path alone
  bool required{true};
};

/// The keys of a mapping that one word of it decides on.
struct KeyCase {
  std::string key, word;                     ///< "kind", "drilling"
  std::set<std::string> required, excluded;  ///< beside those of every word
};

/// The keys of a mapping, and of those in it.
struct KeyTable {
  std::map<std::string, KeyInfo> keys;
  std::map<std::string, KeyTable> inner;  ///< of sections, and of each element of a list
  std::vector<KeyCase> cases;
};

/// Runs a loader as often as it takes. @param load  e.g. LoadScene; its file is not read
[[nodiscard]] KeyTable RecordKeys(const std::function<void(const std::filesystem::path&)>& load);

/// A kind of YAML file.
struct FileKind {
  std::string name;    ///< "cell"
  std::string folder;  ///< under config/; empty: none
  std::function<void(const std::filesystem::path&)> load;
};
/// All of them.
[[nodiscard]] std::vector<FileKind> FileKinds();

/// For Reader: what is asked for during RecordKeys, in this thread.
class KeyRecorder {
 public:
  /// The one that records; null: files are read.
  [[nodiscard]] static KeyRecorder* Present();
  /// The answer to a question with so many answers, the first by default.
  [[nodiscard]] std::size_t Decide(const std::string& question, std::size_t answers);
  void Note(const std::string& place, const std::string& key, KeyInfo info);
  /// @returns whether the key is there, in this run
  [[nodiscard]] bool NoteOptional(const std::string& place, const std::string& key);
  /// Says whether a key is there, instead of a question about it.
  void Choose(const std::string& place, const std::string& key, bool is_there);
  void NoteWord(const std::string& place, const std::string& key, const std::string& word);
  /// A mapping and those in it have been asked for all that they must have. @throws Ended at the file's own:
  /// from there on values are used.
  void Finish(const std::string& place);
  struct Ended {};

  struct Mapping {
    std::map<std::string, KeyInfo> keys;
    std::map<std::string, bool> optional;  // and whether it was there
    std::map<std::string, std::string> words;
    bool finished{false};
  };
  struct Run {
    std::map<std::string, Mapping> mappings;  // by place: "", "limits.", "zones[]."
  };

 private:
  friend KeyTable RecordKeys(const std::function<void(const std::filesystem::path&)>& load);
  std::map<std::string, std::size_t> answers_;
  std::vector<std::pair<std::string, std::size_t>> asked_;
  Run run_;
};

}  // namespace osteon::config
