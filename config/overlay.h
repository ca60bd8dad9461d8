#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace osteon::config {

/// For Reader: a value that is laid over a mapping's.
struct OverlaidValue {
  const std::string& key;
  int line{0};  ///< of the key
  const YAML::Node& value;
  const std::filesystem::path& file;  ///< that says it
  bool only_where_missing{false};     ///< a section that values are laid into: the mapping's own stays
};

/// While one lives, a configuration file and those that it names read as if they said otherwise here and
/// there, in this thread. An error in such a value names the file and the line that say it.
///
///     overrides:
///       limits.max_force_N: 150            # of a section; made where it is not there
///       injections: [{wire: arm, …}]       # a whole section or list
///       scene.packing.spacing_mm: 3        # of the file that the key `scene` names
///
/// Relative files in it start from the folder of who says it. One at a time in a thread.
class Overlay {
 public:
  /// @param root  the file that keys begin at
  explicit Overlay(const std::filesystem::path& root);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  /// Lays the values of the mapping `key` of a YAML file over the root; without such a key nothing.
  /// @throws ConfigError where it is no mapping of different keys.
  void LayFile(const std::filesystem::path& file, const std::string& key);
  /// Lays one value over it. @param assignment  "limits.max_force_N=150"; in errors it is named as it stands
  /// here, behind `said_by`. @throws ConfigError where it is none.
  void Lay(const std::string& assignment, const std::string& said_by);
  /// Once the root was read. @throws ConfigError where a value was laid over nothing: a key that leads
  /// through a number, or a file that was not read.
  void Finish() const;

  /// For Reader: the beginning of the keys of a file that was named; nothing where none is laid over it.
  [[nodiscard]] static std::optional<std::string> PlaceOf(const std::filesystem::path& file);
  /// For Reader: a file is named by a key. @param place  the key and a dot behind it
  static void Name(const std::filesystem::path& file, const std::string& place);
  /// For Reader: the values that are laid over the mapping at a place.
  static void Over(const std::string& place, const std::function<void(const OverlaidValue&)>& take);

 private:
  struct Value;
  struct Named {
    std::filesystem::path file;
    std::string place;
  };

  std::vector<Value> values_;
  std::vector<Named> named_;
};

}  // namespace osteon::config
