#include "kinematics/half_spaces.h"

#include <algorithm>

namespace osteon {
namespace {

constexpr double kTolerance = 1e-12;     // of a plane's offset [m] and of a multiplier [m]
constexpr double kLeastVolume = 1e-9;    // of a Gram determinant of unit normals: below, the planes are parallel

// Multipliers of the point on all planes of the set: Gram matrix times multipliers = offsets. False where parallel.
bool SolveSet(const std::array<HalfSpace, kMaxHalfSpaces>& planes, const std::array<int, 3>& set, int size,
              std::array<double, 3>& multiplier) {
  const auto offset = [&](int i) { return planes[static_cast<std::size_t>(set[i])].offset; };
  const auto dot = [&](int i, int j) {
    return planes[static_cast<std::size_t>(set[i])].n.dot(planes[static_cast<std::size_t>(set[j])].n);
  };
  if (size == 1) {
    multiplier = {offset(0), 0.0, 0.0};
    return true;
  }
  if (size == 2) {
    const double c = dot(0, 1), det = 1.0 - c * c;
    if (det < kLeastVolume) return false;
    multiplier = {(offset(0) - c * offset(1)) / det, (offset(1) - c * offset(0)) / det, 0.0};
    return true;
  }
  Matrix3 gram;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) gram(i, j) = dot(i, j);
  if (gram.determinant() < kLeastVolume) return false;
  const Vector3 m = gram.inverse() * Vector3(offset(0), offset(1), offset(2));
  multiplier = {m.x(), m.y(), m.z()};
  return true;
}

}  // namespace

HalfSpaceProjection ClosestInHalfSpaces(const std::array<HalfSpace, kMaxHalfSpaces>& planes, int count) noexcept {
  const auto violation_at = [&](const Vector3& x) {
    double worst = 0.0;
    for (int i = 0; i < count; ++i)
      worst = std::max(worst, planes[static_cast<std::size_t>(i)].offset - planes[static_cast<std::size_t>(i)].n.dot(x));
    return worst;
  };

  HalfSpaceProjection best;
  best.violation = violation_at(Vector3::Zero());
  if (best.violation <= kTolerance) {
    best.violation = 0.0;
    return best;
  }
  double best_distance = 0.0;
  bool best_feasible = false;

  const auto consider = [&](const std::array<int, 3>& set, int size) {
    std::array<double, 3> multiplier{};
    if (!SolveSet(planes, set, size, multiplier)) return;
    Vector3 x = Vector3::Zero();
    for (int i = 0; i < size; ++i) {
      if (multiplier[static_cast<std::size_t>(i)] < -kTolerance) return;  // the plane would pull
      x += multiplier[static_cast<std::size_t>(i)] * planes[static_cast<std::size_t>(set[static_cast<std::size_t>(i)])].n;
    }
    const double violation = violation_at(x), distance = x.squaredNorm();
    const bool feasible = violation <= 1e-9;
    const bool better = feasible ? (!best_feasible || distance < best_distance)
                                 : (!best_feasible && violation < best.violation);
    if (!better) return;
    best_feasible = feasible;
    best_distance = distance;
    best.point = x;
    best.violation = feasible ? 0.0 : violation;
    best.multiplier.fill(0.0);
    for (int i = 0; i < size; ++i)
      best.multiplier[static_cast<std::size_t>(set[static_cast<std::size_t>(i)])] =
          std::max(0.0, multiplier[static_cast<std::size_t>(i)]);
  };
  for (int i = 0; i < count; ++i) consider({i, 0, 0}, 1);
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j) consider({i, j, 0}, 2);
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j)
      for (int k = j + 1; k < count; ++k) consider({i, j, k}, 3);
  return best;
}

}  // namespace osteon
