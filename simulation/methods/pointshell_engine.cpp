#include "simulation/methods/pointshell_engine.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {
namespace {

// Chamfer distances to neighbours, in thirds of a voxel (Borgefors 1986). The index is the number of
// differing coordinates: 1 shares a face, 2 an edge, 3 a corner.
constexpr int kChamfer[4] = {0, 3, 4, 5};

// Calls visit(neighbour, its chamfer distance) for the 26 voxels around v.
template <typename Visit>
void ForEachNeighbour(const VoxelIndex& v, const Visit& visit) {
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const int axes = std::abs(x) + std::abs(y) + std::abs(z);
        if (axes > 0) visit(VoxelIndex{v.x + x, v.y + y, v.z + z}, kChamfer[axes]);
      }
}

}  // namespace

PointshellEngine::PointshellEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
                                   const CuttingParams& params, const MethodParams& method_params)
    : VoxelMethod(Method::kPointshell, bone, solid, tool, X_WG, params, method_params.voxel_m),
      shell_(MakePointshell(tool, method_params.point_spacing_m)) {
  FindLayers();
}

void PointshellEngine::FindLayers() {
  layer_.assign(grid_.slots(), 3 * kLayers);
  // visit every solid voxel: the search radius covers the whole grid
  const Vector3 middle = grid_.CenterOf({grid_.size()[0] / 2, grid_.size()[1] / 2, grid_.size()[2] / 2});
  const double whole_grid_m = grid_.voxel_m() * (grid_.size()[0] + grid_.size()[1] + grid_.size()[2]);
  changed_.clear();
  grid_.ForEachSolidNear(middle, whole_grid_m, 0.0, [&](const VoxelIndex& v, double) {
    int distance_to_air = 3 * kLayers;
    ForEachNeighbour(v, [&](const VoxelIndex& other, int step) {
      if (!grid_.IsSolid(other)) distance_to_air = std::min(distance_to_air, step);
    });
    if (distance_to_air < 3 * kLayers) {
      layer_[grid_.SlotOf(v)] = static_cast<std::uint8_t>(distance_to_air);
      changed_.push_back(v);
    }
    return true;
  });
  SpreadChanges();
}

void PointshellEngine::SpreadChanges() {
  while (!changed_.empty()) {
    const VoxelIndex v = changed_.front();
    changed_.pop_front();
    const int depth = LayerOf(v);
    ForEachNeighbour(v, [&](const VoxelIndex& other, int step) {
      if (!grid_.IsSolid(other)) return;
      std::uint8_t& layer = layer_[grid_.SlotOf(other)];
      if (depth + step >= layer) return;
      layer = static_cast<std::uint8_t>(depth + step);
      changed_.push_back(other);
    });
  }
}

void PointshellEngine::LoadBone(const CarvedState& state) {
  VoxelMethod::LoadBone(state);
  FindLayers();
}

PointshellEngine::Penalty PointshellEngine::PenaltyAt(const Pose& X_G) const {
  Penalty penalty;
  const double h = grid_.voxel_m(), k = kPointStiffness * params_.stiffness_N_per_m;
  double depth_sum_m = 0.0;
  for (const Pointshell::Run& run : shell_.runs) {
    if (!grid_.AnyBrickNear(X_G * run.center_m, run.radius_m + h)) continue;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const Pointshell::Point& point = shell_.points[i];
      const Vector3 p = X_G * point.p_m;
      const VoxelIndex v = grid_.IndexOf(p);
      const int layer = LayerOf(v);
      if (layer == 0) continue;
      const Vector3 n = X_G.linear() * point.n;
      const double d = n.dot(grid_.CenterOf(v) - p) + (layer / 3.0 - 1.0) * h;
      if (d <= 0.0) continue;
      penalty.force_N += k * d * n;
      penalty.torque_Nm += (p - X_G.translation()).cross(k * d * n);
      penalty.stiffness_N_per_m += k * n * n.transpose();
      penalty.point_m += d * p;
      depth_sum_m += d;
      ++penalty.points;
      if (d > penalty.deepest_m) {
        penalty.deepest_m = d;
        penalty.cutting = point.cutting;
      }
    }
  }
  if (penalty.points > 0) penalty.point_m /= depth_sum_m;
  if (penalty.points > kFullPoints) {
    const double share = static_cast<double>(kFullPoints) / penalty.points;
    penalty.force_N *= share;
    penalty.torque_Nm *= share;
    penalty.stiffness_N_per_m *= share;
  }
  return penalty;
}

MethodFrame PointshellEngine::Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) {
  MethodFrame frame;
  const double K = params_.stiffness_N_per_m;
  Pose X = X_GT;
  X.translation() = X_GP.translation();

  // find the proxy at which the coupling's force and the penalty balance
  Penalty penalty;
  Vector3 pull_N = Vector3::Zero();
  for (int i = 0; i < kNewtonSteps; ++i) {
    pull_N = K * (X_GT.translation() - X.translation());
    double k = K;
    if (pull_N.norm() > params_.max_force_N) {  // a force at its limit has no stiffness
      pull_N *= params_.max_force_N / pull_N.norm();
      k = 0.0;
    }
    penalty = PenaltyAt(X);
    if (penalty.points == 0) {
      if (X.translation() == X_GT.translation()) break;
      X.translation() = X_GT.translation();  // no contact: the proxy follows the hand
      continue;
    }
    // k is at least 1 % of the coupling's stiffness, so that the matrix stays invertible
    const Matrix3 stiffness = std::max(k, 0.01 * K) * Matrix3::Identity() + penalty.stiffness_N_per_m;
    const Vector3 step = stiffness.ldlt().solve(pull_N + penalty.force_N);
    X.translation() += step;
    if (step.norm() < 1e-8) break;  // converged to 10 nm
  }
  penalty = PenaltyAt(X);
  frame.X_GP = X;

  const bool cutting = input.spindle_rad_per_s != 0.0;
  ToolPoints proxy = PlaceTool(tool_, X);
  // render the force of the coupling between the hand and the proxy
  const Vector3 proxy_offset = X.translation() - X_GT.translation();
  if (penalty.points > 0 && proxy_offset.norm() > 0.0) {
    frame.contact_fraction = 0.0;
    frame.touches = true;
    frame.touch_cuts = penalty.cutting;
    frame.depth_m = proxy_offset.norm();
    frame.n = proxy_offset / frame.depth_m;
    frame.force_N = std::min(K * frame.depth_m, params_.max_force_N) * frame.n;
    frame.torque_Nm = penalty.torque_Nm;
    frame.point_m = penalty.point_m - proxy_offset;
    if (cutting && frame.touch_cuts) MeasureEngagement(proxy, X_GT.linear().col(2), frame);
    Advance(input, 0.0, frame);
  }
  if (cutting) {
    double inset_m = 0.0;
    if (params_.law == RemovalLaw::kImmediate) {
      proxy = PlaceTool(tool_, X_GT);
    } else {
      // the depth to which the penalty lets the tool penetrate must not be cut
      inset_m = penalty.deepest_m;
      for (Vector3& point : proxy) point -= frame.advance_m * frame.n;
    }
    DeleteInside(proxy, inset_m, frame);
    SpreadChanges();
  }
  return frame;
}

}  // namespace osteon::simulation
