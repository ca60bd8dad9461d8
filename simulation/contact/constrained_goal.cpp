#include "simulation/contact/constrained_goal.h"

#include <algorithm>
#include <limits>

namespace osteon::simulation {
namespace {

// A set of planes, and the point nearest to the origin that lies on all of them (each shifted by the slack).
struct PlaneSet {
  std::array<std::size_t, kMaxHolding> plane{};
  std::array<double, kMaxHolding> multiplier{};
  int size{0};
  Vector3 point{Vector3::Zero()};
  double slack{0.0};

  // How far the point is on the wrong side of a plane [m], after the plane has yielded by the slack.
  double Violation(const HalfSpace& h) const { return h.offset - h.n.dot(point) - slack; }
};

// Computes the multipliers, point x and slack s of the set, so that (x, s) is the nearest point on all of its
// planes. The method is elimination of the Gram matrix, which is positive definite. Returns false if planes
// are parallel, or if a multiplier is not positive (this plane would have to pull).
bool Solve(std::span<const HalfSpace> planes, PlaneSet& set) {
  std::array<std::array<double, kMaxHolding>, kMaxHolding> gram{};
  std::array<double, kMaxHolding> value{};
  const auto size = static_cast<std::size_t>(set.size);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j)
      gram[i][j] = planes[set.plane[i]].n.dot(planes[set.plane[j]].n) + kHoldSlack;
    value[i] = planes[set.plane[i]].offset;
  }
  for (std::size_t k = 0; k < size; ++k) {
    if (!(gram[k][k] > kMinPivot)) return false;
    for (std::size_t i = k + 1; i < size; ++i) {
      const double factor = gram[i][k] / gram[k][k];
      for (std::size_t j = k; j < size; ++j) gram[i][j] -= factor * gram[k][j];
      value[i] -= factor * value[k];
    }
  }
  set.point.setZero();
  set.slack = 0.0;
  for (std::size_t k = size; k-- > 0;) {
    double m = value[k];
    for (std::size_t j = k + 1; j < size; ++j) m -= gram[k][j] * set.multiplier[j];
    m /= gram[k][k];
    if (!(m > 0.0)) return false;
    set.multiplier[k] = m;
    set.point += m * planes[set.plane[k]].n;
    set.slack += kHoldSlack * m;
  }
  return true;
}

// Finds the subset of the held planes that, together with the plane `entering`, has a nearest point that
// violates no held plane. Exactly one such subset exists. If rounding leaves none, takes the subset with the
// smallest violation.
PlaneSet Exchange(std::span<const HalfSpace> planes, const PlaneSet& held, std::size_t entering) {
  PlaneSet best;
  double best_violation = std::numeric_limits<double>::infinity();
  // bit i of the mask: held plane i is in the subset
  for (unsigned mask = 0; mask < 1u << held.size; ++mask) {
    PlaneSet set;
    for (int i = 0; i < held.size; ++i)
      if (mask >> i & 1u) {
        if (set.size + 1 == static_cast<int>(kMaxHolding)) break;
        set.plane[static_cast<std::size_t>(set.size++)] = held.plane[static_cast<std::size_t>(i)];
      }
    set.plane[static_cast<std::size_t>(set.size++)] = entering;
    if (!Solve(planes, set)) continue;
    double violation = 0.0;
    for (int i = 0; i < held.size; ++i)
      violation = std::max(violation, set.Violation(planes[held.plane[static_cast<std::size_t>(i)]]));
    if (violation >= best_violation) continue;
    best_violation = violation;
    best = set;
  }
  return best;
}

}  // namespace

ConstrainedGoal FindConstrainedGoal(std::span<const HalfSpace> planes, std::span<const std::size_t> start) {
  PlaneSet held;
  if (!start.empty()) {
    PlaneSet likely;
    for (const std::size_t plane : start) likely.plane[static_cast<std::size_t>(likely.size++)] = plane;
    if (Solve(planes, likely)) held = likely;
  }
  for (int round = 0; round < kMaxHoldRounds; ++round) {
    double worst = kViolated_m;
    std::size_t entering = planes.size();
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double violation = held.Violation(planes[i]);
      if (violation <= worst) continue;
      worst = violation;
      entering = i;
    }
    if (entering == planes.size()) break;
    const PlaneSet next = Exchange(planes, held, entering);
    if (next.size == 0) break;
    // if the entering plane was already held, its violation is only rounding: stop
    const auto end = held.plane.begin() + held.size;
    const bool again = std::find(held.plane.begin(), end, entering) != end;
    held = next;
    if (again) break;
  }
  return {.point_m = held.point,
          .slack_m = held.slack,
          .count = held.size,
          .plane = held.plane,
          .multiplier_m = held.multiplier};
}

}  // namespace osteon::simulation
