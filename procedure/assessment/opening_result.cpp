#include "procedure/assessment/opening_result.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "procedure/assessment/cavity_result.h"
#include "procedure/assessment/target_tissue.h"

namespace osteon::procedure {
namespace {

// The roof is judged in square columns along the axis. Edge of a column: a little more than the mass points'
// spacing of 0.2 mm.
constexpr double kColumn_m = 0.25e-3;
// Columns nearer to the rim than this are not judged, because mass points cannot resolve whether an opening
// is 0.1 mm too narrow.
constexpr double kRim_m = 0.2e-3;

// Centroid of points, weighted by their volumes; nothing without a volume.
class Centroid {
 public:
  void Add(const Vector3& p_m, double volume_m3) {
    sum_ += volume_m3 * p_m;
    volume_m3_ += volume_m3;
  }
  [[nodiscard]] std::optional<Vector3> value() const {
    return volume_m3_ > 0.0 ? std::optional<Vector3>(sum_ / volume_m3_) : std::nullopt;
  }

 private:
  Vector3 sum_{Vector3::Zero()};
  double volume_m3_{0.0};
};

// A column within the planned opening: whether it contains target tissue, had hard tissue before the cut, and
// still has hard tissue.
struct Column {
  bool has_target{false}, had_hard{false}, has_hard_left{false};
  [[nodiscard]] bool is_roof() const { return has_target && had_hard; }
};

// Height of the floor that the tools left, along the axis from `from_m` [m]: the lowest top of all cut balls.
// Cut balls touch the swept space from outside, so no top is below the floor. Nothing if no ball was cut.
std::optional<double> FloorHeight(const simulation::Bone& uncut, const simulation::CarvedState& state,
                                  const Vector3& from_m, const Vector3& axis) {
  std::optional<double> floor_m;
  for (const simulation::Ball& ball : CutBalls(uncut, state)) {
    const double top_m = (Vector3(ball.center_m) - from_m).dot(axis) + ball.radius_m;
    floor_m = std::min(floor_m.value_or(top_m), top_m);
  }
  return floor_m;
}

}  // namespace

OpeningResult AssessOpening(const SurgicalPlan& plan, const simulation::Bone& uncut,
                            const simulation::CarvedState& state) {
  const PlannedCavity cavity = plan.cavity();
  const Matrix3 R_GC = RotationFromZTo(plan.axis_G);
  Centroid removed, planned;
  std::map<std::pair<int, int>, Column> columns;
  for (std::size_t i = 0; i < uncut.points.size() && i < state.cleared.size(); ++i) {
    const simulation::MassPoint& point = uncut.points[i];
    const Vector3 p_m = point.p_m, p_C = R_GC.transpose() * (p_m - cavity.centre_m);
    const bool left = state.cleared[i] == 0, inside = cavity.DistanceTo(p_m) < 0.0;
    const bool is_target = IsTarget(plan, uncut, point);
    if (!is_target && inside) planned.Add(p_C, point.volume_m3);
    if (!is_target && !left) removed.Add(p_C, point.volume_m3);
    if (!inside || p_C.head<2>().norm() > cavity.opening_radius_m() - kRim_m) continue;
    Column& column = columns[{static_cast<int>(std::floor(p_C.x() / kColumn_m)),
                              static_cast<int>(std::floor(p_C.y() / kColumn_m))}];
    column.has_target |= is_target;
    column.had_hard |= !is_target;
    column.has_hard_left |= !is_target && left;
  }

  OpeningResult result;
  if (const auto found = removed.value(), wanted = planned.value(); found && wanted)
    result.shift_m = (*found - *wanted).head<2>().norm();
  if (const auto floor_m = FloorHeight(uncut, state, cavity.centre_m, plan.axis_G))
    result.depth_error_m = -cavity.radius_m - *floor_m;
  int roof = 0, open = 0;  // numbers of columns
  for (const auto& [place, column] : columns) {
    roof += column.is_roof() ? 1 : 0;
    open += column.is_roof() && !column.has_hard_left ? 1 : 0;
  }
  if (roof > 0) result.unroofed = static_cast<double>(open) / roof;
  return result;
}

}  // namespace osteon::procedure
