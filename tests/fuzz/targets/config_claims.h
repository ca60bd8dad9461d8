#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "config/reading/config_file_tracker.h"
#include "config/reading/strict/reader.h"
#include "tests/fuzz/targets/file_claims.h"

// Shared parts of the fuzz targets that read YAML files: the input as a file in a copy of config/, and claims
// about errors.

namespace osteon::fuzz {

/// Claims that an error names its file, and that the named line exists.
/// @param name  name of the file that the fuzzer made, with the content `text`; lines of other files are not
/// checked
inline void ClaimNamesPlace(const config::ConfigError& error, const std::string& name,
                            std::string_view text) {
  const std::string_view what = error.what();
  Claim(what.starts_with(error.file() + ":"), "an error names the file");
  if (error.line() == 0) return Claim(what.starts_with(error.file() + ": "), "and no line where it has none");
  Claim(what.starts_with(error.file() + ":" + std::to_string(error.line()) + ": "), "and the line");
  if (error.file() == name) ClaimNamesLine(what, name, text);
}

/// Returns the result of `load`. If `load` throws a ConfigError, checks the place that the error names, and
/// returns nothing.
template <typename Load>
auto Loaded(const Load& load, const std::string& name, std::string_view text)
    -> std::optional<decltype(load())> {
  try {
    return load();
  } catch (const config::ConfigError& error) {
    ClaimNamesPlace(error, name, text);
    return std::nullopt;
  }
}

/// A folder with links to the repository's config/ and one file of its own, cells/fuzz.yaml. Named files are
/// searched only there.
class FuzzConfig {
 public:
  FuzzConfig() {
    std::filesystem::create_directories(root() / "cells");
    for (const char* folder : {"robots", "tools", "scenes", "materials", "images", "plans", "scenarios"})
      std::filesystem::create_directory_symlink(Shipped() / folder, root() / folder);
    // cells in the corpus extend the demo's cell
    std::filesystem::create_symlink(Shipped() / "cells/demo.yaml", root() / "cells/demo.yaml");
  }
  /// The repository's config/: in OSTEON_ROOT if it is set, else in the source folder of the build.
  [[nodiscard]] static std::filesystem::path Shipped() {
    const char* moved = std::getenv("OSTEON_ROOT");
    return std::filesystem::path(moved ? moved : OSTEON_SOURCE_DIR) / "config";
  }

  void Write(std::string_view text) const { io::test::WriteAll(path(), std::string(text)); }
  [[nodiscard]] std::filesystem::path path() const { return root() / "cells" / "fuzz.yaml"; }
  [[nodiscard]] std::filesystem::path Beside(const std::string& name) const { return root() / name; }
  [[nodiscard]] config::ConfigFileTracker::Params scope() const { return {.root = root()}; }

 private:
  [[nodiscard]] std::filesystem::path root() const { return folder_.path() / "config"; }
  io::test::TemporaryFolder folder_{FastFolder()};
};

/// One input of a target that reads YAML: the fuzzer's text, as a file of the repository's config/.
class YamlInput {
 public:
  YamlInput(const std::uint8_t* data, std::size_t size)
      : text_(Written(Text({data, size}))), scope_(Files().scope()) {}

  /// Returns what a loader reads from the file, or nothing if the loader refuses the file.
  template <typename Load>
  [[nodiscard]] auto Read(const Load& load) const {
    return Loaded([&] { return load(Files().path()); }, Files().path().string(), text_);
  }

 private:
  static const FuzzConfig& Files() {
    static const FuzzConfig files;
    return files;
  }
  static std::string Written(std::string text) {
    Files().Write(text);
    return text;
  }

  std::string text_;
  config::ConfigFileTracker scope_;
};

}  // namespace osteon::fuzz
