#pragma once

#include <string>
#include <vector>

namespace osteon::config {

/// The candidate that turns into `key` with the fewest edits (insert, delete, replace a letter, or swap two
/// neighbours); empty if all need more edits than a third of its length, as such a guess does not help.
[[nodiscard]] std::string NearestKey(const std::string& key, const std::vector<std::string>& candidates);

}  // namespace osteon::config
