#include "simulation/tools/tool_path.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {

ToolPoints PlaceTool(const Tool& tool, const Pose& X_GT) {
  ToolPoints points;
  points.reserve(tool.balls.size() + 1);
  for (const ToolBall& ball : tool.balls) points.push_back(X_GT * Vector3(ball.center_m));
  points.push_back(X_GT.translation());
  return points;
}

ToolPoints InterpolatePoints(const ToolPoints& a, const ToolPoints& b, double s) {
  ToolPoints points(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) points[i] = a[i] + s * (b[i] - a[i]);
  return points;
}

int ChordCount(double turn_rad, double lever_m) {
  const double chords = std::ceil(turn_rad * std::sqrt(lever_m / (8.0 * kChordError_m)));
  return chords >= 1.0 ? static_cast<int>(std::min<double>(chords, kMaxChords)) : 1;
}

double ToolLever(const Tool& tool) {
  double lever_m = 0.0;
  for (const ToolBall& ball : tool.balls) lever_m = std::max(lever_m, Vector3(ball.center_m).norm());
  return lever_m;
}

int SubframeCount(double lever_m, const Pose& X_WP, const Pose& X_WT) {
  return ChordCount(Eigen::Quaterniond(X_WP.linear()).angularDistance(Eigen::Quaterniond(X_WT.linear())),
                    lever_m);
}

Pose PoseBetween(const Pose& X_WA, const Pose& X_WB, int k, int n) {
  if (k >= n) return X_WB;
  const double s = static_cast<double>(k) / n;
  const Eigen::Quaterniond q_A(X_WA.linear()), q_B(X_WB.linear());
  Pose X = X_WB;
  X.linear() = q_A.slerp(s, q_B).toRotationMatrix();
  X.translation() = X_WA.translation() + s * (X_WB.translation() - X_WA.translation());
  return X;
}

}  // namespace osteon::simulation
