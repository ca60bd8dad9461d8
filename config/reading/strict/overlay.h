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

/// For Reader: a value that overrides a value of a mapping.
struct OverlaidValue {
  const std::string& key;
  int line{0};  ///< of the key
  const YAML::Node& value;
  const std::filesystem::path& file;  ///< the file that contains the value
  /// an empty section for values inside it; used only if the mapping does not have the section
  bool only_where_missing{false};
};

/// While an object exists, a configuration file and the files that it names are read with some values
/// overridden, in this thread. An error in such a value names the file and the line that contain it.
///
///     overrides:
///       limits.max_force_N: 150            # a value in a section, which is created if missing
///       injections: [{wire: arm, …}]       # a whole list or section
///       scene.packing.spacing_mm: 3        # a value in the file that the key `scene` names
///
/// Relative paths in an override start from the folder of the file that contains it. A thread may have one
/// object at a time.
class Overlay {
 public:
  /// @param root  the file to whose keys overrides refer
  explicit Overlay(const std::filesystem::path& root);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  /// Overrides values of the root by the mapping `key` of a YAML file; does nothing without such a key.
  /// @throws ConfigError if it is not a mapping of different keys.
  void SetFromFile(const std::filesystem::path& file, const std::string& key);
  /// Overrides one value of the root. @param assignment  "limits.max_force_N=150"; errors quote it, preceded
  /// by `said_by`. @throws ConfigError if it is not an assignment.
  void Set(const std::string& assignment, const std::string& said_by);
  /// Call after the root was read. @throws ConfigError if a value had no effect, because its key leads into a
  /// number or into a file that was not read.
  void Finish() const;

  /// For Reader: the prefix of the override keys that refer to a file, such as "scene."; nothing if no key
  /// that was read names the file.
  [[nodiscard]] static std::optional<std::string> PlaceOf(const std::filesystem::path& file);
  /// For Reader: records that a key names a file. @param place  the key followed by a dot
  static void RecordNamedFile(const std::filesystem::path& file, const std::string& place);
  /// For Reader: calls `take` with each value that overrides a value of the mapping at a place.
  static void ApplyTo(const std::string& place, const std::function<void(const OverlaidValue&)>& take);

 private:
  struct Value;
  // A file that is read under this overlay, and the prefix of the keys that override its values.
  struct Named {
    std::filesystem::path file;
    std::string place;
  };

  std::vector<Value> values_;
  std::vector<Named> named_;
};

}  // namespace osteon::config
