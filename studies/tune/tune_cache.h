#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

namespace osteon::studies {

/// Cache of computed numbers in a file. The key of an entry is made from the inputs of its computation.
class TuneCache {
 public:
  /// A file that can't be read, or is of another version, counts as empty: its numbers are computed again.
  explicit TuneCache(std::filesystem::path file);

  /// Finds the numbers that were computed from these inputs. @param from  everything that they depend on, as
  /// text
  [[nodiscard]] std::optional<std::vector<double>> Find(const std::string& from);
  void Store(const std::string& from, const std::vector<double>& values);
  /// Saves only the entries that were found or stored since construction. The error names the file.
  [[nodiscard]] tl::expected<void, std::string> Save() const;

  /// Numbers of entries that were found in the file, and that were stored since construction.
  [[nodiscard]] int found() const { return found_; }
  [[nodiscard]] int computed() const { return computed_; }

 private:
  // Hash of the inputs' text.
  static std::string Key(const std::string& from);

  std::filesystem::path file_;
  nlohmann::json loaded_, kept_;  ///< entries of the file; entries that Save writes
  mutable std::mutex mutex_;      ///< guards the entries and the counts
  int found_{0}, computed_{0};
};

}  // namespace osteon::studies
