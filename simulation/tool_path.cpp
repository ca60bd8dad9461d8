#include "simulation/tool_path.h"

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

ToolPoints Between(const ToolPoints& a, const ToolPoints& b, double s) {
  ToolPoints points(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) points[i] = a[i] + s * (b[i] - a[i]);
  return points;
}

ToolPoints ToolPath::Place(double share) const {
  std::size_t piece = 1;
  while (piece + 1 < at.size() && s[piece] < share) ++piece;
  return Between(at[piece - 1], at[piece], (share - s[piece - 1]) / (s[piece] - s[piece - 1]));
}

std::vector<ToolPoints> ToolPath::UpTo(double share) const {
  std::vector<ToolPoints> part{at.front()};
  for (std::size_t i = 1; i + 1 < at.size() && s[i] < share; ++i) part.push_back(at[i]);
  part.push_back(Place(share));
  return part;
}

int ChordCount(double turn_rad, double lever_m) {
  const double chords = std::ceil(turn_rad * std::sqrt(lever_m / (8.0 * kChordError_m)));
  return chords >= 1.0 ? static_cast<int>(std::min<double>(chords, kMostChords)) : 1;
}

ToolPath PathBetween(const Tool& tool, const Pose& X_GA, const Pose& X_GB) {
  double lever = 0.0;
  for (const ToolBall& ball : tool.balls) lever = std::max(lever, Vector3(ball.center_m).norm());
  const Eigen::Quaterniond q_A(X_GA.linear()), q_B(X_GB.linear());
  const int chords = ChordCount(q_A.angularDistance(q_B), lever);
  ToolPath path;
  for (int k = 0; k <= chords; ++k) {
    const double s = static_cast<double>(k) / chords;
    Pose X = k == 0 ? X_GA : X_GB;
    if (k > 0 && k < chords) {
      X.linear() = q_A.slerp(s, q_B).toRotationMatrix();
      X.translation() = X_GA.translation() + s * (X_GB.translation() - X_GA.translation());
    }
    path.at.push_back(PlaceTool(tool, X));
    path.s.push_back(s);
  }
  return path;
}

ToolPath RestOf(const ToolPath& path, double share, const Vector3& delta) {
  ToolPath rest{.at = {path.Place(share)}, .s = {0.0}};
  for (std::size_t i = 1; i < path.at.size(); ++i) {
    const bool last = i + 1 == path.at.size();
    if (!last && path.s[i] <= share) continue;
    const double s = last ? 1.0 : (path.s[i] - share) / (1.0 - share);
    rest.at.push_back(path.at[i]);
    for (Vector3& point : rest.at.back()) point += s * delta;
    rest.s.push_back(s);
  }
  return rest;
}

}  // namespace osteon::simulation
