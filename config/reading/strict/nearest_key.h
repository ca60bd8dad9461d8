#pragma once

#include <string>
#include <vector>

namespace osteon::config {

/// The candidate that becomes `key` with the fewest edits. An edit inserts, deletes or replaces a letter, or
/// swaps two neighbours. Empty if every candidate needs more edits than a third of the key's length, because
/// such a guess does not help.
[[nodiscard]] std::string NearestKey(const std::string& key, const std::vector<std::string>& candidates);

}  // namespace osteon::config
