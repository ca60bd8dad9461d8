#pragma once

#include <string>
#include <vector>

namespace osteon::config {

/// The candidate that the fewest edits (insert, delete, replace a letter, or swap two neighbours) turn into
/// `key`; empty where all are further than a third of its length: a guess that is no help.
[[nodiscard]] std::string NearestKey(const std::string& key, const std::vector<std::string>& candidates);

}  // namespace osteon::config
