#include "procedure/plan/planned_cavity.h"

#include <cmath>

#include "simulation/bone/scene_events.h"

namespace osteon::procedure {
namespace {

// Share of a cell of edge h that lies inside a surface at this signed distance from the cell's centre.
double ShareInside(double distance_m, double h_m) { return std::clamp(0.5 - distance_m / h_m, 0.0, 1.0); }

}  // namespace

double BoneInCavity(const simulation::Solid& solid, const PlannedCavity& cavity, double cell_m) {
  const Eigen::AlignedBox3d box = solid.Bounds();
  const Eigen::Vector3i count = (box.sizes() / cell_m).array().ceil().matrix().cast<int>().cwiseMax(1);
  const double half_diagonal_m = 0.5 * std::sqrt(3.0) * cell_m;
  double cells = 0.0;
  for (int x = 0; x < count.x(); ++x)
    for (int y = 0; y < count.y(); ++y)
      for (int z = 0; z < count.z(); ++z) {
        const Vector3 p_m = box.min() + cell_m * (Vector3(x, y, z) + Vector3::Constant(0.5));
        const double in_cavity_m = cavity.DistanceTo(p_m);
        if (in_cavity_m > half_diagonal_m) continue;
        const double in_bone_m = solid.SignedDistance(p_m);
        if (in_bone_m > half_diagonal_m) continue;
        cells += ShareInside(in_cavity_m, cell_m) * ShareInside(in_bone_m, cell_m);
      }
  return cells * cell_m * cell_m * cell_m;
}

std::optional<double> PlannedWall(const simulation::Solid& solid, const simulation::CutSite& site,
                                  const PlannedCavity& cavity, double sample_spacing_m) {
  simulation::Bone bone;
  bone.site = site;
  simulation::Tool tool;
  tool.balls = {{.center_m = Vector3::Zero(), .radius_m = cavity.radius_m, .cutting = true}};
  simulation::SceneEventParams params;
  params.min_wall_m = 0.1;  // every wall counts as an event: only its thickness is asked for
  params.wall_spacing_m = sample_spacing_m;
  simulation::SceneWatch watch(&solid, bone, tool, params);
  Pose X_GP = Pose::Identity();
  X_GP.translation() = cavity.centre_m;
  static_cast<void>(watch.Step(X_GP, 1.0, {}));
  return watch.min_wall_m();
}

}  // namespace osteon::procedure
