#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "studies/sharding/shard.h"

namespace osteon::studies {

inline constexpr const char* kPartSchema = "osteon.part/1";

/// The content of one shard's file.
struct Part {
  std::filesystem::path file{};
  Shard shard{};
  std::size_t items{0};    ///< number of items of the whole study
  std::string build{};     ///< version and commit of the program
  std::string checksum{};  ///< checksum of the options and inputs on which the items depend
  /// Words of the command line, except --shard, --json, --out and --config-root with their values.
  std::vector<std::string> words{};
  std::map<std::size_t, nlohmann::json> results{};  ///< result of each item, by its index
};

/// Checksum of a part's whole content, which the part's file also contains.
[[nodiscard]] std::string DigestOf(const Part& part);

/// JSON, schema osteon.part/1.
[[nodiscard]] std::string PartText(const Part& part);
/// Reads a part. The file's content is not trusted, but checked. @returns an error that names the file, what
/// was found and what is accepted.
[[nodiscard]] tl::expected<Part, std::string> ReadPart(const std::filesystem::path& file);

/// All parts of one run.
class PartSet {
 public:
  /// Combines parts.
  /// @returns an error that names a part of another run, a part that is given twice, or the missing shards.
  [[nodiscard]] static tl::expected<PartSet, std::string> From(std::vector<Part> parts);
  /// Reads the files and combines their parts.
  [[nodiscard]] static tl::expected<PartSet, std::string> Read(std::span<const std::filesystem::path> files);

  [[nodiscard]] const std::vector<std::string>& words() const { return head_.words; }
  [[nodiscard]] const std::string& checksum() const { return head_.checksum; }
  [[nodiscard]] const std::filesystem::path& first_file() const { return head_.file; }
  [[nodiscard]] std::size_t items() const { return head_.items; }
  /// @param item  index, smaller than items()
  [[nodiscard]] const nlohmann::json& At(std::size_t item) const { return head_.results.at(item); }
  /// The file of the part that has an item. @param item  index, smaller than items()
  [[nodiscard]] const std::filesystem::path& FileOf(std::size_t item) const {
    return files_[item % files_.size()];
  }
  /// Version and commit of the program that ran the shards.
  [[nodiscard]] const std::string& build() const { return head_.build; }

 private:
  Part head_;                                 ///< the first part; its `results` are those of all parts
  std::vector<std::filesystem::path> files_;  ///< files of the parts, in the order of the shards
};

}  // namespace osteon::studies
