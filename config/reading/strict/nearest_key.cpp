#include "config/reading/strict/nearest_key.h"

#include <algorithm>

namespace osteon::config {
namespace {

// longer keys are not compared, because the work grows with the square of the length
constexpr std::size_t kLongestKey = 100;

// Optimal string alignment distance: Levenshtein's, with a swap of neighbours as one edit. Only three rows of
// its table are stored: `before`, `last` and `row`, for the first i - 2, i - 1 and i letters of a.
std::size_t Distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

std::string NearestKey(const std::string& key, const std::vector<std::string>& candidates) {
  if (key.size() > kLongestKey) return {};
  std::string nearest;
  // begins with the smallest distance that is too large, then is the distance of the nearest candidate so far
  std::size_t min_distance = std::max<std::size_t>(1, key.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = Distance(key, candidate);
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace osteon::config
