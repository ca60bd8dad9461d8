#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::safety {

/// Where the tool's apex may be: inside a sphere and on the keep-in side of a plane.
struct WorkspaceParams {
  Vector3 sphere_center_W_m{Vector3::Zero()};
  double sphere_radius_m{1.5};               ///< > 0
  Vector3 plane_normal_W{Vector3::UnitZ()};  ///< unit, pointing to the side to keep in
  double plane_offset_m{-1.0};               ///< keep in: normal·p >= offset
  double deceleration_m_per_s2{3.0};         ///< that a stop may count on; > 0
  double tolerance_m{1e-6};                  ///< outside by more than this is a fault; >= 0
};

/// Keeps the tool's apex in its workspace.
///
/// The speed at which the apex nears a bound is kept below BrakingSpeed of its distance, so that a stop ends
/// before it. First only the component toward each bound is reduced, so that the tool slides along; then,
/// where sphere and plane work against each other, the whole velocity is scaled. Both sets are convex: what
/// holds for a whole step holds for any share of it.
class Workspace {
 public:
  /// @throws std::invalid_argument where a value is out of range.
  explicit Workspace(const WorkspaceParams& params);

  /// Distance of the apex to the nearest bound [m]; negative outside.
  [[nodiscard]] double Distance(const Vector3& p_WT) const OSTEON_RT;
  /// True where the apex is outside by more than the tolerance, or not finite.
  [[nodiscard]] bool Violated(const Vector3& p_WT) const OSTEON_RT;

  struct Result {
    Vector3 v_WT{Vector3::Zero()};
    bool acted{false};
  };
  /// The velocity that the apex may have in the coming tick. Zero for input that is not finite.
  [[nodiscard]] Result Limit(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

 private:
  [[nodiscard]] double SphereDistance(const Vector3& p) const OSTEON_RT;
  [[nodiscard]] double PlaneDistance(const Vector3& p) const OSTEON_RT;

  WorkspaceParams params_;
};

}  // namespace osteon::safety
