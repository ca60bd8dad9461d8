#include "simulation/tools/proxy_path.h"

#include <algorithm>

#include "simulation/tools/thin_path.h"

namespace osteon::simulation {
namespace {

// The corners, in T, of the box around the centres of the cutting balls; equal corners are listed once.
std::vector<Vector3> CornersOf(const Tool& tool) {
  Eigen::AlignedBox3d box;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting) box.extend(Vector3(ball.center_m));
  if (box.isEmpty()) box.extend(Vector3::Zero());
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3 corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    if (std::find(corners.begin(), corners.end(), corner) == corners.end()) corners.push_back(corner);
  }
  return corners;
}

}  // namespace

ProxyPath::ProxyPath(const Tool& tool, const Pose& X_WG, std::size_t max_poses)
    : X_GW_(X_WG.inverse()), corners_T_(CornersOf(tool)), max_poses_(max_poses) {}

void ProxyPath::Add(const FrameRecord& frame) {
  if (frame.model.frame == 0 || frame.model.status != EngineStatus::kOk) return;
  const Pose X_GP = X_GW_ * Pose(frame.model.X_WP);
  if (!X_GP.matrix().allFinite()) return;
  X_GP_.push_back(X_GP);
  if (X_GP_.size() < max_poses_) return;
  // Thin only the poses that were added since the last thinning, starting from the pose at which that
  // thinning ended.
  Thin(thinned_ == 0 ? 0 : thinned_ - 1);
  // If too many poses are left, thin all of them to twice the tolerance. The errors of successive thinnings
  // add up to 1 + 2 + 4 + … times the first tolerance.
  while (X_GP_.size() > max_poses_ / 2) {
    step_m_ *= 2.0;
    Thin(0);
  }
}

// Distance of pose X from the chord from A to B: the largest distance of a corner of the tool's box from its
// interpolated position. All corners use the same fraction of the chord: the one at which the first corner is
// nearest. A pose is an affine map, so a ball's centre inside the box is never farther from its interpolated
// position than the farthest corner.
double ProxyPath::DistanceFromChord(const Pose& X, const Pose& A, const Pose& B) const {
  const Vector3 a = A * corners_T_.front(), along = B * corners_T_.front() - a;
  const double length2 = along.squaredNorm();
  const double fraction =
      length2 > 0.0 ? std::clamp(along.dot(X * corners_T_.front() - a) / length2, 0.0, 1.0) : 0.0;
  double max_distance_m = 0.0;
  for (const Vector3& corner : corners_T_)
    max_distance_m = std::max(
        max_distance_m, (X * corner - (1.0 - fraction) * (A * corner) - fraction * (B * corner)).norm());
  return max_distance_m;
}

void ProxyPath::Thin(std::size_t first) {
  const std::vector<Pose> rest(X_GP_.begin() + static_cast<std::ptrdiff_t>(first), X_GP_.end());
  const std::vector<Pose> thin = ThinPath(rest, step_m_, [this](const Pose& X, const Pose& A, const Pose& B) {
    return DistanceFromChord(X, A, B);
  });
  X_GP_.resize(first);
  X_GP_.insert(X_GP_.end(), thin.begin(), thin.end());
  thinned_ = X_GP_.size();
}

}  // namespace osteon::simulation
