#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

class PartSet;

/// One of several parts of a study, which may run on different machines. Items are assigned to the parts in
/// turn: so neighbouring items, which mostly take about the same time, belong to different parts.
struct Shard {
  int index{1};  ///< 1 … `of`
  int of{1};

  [[nodiscard]] bool Has(std::size_t item) const {
    return item % static_cast<std::size_t>(of) == static_cast<std::size_t>(index - 1);
  }
  bool operator==(const Shard&) const = default;
};

inline constexpr int kMaxShards = 10'000;

/// Reads "I/N". @returns an error "found …, accepted …".
[[nodiscard]] tl::expected<Shard, std::string> ParseShard(const std::string& text);

/// How a study's items are divided; by default this process computes all of them.
struct Sharding {
  /// If set, only the items of this shard are computed, and written to a part file.
  std::optional<Shard> shard{};
  /// If not null, all results are read from these parts, and nothing is computed.
  const PartSet* parts{nullptr};
  /// Words of the command line after the program's name; a part stores them.
  std::vector<std::string> words{};
};

/// Removes options that have one value each, "--json FILE" or "--json=FILE", from a command line's words.
[[nodiscard]] std::vector<std::string> WithoutOptions(const std::vector<std::string>& words,
                                                      const std::vector<std::string>& options);

/// Adds a name, for example of a device on which a part ran, to a list "one; another", unless the list has
/// it.
void AddName(std::string& list, const std::string& name);

}  // namespace osteon::studies
