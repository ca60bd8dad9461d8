#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/removal/split_ball.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_path.h"

namespace osteon::simulation {

/// Balls or mass points of a bone, each with the tool balls that can meet it.
struct NearItems {
  std::vector<std::size_t> items;     ///< indices of the balls or points, ascending
  std::vector<std::size_t> first;     ///< index in `tool` of each item's first tool ball; then the end
  std::vector<std::uint32_t> tool{};  ///< indices of tool balls, ascending for each item

  [[nodiscard]] std::span<const std::uint32_t> ToolBallsOf(std::size_t place) const {
    return std::span(tool).subspan(first[place], first[place + 1] - first[place]);
  }
};

/// The balls and points that a tool can meet in a frame. Each tool ball has a sphere around its path;
/// balls and points that touch none of these spheres cannot change a bit of the frame's result. The lists
/// also serve later frames, until a tool ball leaves its sphere.
class ToolReach {
 public:
  /// Finds the balls and points that the tool can meet.
  /// @param from, to  ends of the tool's straight path
  /// @param farther_m  added to each sphere's radius: distance from the path up to which bone matters
  void Update(const Tool& tool, const ToolPoints& from, const ToolPoints& to, double farther_m,
              const std::vector<BallState>& balls, const std::vector<MassPoint>& points);
  /// Makes the next Update find everything anew. Call it if balls have grown or their indices have changed.
  void Forget() { spheres_.clear(); }

  /// Whether each ball of the tool, at the places `at`, lies within its sphere.
  [[nodiscard]] bool Holds(const Tool& tool, const ToolPoints& at) const;
  [[nodiscard]] const NearItems& balls() const { return balls_; }
  [[nodiscard]] const NearItems& points() const { return points_; }

 private:
  struct Sphere {
    Vector3 centre_m;
    double radius_m;
  };
  void AddNear(std::size_t item, const Vector3& p_m, double radius_m, NearItems& near) const;

  std::vector<Sphere> spheres_;  // one for each ball of the tool; empty: the lists are not valid
  Sphere enclosing_{};           // encloses all spheres_
  NearItems balls_, points_;
};

}  // namespace osteon::simulation
