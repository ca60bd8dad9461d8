#include "procedure/plan/planned_cavity.h"

#include <cmath>
#include <numbers>

#include "simulation/bone/scene_events.h"

namespace osteon::procedure {
namespace {

// Estimates the share 0 … 1 of a cell of edge h_m that lies inside a surface, from the signed distance of the
// cell's centre to the surface.
double ShareInside(double distance_m, double h_m) { return std::clamp(0.5 - distance_m / h_m, 0.0, 1.0); }

}  // namespace

double BoneInCavity(const simulation::Solid& solid, const PlannedCavity& cavity, double cell_m,
                    std::span<const PlannedCavity> cleared) {
  const Eigen::AlignedBox3d box = solid.Bounds();
  const Eigen::Vector3i count = (box.sizes() / cell_m).array().ceil().matrix().cast<int>().cwiseMax(1);
  const double half_diagonal_m = 0.5 * std::sqrt(3.0) * cell_m;
  // visit only the cells in a box around the cavity: from the cavity's centre along its axis to beyond the
  // solid
  Eigen::AlignedBox3d along_axis(cavity.centre_m);
  along_axis.extend(cavity.centre_m +
                    (box.diagonal().norm() + (cavity.centre_m - box.center()).norm()) * cavity.axis);
  const Vector3 reach = Vector3::Constant(cavity.opening_radius_m() + cell_m);
  const auto index = [&](const Vector3& p_m) {
    return ((p_m - box.min()) / cell_m).array().floor().matrix().cast<int>().eval();
  };
  const Eigen::Vector3i first = index(along_axis.min() - reach).cwiseMax(0),
                        last = (index(along_axis.max() + reach) + Eigen::Vector3i::Ones()).cwiseMin(count);
  double cells = 0.0;
  for (int x = first.x(); x < last.x(); ++x)
    for (int y = first.y(); y < last.y(); ++y)
      for (int z = first.z(); z < last.z(); ++z) {
        const Vector3 p_m = box.min() + cell_m * (Vector3(x, y, z) + Vector3::Constant(0.5));
        const double in_cavity_m = cavity.DistanceTo(p_m);
        if (in_cavity_m > half_diagonal_m) continue;
        const double in_bone_m = solid.SignedDistance(p_m);
        if (in_bone_m > half_diagonal_m) continue;
        double cleared_share = 0.0;
        for (const PlannedCavity& earlier : cleared)
          cleared_share = std::max(cleared_share, ShareInside(earlier.DistanceTo(p_m), cell_m));
        cells +=
            std::max(0.0, ShareInside(in_cavity_m, cell_m) - cleared_share) * ShareInside(in_bone_m, cell_m);
      }
  return cells * cell_m * cell_m * cell_m;
}

std::optional<double> PlannedWall(const simulation::Solid& solid, const simulation::CutSite& site,
                                  const PlannedCavity& cavity, double sample_spacing_m) {
  // put a ball of the tool's size at the planned positions, and let SceneWatch find the thinnest wall
  simulation::Bone bone;
  bone.site = site;
  simulation::Tool tool;
  tool.balls = {{.center_m = Vector3::Zero(), .radius_m = cavity.radius_m, .cutting = true}};
  simulation::SceneEventParams params;
  params.min_wall_m = 0.1;  // so large that every wall is an event; only the thickness is used here
  params.wall_spacing_m = sample_spacing_m;
  simulation::SceneWatch watch(&solid, bone, tool, params);
  Pose X_GP = Pose::Identity();
  X_GP.translation() = cavity.centre_m;
  static_cast<void>(watch.Step(X_GP, 1.0, {}));
  constexpr int kPlaces = 36;  // sampled positions of a tool that is led around the axis
  const Matrix3 across = RotationFromZTo(cavity.axis);
  for (int i = 0; i < kPlaces && cavity.around_m > 0.0; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kPlaces;
    X_GP.translation() =
        cavity.centre_m + cavity.around_m * (across * Vector3(std::cos(angle_rad), std::sin(angle_rad), 0.0));
    static_cast<void>(watch.Step(X_GP, 2.0 + i, {}));
  }
  return watch.min_wall_m();
}

}  // namespace osteon::procedure
