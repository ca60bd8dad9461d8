#pragma once

#include <map>
#include <optional>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/bone/scene_events.h"
#include "simulation/solids/solid.h"

namespace osteon::session {

/// Distance that a head travels between two measurements of the walls.
inline constexpr double kWallStep_m = 0.2e-3;

/// Measures the walls beside the heads of a plan's tools. The assessment of a session and the score of a
/// running session both use it.
class WallWatch {
 public:
  /// @param bone, solid  must outlive this object; solid null: walls are not watched  @param events  limits
  /// of the plan's scene
  WallWatch(const simulation::Bone& bone, const simulation::Solid* solid,
            const simulation::SceneEventParams& events)
      : bone_(bone), solid_(solid), events_(events) {}

  /// Measures the walls at a place in the bone's frame at which a tool's head has removed bone. A place
  /// within kWallStep_m of the last measured one is skipped.
  /// @param tool  index in the plan  @param radius_m, head_m  radius and centre of the head
  void Add(int tool, double radius_m, const Vector3& head_m);
  /// Thinnest wall so far [m]; nothing: no wall was seen.
  [[nodiscard]] std::optional<double> min_wall_m() const;
  /// Whether the scene has walls that are watched.
  [[nodiscard]] bool watches() const { return solid_ && events_.min_wall_m > 0.0; }

 private:
  const simulation::Bone& bone_;
  const simulation::Solid* solid_;
  const simulation::SceneEventParams events_;
  std::map<int, simulation::SceneWatch> watches_;  // by tool index
  Vector3 last_m_{Vector3::Zero()};                // place of the last measurement
  double steps_{0.0};                              // number of measurements
};

}  // namespace osteon::session
