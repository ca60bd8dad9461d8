#pragma once

#include <limits>

#include "base/marker.h"
#include "kinematics/spatial.h"
#include "safety/zone.h"

namespace osteon::safety {

/// How deep the reamer may go.
struct DepthLimitParams {
  bool acts{false};
  ZoneParams bound{};   ///< set in which the tool's apex is kept; ZoneParams::point and side are ignored
  double soft_m{5e-3};  ///< distance before the bound at which the resistance begins; > 0
  double spindle_stop_m{1e-3};     ///< distance before the bound at which the spindle stops; 0 … soft_m
  double stiffness_N_per_m{20e3};  ///< stiffness of the resistance; > 0
  double damping_Ns_per_m{100.0};  ///< damping while the apex moves toward the bound; its force is at most a
                                   ///< quarter of the spring's; >= 0
  /// true: the bound moves with the bone on its compliant mount. Step then needs position and velocity
  /// relative to the bone, and the bound is not added to the workspace, whose zones are fixed in the world.
  bool rides_on_bone{false};
};

/// Checks the parameters. @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const DepthLimitParams& params);

/// A haptic boundary in three steps, by the distance d of the tool's apex from its bound:
///
///     d < soft            resistance      f = k (soft - d) + b v,  pushes away from the bound
///     d < spindle_stop    spindle off     the spindle stays off until the tool is back at d >= soft
///     d = 0               no further      the bound is a zone of the apex (Workspace)
///
/// with stiffness k, damping b and the speed v toward the bound (b v is 0 while the apex moves away). The
/// spring depends on position alone, so it generates no energy. The resistance is added to the bone's force,
/// and the cell's force limit applies to their sum.
class DepthLimit {
 public:
  /// @throws std::invalid_argument, as Validate. If the limit is off, the parameters are not checked.
  explicit DepthLimit(const DepthLimitParams& params);

  /// Computes one tick. @returns the force on the tool at its apex, in W [N]; zero if the limit is off.
  /// @param stiffness_N_per_m  upper bound of the resistance's stiffness: the coupling's present stiffness
  Vector3 Step(const Vector3& p_WT, const Vector3& v_WT,
               double stiffness_N_per_m = std::numeric_limits<double>::infinity()) OSTEON_RT;
  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] bool acts() const OSTEON_RT { return params_.acts; }
  /// Distance of the apex from the bound in the last tick [m]; infinite before the first tick, and if the
  /// limit is off.
  [[nodiscard]] double distance_m() const OSTEON_RT { return distance_m_; }
  [[nodiscard]] bool resists() const OSTEON_RT { return distance_m_ < params_.soft_m; }
  [[nodiscard]] bool stops_spindle() const OSTEON_RT { return retract_; }
  [[nodiscard]] bool rides_on_bone() const OSTEON_RT { return params_.rides_on_bone; }

 private:
  DepthLimitParams params_;
  double distance_m_;
  bool retract_{false};  // the spindle is off until the tool has been retracted to soft_m
};

/// The bound as a zone of the workspace.
[[nodiscard]] ZoneParams ZoneOf(const DepthLimitParams& params);

}  // namespace osteon::safety
