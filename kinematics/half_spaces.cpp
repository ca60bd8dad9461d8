#include "kinematics/half_spaces.h"

#include <algorithm>
#include <limits>

namespace osteon {
namespace {

constexpr int kLargestSet = 4;        // three planes fix a point, a fourth its slack
constexpr double kTolerance = 1e-12;  // of a plane's offset [m] and of a multiplier [m]
constexpr double kFeasible = 1e-9;    // a solved point may lie this far outside [m]
constexpr double kLeastVolume =
    1e-9;  // of a Gram determinant of unit normals: below, the planes are parallel
constexpr double kSlackWeight = 1e-6;  // square of the slack's compliance against the point's

using Planes = std::array<HalfSpace, kMaxHalfSpaces>;
using SetVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kLargestSet, 1>;
using SetMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kLargestSet, kLargestSet>;

// A set of planes that the point lies on.
struct Set {
  std::array<std::size_t, kLargestSet> plane{};
  int size{0};
};

// Multipliers of the nearest point on all planes of the set: Gram matrix times multipliers = offsets, by
// elimination in place (the matrix is positive definite: no pivoting). False where the planes are parallel.
bool SolveSet(const Planes& planes, const Set& set, double slack, SetVector& multiplier) {
  SetMatrix gram(set.size, set.size);
  multiplier.resize(set.size);
  for (int i = 0; i < set.size; ++i) {
    const HalfSpace& a = planes[set.plane[static_cast<std::size_t>(i)]];
    for (int j = 0; j < set.size; ++j)
      gram(i, j) = a.n.dot(planes[set.plane[static_cast<std::size_t>(j)]].n) + slack;
    multiplier[i] = a.offset;
  }
  const double least = slack > 0.0 ? kLeastVolume * slack : kLeastVolume;
  double volume = 1.0;
  for (int k = 0; k < set.size; ++k) {
    volume *= gram(k, k);
    if (!(volume > least)) return false;
    for (int i = k + 1; i < set.size; ++i) {
      const double factor = gram(i, k) / gram(k, k);
      for (int j = k; j < set.size; ++j) gram(i, j) -= factor * gram(k, j);
      multiplier[i] -= factor * multiplier[k];
    }
  }
  for (int i = set.size - 1; i >= 0; --i) {
    for (int j = i + 1; j < set.size; ++j) multiplier[i] -= gram(i, j) * multiplier[j];
    multiplier[i] /= gram(i, i);
  }
  return true;
}

double WorstViolation(const Planes& planes, int count, const Vector3& x) {
  double worst = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    worst = std::max(worst, planes[i].offset - planes[i].n.dot(x));
  return worst;
}

// Solves   min |x|^2 + s^2 / slack   subject to   n_i·x + s >= offset_i   over every set of at most
// largest_set planes; with slack = 0 there is no s. False where no set gives a point.
bool Solve(const Planes& planes, int count, double slack, int largest_set, HalfSpaceProjection& best) {
  double best_cost = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Set& set) {
    SetVector multiplier;
    if (!SolveSet(planes, set, slack, multiplier)) return;
    if (!(multiplier.minCoeff() >= -kTolerance)) return;  // a plane would pull
    Vector3 x = Vector3::Zero();
    for (int i = 0; i < set.size; ++i) x += multiplier[i] * planes[set.plane[static_cast<std::size_t>(i)]].n;
    const double sum = multiplier.sum(), violation = WorstViolation(planes, count, x);
    const double cost = x.squaredNorm() + slack * sum * sum;
    if (violation > slack * sum + kFeasible || !(cost < best_cost)) return;
    best_cost = cost;
    best.point = x;
    best.violation = violation <= kFeasible ? 0.0 : violation;
    best.multiplier.fill(0.0);
    for (int i = 0; i < set.size; ++i)
      best.multiplier[set.plane[static_cast<std::size_t>(i)]] = std::max(0.0, multiplier[i]);
  };

  // by size, then in index order: next_set counts up like an odometer whose digits only grow to the right
  for (int size = 1; size <= std::min(largest_set, count); ++size) {
    Set set;
    set.size = size;
    for (int i = 0; i < size; ++i) set.plane[static_cast<std::size_t>(i)] = static_cast<std::size_t>(i);
    while (true) {
      consider(set);
      int digit = size - 1;
      while (digit >= 0 &&
             set.plane[static_cast<std::size_t>(digit)] == static_cast<std::size_t>(count - size + digit))
        --digit;
      if (digit < 0) break;
      ++set.plane[static_cast<std::size_t>(digit)];
      for (int i = digit + 1; i < size; ++i)
        set.plane[static_cast<std::size_t>(i)] = set.plane[static_cast<std::size_t>(i - 1)] + 1;
    }
  }
  return best_cost < std::numeric_limits<double>::infinity();
}

}  // namespace

HalfSpaceProjection ClosestInHalfSpaces(const Planes& planes, int count) noexcept {
  HalfSpaceProjection best;
  const double violation = WorstViolation(planes, count, Vector3::Zero());
  if (violation <= kTolerance) return best;
  if (Solve(planes, count, 0.0, 3, best)) return best;
  // empty (or so nearly parallel that only a point far away would do): share one slack among the planes
  if (Solve(planes, count, kSlackWeight, kLargestSet, best)) return best;
  best.violation = violation;
  return best;
}

}  // namespace osteon
