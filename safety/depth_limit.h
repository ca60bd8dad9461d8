#pragma once

#include <limits>

#include "base/marker.h"
#include "kinematics/spatial.h"
#include "safety/zone.h"

namespace osteon::safety {

/// How deep the reamer may go.
struct DepthLimitParams {
  bool acts{false};
  ZoneParams bound{};              ///< keeps the tool's apex in; ZoneParams::point and side are ignored
  double soft_m{5e-3};             ///< distance before the bound at which the resistance begins; > 0
  double spindle_stop_m{1e-3};     ///< distance before the bound at which the spindle stops; 0 … soft_m
  double stiffness_N_per_m{20e3};  ///< of the resistance; > 0
  double damping_Ns_per_m{100.0};  ///< on the way in, limited to a quarter of the spring's force; >= 0
  /// The bound is fixed to the bone, which may give way: p and v of Step are those of the head in the bone's
  /// world. The bound is then no zone of the workspace, which rests.
  bool rides_on_bone{false};
};

/// @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const DepthLimitParams& params);

/// A haptic boundary in three steps, by the distance d of the tool's apex from its bound:
///
///     d < soft            resistance      f = k (soft - d) + b v,  away from the bound, never pulling
///     d < spindle_stop    spindle off     until the tool is back at d >= soft: it can only be retracted
///     d = 0               no further      the bound is a zone of the apex (Workspace)
///
/// The resistance is a spring that depends on position alone and so generates no energy. It adds to the
/// bone's force, and the cell's force limit applies to their sum.
class DepthLimit {
 public:
  /// @throws std::invalid_argument as Validate; while the limit is off nothing is checked.
  explicit DepthLimit(const DepthLimitParams& params);

  /// One tick. @returns the force on the tool at its apex, in W [N]; zero while inactive.
  /// @param stiffness_N_per_m  upper bound: the coupling's stiffness, if it was made softer
  Vector3 Step(const Vector3& p_WT, const Vector3& v_WT,
               double stiffness_N_per_m = std::numeric_limits<double>::infinity()) OSTEON_RT;
  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] bool acts() const OSTEON_RT { return params_.acts; }
  /// Distance of the last tick [m]; infinite before the first, and while the limit is off.
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
