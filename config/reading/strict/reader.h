#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "config/reading/strict/config_error.h"
#include "kinematics/spatial.h"

namespace osteon::config {

struct YamlMapping;

/// Strict reader of one mapping of a YAML file.
///
///     Reader reader = Reader::Load("config/tools/reamer.yaml");
///     const double radius_m = reader.Number("radius_mm", 1, 100);   // found in mm, given in m
///     reader.Finish();                                              // refuses unknown and missing keys
///
/// A number's unit is the end of its key (units.h), and its value is returned in SI. A value of the wrong
/// type or out of range throws at once. If a key is missing, the function returns an accepted value, and
/// Finish() throws: only then all requested keys are known, so that a misspelt key can be recognised.
/// Therefore use no value before Finish() has returned. Copies are views of the same mapping. One thread at a
/// time.
class Reader {
 public:
  /// @throws ConfigError if the file cannot be read, is not YAML, not one document, or not a mapping with
  ///   unique keys.
  [[nodiscard]] static Reader Load(const std::filesystem::path& path);
  /// As Load, for a file that may extend another file of its kind. The key `extends` names the other file.
  /// For keys that this file does not have, the other file's values are used, also inside sections; a list is
  /// replaced as a whole. The key `remove` lists keys of the other file ("start.arm_angle_deg") that are not
  /// used. Errors name the file that contains the value.
  /// @param kind  the folder of such files, as in File()
  /// @throws ConfigError as Load, or if the other file also extends a file.
  [[nodiscard]] static Reader LoadExtending(const std::filesystem::path& path, const std::string& kind);
  /// As Load, for a text. `name` is the file name that errors show; its folder is the one from which File()
  /// searches.
  [[nodiscard]] static Reader Parse(const std::string& text, const std::filesystem::path& name);

  /// Whether the file has this optional key.
  [[nodiscard]] bool Has(const std::string& key);

  /// Reads a finite number, min and max in the unit of the key. @returns it in SI.
  /// @throws std::logic_error if the key names no unit: a mistake of the program, not of the file.
  [[nodiscard]] double Number(const std::string& key, double min, double max);
  /// Reads a list of `size` numbers. @returns them in SI.
  [[nodiscard]] std::vector<double> Numbers(const std::string& key, std::size_t size, double min, double max);
  /// Reads three numbers. @returns them in SI.
  [[nodiscard]] Vector3 Triple(const std::string& key, double min, double max);
  /// Reads three numbers as a unit vector; accepts a length of 1 ± 1e-3. @returns the normalised vector
  [[nodiscard]] Vector3 Direction(const std::string& key);
  /// Reads a whole number.
  [[nodiscard]] int WholeNumber(const std::string& key, int min, int max);
  [[nodiscard]] bool Bool(const std::string& key);
  /// Reads a text that is not empty.
  [[nodiscard]] std::string Text(const std::string& key);
  /// Reads one of the accepted words. @returns its index among them.
  [[nodiscard]] std::size_t Choice(const std::string& key, std::initializer_list<const char*> accepted);
  /// Reads a list of accepted words, without repetition. @returns the words' indices among the accepted
  /// words, in the order of the list
  [[nodiscard]] std::vector<std::size_t> Words(const std::string& key,
                                               std::initializer_list<const char*> accepted);
  /// Reads the path of an existing file, relative to this file's folder.
  [[nodiscard]] std::filesystem::path File(const std::string& key);
  /// Reads the path of an existing file, or a name alone ("reamer"), which is searched in folders of a kind
  /// (ConfigFileTracker::FindByName).
  /// @param kind  "robots", "tools", …
  [[nodiscard]] std::filesystem::path File(const std::string& key, const std::string& kind);

  /// A mapping inside this one.
  [[nodiscard]] Reader Section(const std::string& key);
  /// Returns the one of these sections that is present. Refuses a second one.
  [[nodiscard]] Reader OneSection(std::initializer_list<const char*> keys);
  /// A list of mappings, min to max of them.
  [[nodiscard]] std::vector<Reader> Sections(const std::string& key, std::size_t min, std::size_t max);

  /// @throws ConfigError naming the first unknown key (with the nearest known one) or missing key of this
  ///   mapping and of the sections inside it.
  void Finish() const;

  /// The file that this one extends (LoadExtending); empty: none.
  [[nodiscard]] std::filesystem::path Extended() const;

  /// Refuses a key for a reason that only the caller can check, such as a value that does not fit another
  /// value. @throws ConfigError at the key's line, with the key and `what`.
  [[noreturn]] void Refuse(const std::string& key, const std::string& what) const;
  /// File and line of a key, "my.yaml:12", for errors that are found after reading.
  [[nodiscard]] std::string PlaceOf(const std::string& key) const;

 private:
  // The file that a key names.
  [[nodiscard]] std::filesystem::path FindFile(const std::string& key, const std::string& kind);
  explicit Reader(std::shared_ptr<YamlMapping> mapping) : mapping_(std::move(mapping)) {}

  std::shared_ptr<YamlMapping> mapping_;
};

}  // namespace osteon::config
