#include "kinematics/half_spaces.h"

#include <algorithm>
#include <limits>

namespace osteon {
namespace {

constexpr int kMaxSet = 4;            // largest set: three planes fix a point, four also fix the slack s
constexpr double kTolerance = 1e-12;  // tolerance [m] of a plane's offset and of a multiplier
constexpr double kFeasible = 1e-9;    // a solved point may lie this far outside [m]
// planes count as parallel if the Gram determinant of their normals is smaller
constexpr double kMinVolume = 1e-9;
constexpr double kFlatShare = 1e-12;   // a smaller component of the new plane's normal counts as zero
constexpr int kMaxRounds = 24;         // usually two to six rounds are enough
constexpr double kSlackWeight = 1e-6;  // inverse weight of s^2 in the cost |x|^2 + 1e6 s^2

using Planes = std::array<HalfSpace, kMaxHalfSpaces>;
using SetVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSet, 1>;
using SetMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSet, kMaxSet>;

// A set of planes on which the point is assumed to lie.
struct Set {
  std::array<std::size_t, kMaxSet> plane{};
  int size{0};
};

// Finds the multipliers of the point on all planes of the set that is nearest to the origin. They solve Gram
// matrix times multipliers = right side, which is the offsets or, to resolve a direction, its components
// along the normals. `slack` is added to each Gram element. Elimination in place, without pivoting because
// the matrix is positive definite. False if the planes are parallel.
bool SolveSet(const Planes& planes, const Set& set, double slack, SetVector& multiplier,
              const Vector3* direction = nullptr) {
  SetMatrix gram(set.size, set.size);
  multiplier.resize(set.size);
  for (int i = 0; i < set.size; ++i) {
    const HalfSpace& a = planes[set.plane[static_cast<std::size_t>(i)]];
    for (int j = 0; j < set.size; ++j)
      gram(i, j) = a.n.dot(planes[set.plane[static_cast<std::size_t>(j)]].n) + slack;
    multiplier[i] = direction ? a.n.dot(*direction) : a.offset;
  }
  const double min_volume = slack > 0.0 ? kMinVolume * slack : kMinVolume;
  double volume = 1.0;
  for (int k = 0; k < set.size; ++k) {
    volume *= gram(k, k);
    if (!(volume > min_volume)) return false;
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

// How far x is outside the worst half-space; 0 if it is in all of them.
double WorstViolation(const Planes& planes, int count, const Vector3& x) {
  double worst = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    worst = std::max(worst, planes[i].offset - planes[i].n.dot(x));
  return worst;
}

// The dual active-set method. Starts from the free minimum x = 0. Each round adds the most violated plane,
// and drops a plane whose multiplier would become negative: such a plane would pull the point toward itself.
// Each round ends at the nearest point on a set of planes, which is further from the origin than that of the
// round before, so no set is used twice. On success `active` are the planes that the nearest point lies on.
// Returns false if no point satisfies all planes, or if rounding gives this impression. Source: Goldfarb and
// Idnani, A Numerically Stable Dual Method for Solving Strictly Convex Quadratic Programs, Math. Programming
// 27, 1983.
bool FindActive(const Planes& planes, int count, Set& active) {
  Vector3 x = Vector3::Zero();
  std::array<double, kMaxSet> pull{};  // multipliers of the active planes
  for (int round = 0; round < kMaxRounds; ++round) {
    std::size_t worst = 0;  // the most violated plane
    double outside = kTolerance;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const double violation = planes[i].offset - planes[i].n.dot(x);
      if (violation <= outside) continue;
      outside = violation;
      worst = i;
    }
    if (outside <= kTolerance) return true;
    const HalfSpace& entering = planes[worst];
    double entering_pull = 0.0;
    for (;;) {
      // split the new plane's normal into a combination of the active normals and a remainder
      SetVector components;
      if (!SolveSet(planes, active, 0.0, components, &entering.n)) return false;
      Vector3 z = entering.n;
      for (int i = 0; i < active.size; ++i)
        z -= components[i] * planes[active.plane[static_cast<std::size_t>(i)]].n;
      // the longest step until an active plane's multiplier becomes zero: that plane is dropped
      double step = std::numeric_limits<double>::infinity();
      int leaving = -1;
      for (int i = 0; i < active.size; ++i) {
        if (!(components[i] > kFlatShare) || pull[static_cast<std::size_t>(i)] >= step * components[i])
          continue;
        step = pull[static_cast<std::size_t>(i)] / components[i];
        leaving = i;
      }
      const double room = active.size < 3 ? z.dot(entering.n) : 0.0;
      const bool moves = room > kMinVolume;  // false: the new normal is a combination of the active normals
      if (moves && (entering.offset - entering.n.dot(x)) / room <= step) {
        step = (entering.offset - entering.n.dot(x)) / room;
        leaving = -1;
      } else if (leaving < 0) {
        return false;  // no plane to drop, and no direction to move
      }
      if (moves) x += step * z;
      for (int i = 0; i < active.size; ++i) pull[static_cast<std::size_t>(i)] -= step * components[i];
      entering_pull += step;
      if (leaving < 0) break;
      --active.size;
      for (int i = leaving; i < active.size; ++i) {
        active.plane[static_cast<std::size_t>(i)] = active.plane[static_cast<std::size_t>(i) + 1];
        pull[static_cast<std::size_t>(i)] = pull[static_cast<std::size_t>(i) + 1];
      }
    }
    active.plane[static_cast<std::size_t>(active.size)] = worst;
    pull[static_cast<std::size_t>(active.size)] = entering_pull;
    ++active.size;
  }
  return false;
}

// The nearest point found so far.
struct BestPoint {
  double cost{std::numeric_limits<double>::infinity()};
  HalfSpaceProjection projection;
};

// Takes the nearest point on a set of planes as the best point if all multipliers are >= 0, no plane is
// violated, and its cost is lower than before.
bool AcceptSet(const Planes& planes, int count, const Set& set, double slack, BestPoint& best) {
  SetVector multiplier;
  if (!SolveSet(planes, set, slack, multiplier)) return false;
  if (!(multiplier.minCoeff() >= -kTolerance)) return false;  // a plane would pull the point toward itself
  Vector3 x = Vector3::Zero();
  for (int i = 0; i < set.size; ++i) x += multiplier[i] * planes[set.plane[static_cast<std::size_t>(i)]].n;
  const double sum = multiplier.sum(), violation = WorstViolation(planes, count, x);
  const double cost = x.squaredNorm() + slack * sum * sum;
  if (violation > slack * sum + kFeasible || !(cost < best.cost)) return false;
  best.cost = cost;
  best.projection.point = x;
  best.projection.violation = violation <= kFeasible ? 0.0 : violation;
  best.projection.multiplier.fill(0.0);
  for (int i = 0; i < set.size; ++i)
    best.projection.multiplier[set.plane[static_cast<std::size_t>(i)]] = std::max(0.0, multiplier[i]);
  return true;
}

// Solves   min |x|^2 + s^2 / slack   subject to   n_i·x + s >= offset_i   by trying every set of at most
// largest_set planes; if slack = 0, s is 0. False if no set gives a point.
bool SolveByEverySet(const Planes& planes, int count, double slack, int largest_set, BestPoint& best) {
  best.cost = std::numeric_limits<double>::infinity();
  // all sets, by size, then in the order of their indices, which rise within each set
  for (int size = 1; size <= std::min(largest_set, count); ++size) {
    Set set;
    set.size = size;
    for (int i = 0; i < size; ++i) set.plane[static_cast<std::size_t>(i)] = static_cast<std::size_t>(i);
    while (true) {
      AcceptSet(planes, count, set, slack, best);
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
  return best.cost < std::numeric_limits<double>::infinity();
}

}  // namespace

HalfSpaceProjection ClosestInHalfSpaces(const Planes& planes, int count) noexcept {
  BestPoint best;
  const double violation = WorstViolation(planes, count, Vector3::Zero());
  if (violation <= kTolerance) return best.projection;
  Set active;
  if (FindActive(planes, count, active) && AcceptSet(planes, count, active, 0.0, best))
    return best.projection;
  // The planes are so nearly parallel that rounding decides, or the intersection is empty: try every set.
  if (SolveByEverySet(planes, count, 0.0, 3, best)) return best.projection;
  // The intersection is empty, or only a distant point is in it: let all planes yield by one common slack.
  if (SolveByEverySet(planes, count, kSlackWeight, kMaxSet, best)) return best.projection;
  best.projection.violation = violation;
  return best.projection;
}

}  // namespace osteon
