#include "studies/charts/dominance.h"

#include <algorithm>
#include <cmath>

namespace osteon::studies {
namespace {

// Whether error and time are finite and the time is positive.
bool IsMeasured(const report::CostPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0.0; }

// Whether a's time and a's error are both smaller than b's.
bool BeatsInBoth(const report::CostPoint& a, const report::CostPoint& b) { return a.x < b.x && a.y < b.y; }

}  // namespace

Dominance CompareWithOurs(std::span<const RivalPoint> points) {
  std::vector<std::size_t> ours, others;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (IsMeasured(points[i].cost)) (points[i].ours ? ours : others).push_back(i);
  Dominance found{.ours_measured = !ours.empty()};
  if (ours.empty()) return found;

  for (const std::size_t own : ours) {
    BeatenPoint beaten{.ours = own};
    for (const std::size_t other : others)
      if (BeatsInBoth(points[other].cost, points[own].cost)) beaten.by.push_back(other);
    if (!beaten.by.empty()) found.beaten.push_back(std::move(beaten));
  }
  for (const std::size_t other : others) {
    const report::CostPoint& cost = points[other].cost;
    const auto all_of_ours = [&](const auto& holds) {
      return std::ranges::all_of(ours, [&](std::size_t own) { return holds(points[own].cost); });
    };
    if (all_of_ours([&](const report::CostPoint& own) { return BeatsInBoth(cost, own); }))
      found.beat_all_ours.push_back(other);
    if (all_of_ours([&](const report::CostPoint& own) { return cost.x < own.x; }))
      found.faster_than_all_ours.push_back(other);
    else if (all_of_ours([&](const report::CostPoint& own) { return cost.x < own.x || cost.y < own.y; }))
      found.ahead.push_back(other);
  }
  return found;
}

}  // namespace osteon::studies
