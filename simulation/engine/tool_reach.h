#pragma once

#include <cstddef>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/removal/split_ball.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_path.h"

namespace osteon::simulation {

/// The balls and mass points that a tool can meet in a frame: all that lie within a sphere around the way of
/// one of its balls. What is left out changes no bit of a frame. The lists serve the frames after as well,
/// until a ball of the tool leaves its sphere.
class ToolReach {
 public:
  /// Finds what the tool can meet.
  /// @param from, to  the straight way that is asked for
  /// @param farther_m  how far beyond that way a ball of the tool may get, and its surface reach
  void Update(const Tool& tool, const ToolPoints& from, const ToolPoints& to, double farther_m,
              const std::vector<BallState>& balls, const std::vector<MassPoint>& points);
  /// Takes all balls and points as near, in this frame.
  void TakeAll(std::size_t balls, std::size_t points);
  /// Lists are made anew in the next frame: balls have grown, or have other numbers.
  void Forget() { spheres_.clear(); }

  /// Whether each ball of the tool at these places lies within its sphere.
  [[nodiscard]] bool Holds(const Tool& tool, const ToolPoints& at) const;
  /// Numbers in ascending order.
  [[nodiscard]] const std::vector<std::size_t>& balls() const { return balls_; }
  [[nodiscard]] const std::vector<std::size_t>& points() const { return points_; }

 private:
  struct Sphere {
    Vector3 centre_m;
    double radius_m;
  };
  [[nodiscard]] bool Meets(const Vector3& p_m, double radius_m) const;

  std::vector<Sphere> spheres_;  // of each ball of the tool; empty: the lists do not serve
  Sphere all_{};                 // around these
  std::vector<std::size_t> balls_, points_;
};

}  // namespace osteon::simulation
