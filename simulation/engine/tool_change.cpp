#include "simulation/engine/tool_change.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "simulation/removal/cut_metrics.h"

namespace osteon::simulation {

double ToolClearance(const CarvedState& state, const Tool& tool, const Pose& X_GT) {
  double clear_m = std::numeric_limits<double>::infinity();
  std::vector<Vector3> centers_G;
  centers_G.reserve(tool.balls.size());
  for (const ToolBall& t : tool.balls) centers_G.emplace_back(X_GT * Vector3(t.center_m));
  for (const Ball& ball : LiveBalls(state))
    for (std::size_t i = 0; i < tool.balls.size(); ++i)
      clear_m = std::min(
          clear_m, (centers_G[i] - Vector3(ball.center_m)).norm() - tool.balls[i].radius_m - ball.radius_m);
  return clear_m;
}

CarvedState WithoutContact(CarvedState state) {
  state.has_proxy = false;
  state.contact = {};
  return state;
}

}  // namespace osteon::simulation
