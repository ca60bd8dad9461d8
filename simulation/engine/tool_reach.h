#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/removal/split_ball.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_path.h"

namespace osteon::simulation {

/// The balls and mass points that a tool can meet in a frame: all that lie within a sphere around its way.
/// What is left out changes no bit of a frame. The lists serve the frames after as well, until the tool
/// leaves the sphere.
class ToolReach {
 public:
  /// Finds what the tool can meet.
  /// @param from, to  the straight way that is asked for  @param farther_m  how far beyond that way it may
  /// get
  void Update(const Tool& tool, const ToolPoints& from, const ToolPoints& to, double farther_m,
              const std::vector<BallState>& balls, const std::vector<MassPoint>& points);
  /// Takes all balls and points as near, in this frame.
  void TakeAll(std::size_t balls, std::size_t points);
  /// Lists are made anew in the next frame: balls have grown, or have other numbers.
  void Forget() { radius_m_ = kNone; }

  /// Whether a ball of the tool at this place lies within the sphere.
  [[nodiscard]] bool Holds(const Vector3& p_m, double radius_m) const {
    return (p_m - centre_m_).norm() + radius_m <= radius_m_;
  }
  /// Numbers in ascending order.
  [[nodiscard]] const std::vector<std::size_t>& balls() const { return balls_; }
  [[nodiscard]] const std::vector<std::size_t>& points() const { return points_; }

 private:
  static constexpr double kNone = -std::numeric_limits<double>::infinity();

  Vector3 centre_m_{Vector3::Zero()};
  double radius_m_{kNone};
  std::vector<std::size_t> balls_, points_;
};

}  // namespace osteon::simulation
