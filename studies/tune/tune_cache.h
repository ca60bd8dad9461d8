#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

namespace osteon::studies {

/// Cache of computed numbers in a file. An entry's key is a hash of all inputs of its computation.
class TuneCache {
 public:
  /// Reads the file. A file that can't be read or has another version counts as empty, and its numbers are
  /// computed again.
  explicit TuneCache(std::filesystem::path file);

  /// Finds the numbers that were computed from these inputs.
  /// @param from  everything that the numbers depend on, as text
  [[nodiscard]] std::optional<std::vector<double>> Find(const std::string& from);
  void Store(const std::string& from, const std::vector<double>& values);
  /// Saves the entries that were found or stored since construction, and drops all others. The error names
  /// the file.
  [[nodiscard]] tl::expected<void, std::string> Save() const;

  /// Number of entries that were found in the file; below, the number that was stored since construction.
  [[nodiscard]] int found() const { return found_; }
  [[nodiscard]] int computed() const { return computed_; }

 private:
  // Hash of the inputs' text, by which an entry is found.
  static std::string Key(const std::string& from);

  std::filesystem::path file_;
  nlohmann::json loaded_, kept_;  ///< entries of the file; entries that Save writes
  mutable std::mutex mutex_;      ///< guards the entries and the counts
  int found_{0}, computed_{0};
};

}  // namespace osteon::studies
