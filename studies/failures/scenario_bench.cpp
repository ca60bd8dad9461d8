#include "studies/failures/scenario_bench.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "simulation/packing/mass_points.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/solids/box_solid.h"
#include "simulation/solids/cut_zone.h"

namespace osteon::studies {

simulation::Bone MakeBlock(const BlockParams& params) {
  const double r = params.ball_radius_m;
  // Size of the space in which the balls' centres lie. The lattice that fills it has a spacing of at most 2/3
  // of the radius along each axis.
  const Vector3 centre_range_m = params.high_m - params.low_m - Vector3::Constant(2.0 * r);
  if (centre_range_m.minCoeff() < -1e-12)
    throw std::invalid_argument("block: found a side shorter than two ball radii");
  simulation::Bone bone;
  bone.name = "block";
  bone.materials = {{.name = "bone",
                     .density_kg_per_m3 = 500.0,
                     .specific_cutting_energy_J_per_m3 = params.specific_cutting_energy_J_per_m3,
                     .cutting_force_ratio = 0.8}};
  std::array<int, 3> count{};
  for (int axis = 0; axis < 3; ++axis)
    count[axis] =
        static_cast<int>(std::ceil(std::max(0.0, centre_range_m[axis]) / (2.0 / 3.0 * r) - 1e-9)) + 1;
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        Vector3 c = params.low_m + Vector3::Constant(r);
        const std::array<int, 3> at{i, j, k};
        for (int axis = 0; axis < 3; ++axis)
          if (count[axis] > 1) c[axis] += centre_range_m[axis] * at[axis] / (count[axis] - 1);
        bone.balls.push_back({.center_m = c, .radius_m = r});
      }
  if (params.point_spacing_m > 0.0)
    bone.points = simulation::BuildMassPoints(
        simulation::BoxSolid(params.low_m, params.high_m), simulation::EverywhereZone(),
        {.cells = {.finest_m = params.point_spacing_m, .coarser_from_m = {}}});
  return bone;
}

simulation::Tool MakeBallTool(double radius_m) {
  simulation::Tool tool;
  tool.name = "ball";
  tool.balls = {{.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true}};
  return tool;
}

Pose Downwards(const Vector3& p_m) {
  Pose X = Pose::Identity();
  // half a turn about x, so that the feed, the tool's z axis, points to -z
  X.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  X.translation() = p_m;
  return X;
}

std::vector<simulation::Ball> BallsLeft(const simulation::CarvedState& state) {
  return simulation::LiveBalls(state);
}

}  // namespace osteon::studies
