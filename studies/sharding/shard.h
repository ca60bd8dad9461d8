#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

class PartSet;

/// One of several parts of a study, which may run on different machines. Items go to the parts in turn:
/// neighbouring items, which mostly take about the same time, belong to different parts.
struct Shard {
  int index{1};  ///< 1 … of
  int of{1};

  [[nodiscard]] bool Has(std::size_t item) const {
    return item % static_cast<std::size_t>(of) == static_cast<std::size_t>(index - 1);
  }
  bool operator==(const Shard&) const = default;
};

inline constexpr int kMaxShards = 10'000;

/// Reads "I/N". @returns an error "found …, accepted …".
[[nodiscard]] tl::expected<Shard, std::string> ParseShard(const std::string& text);

/// How a study's items are shared out; by default this process computes all of them.
struct Sharding {
  std::optional<Shard> shard{};      ///< if set, only its items are computed, and written as a part
  const PartSet* parts{nullptr};     ///< if not null, the items come from these parts; none is computed
  std::vector<std::string> words{};  ///< the command line after the program's name, which a part keeps
};

/// Removes options that have one value each, "--json FILE" or "--json=FILE", from a command line's words.
[[nodiscard]] std::vector<std::string> WithoutOptions(const std::vector<std::string>& words,
                                                      const std::vector<std::string>& options);

/// Adds a name, for example of a device on which a part ran, to a list "one; another", unless the list has
/// it.
void AddName(std::string& list, const std::string& name);

}  // namespace osteon::studies
