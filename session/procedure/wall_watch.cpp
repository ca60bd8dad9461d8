#include "session/procedure/wall_watch.h"

#include <algorithm>

namespace osteon::session {

void WallWatch::Add(int tool, double radius_m, const Vector3& head_m) {
  if (!watches()) return;
  auto found = watches_.find(tool);
  if (found == watches_.end()) {
    // the tool's head alone, as a ball that is centred in its frame; the scene's regions are not watched
    simulation::Tool ball;
    ball.balls = {{.center_m = Vector3::Zero(), .radius_m = radius_m, .cutting = true}};
    simulation::SceneEventParams params = events_;
    params.regions.clear();
    found = watches_.try_emplace(tool, solid_, bone_, ball, params).first;
  } else if ((head_m - last_m_).norm() < kWallStep_m) {
    return;
  }
  last_m_ = head_m;
  Pose X_GP = Pose::Identity();
  X_GP.translation() = head_m;
  // pass the growing count as the removed volume, so that the watch takes each place as one where bone was
  // removed
  static_cast<void>(found->second.Step(X_GP, ++steps_, {}));
}

std::optional<double> WallWatch::min_wall_m() const {
  std::optional<double> min_m;
  for (const auto& [tool, watch] : watches_)
    if (watch.min_wall_m()) min_m = std::min(min_m.value_or(*watch.min_wall_m()), *watch.min_wall_m());
  return min_m;
}

}  // namespace osteon::session
