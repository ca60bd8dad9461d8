#pragma once

#include <optional>

#include "base/marker.h"
#include "control/compliance/bone_mount.h"
#include "control/compliance/compliant_link.h"
#include "control/compliance/surface_layer.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Parameters of the compliant parts of a cell. A part that is absent is rigid.
struct ComplianceParams {
  std::optional<SurfaceLayerParams> layer{};
  std::optional<ToolLinkParams> tool{};
  std::optional<BoneMountParams> mount{};
  double noticed_m{0.1e-3};  ///< a larger displacement is reported as an acting limit; > 0

  [[nodiscard]] bool any() const OSTEON_RT { return layer || tool || mount; }
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ComplianceParams& params);

/// Largest compliance in series with the coupling's spring [m/N], at a force. It bounds the energy that all
/// springs together give back (ForceLimit_N). Counts the softest layer at its first touch, and the softest
/// direction of tool and mount.
[[nodiscard]] double SeriesCompliance(const ComplianceParams& params, double force_N) OSTEON_RT;

/// The compliant parts between the rigid tool T and the resting world W: the layer and the mount move the
/// world of the bone, M; the tool's bending moves its head, E. The cutting engine and the coupling are given
/// the pose of the head in the moved world, and so never learn of compliance:
///
///     X_ME  = X_WM^-1 X_WT X_TE
///     f_T_W = R_WM f_E_M,   t_T_W = R_WM t_E_M + (p_WE - p_WT) × f_T_W
///
/// The poses follow from the states of the previous tick. Step advances the states with this tick's wrench of
/// the planes. Nothing is solved, nothing allocated.
class Compliance {
 public:
  /// @throws std::invalid_argument as Validate.
  Compliance(const ComplianceParams& params, double period_s);

  /// Sets all elements to rest, undeformed.
  void Reset() OSTEON_RT;
  /// Replaces the tool's link, at a change of tool. It begins undeformed.
  void SetTool(const std::optional<ToolLinkParams>& tool) OSTEON_RT;

  /// Pose of the bent head in the bone's world, for the pose of the rigid tool.
  [[nodiscard]] Pose X_ME(const Pose& X_WT) const OSTEON_RT;
  /// Velocity of E at Eo relative to M, in M.
  [[nodiscard]] Twist V_ME(const Pose& X_WT, const Twist& V_WT) const OSTEON_RT;
  /// A wrench on the head, on E at Eo in M, as the wrench on T at To in W.
  [[nodiscard]] Wrench OnTool(const Wrench& F_E_M, const Pose& X_WT) const OSTEON_RT;
  /// Pose of the bone's world in W.
  [[nodiscard]] Pose X_WM() const OSTEON_RT;

  /// Advances all elements by one tick.
  /// @param F_E_M  wrench of the planes on the head as rendered: after shares and limits, but without depth
  ///   limit, passivity damping and the spindle's torque
  void Step(const Wrench& F_E_M, const simulation::ContactModel& model, const Pose& X_WT) OSTEON_RT;

  /// Whether the tool's bend, the thrust on it or the mount's motion is beyond its limit: the cell must stop.
  [[nodiscard]] bool beyond_limit() const OSTEON_RT { return beyond_limit_; }
  /// Whether a displacement is larger than noticed_m.
  [[nodiscard]] bool noticed() const OSTEON_RT;
  [[nodiscard]] const Vector6& bend() const OSTEON_RT { return e_; }
  [[nodiscard]] const Vector3& layer_m() const OSTEON_RT { return q_m_; }
  [[nodiscard]] const BoneMountState& mount() const OSTEON_RT { return mount_; }
  [[nodiscard]] const ComplianceParams& params() const OSTEON_RT { return params_; }

  /// Writes the tick's record. @param X_WT  the rigid tool's pose after this tick
  void FillRecord(const Pose& X_WT, ComplianceRecord& record) const OSTEON_RT;

 private:
  ComplianceParams params_;
  double period_s_;
  Vector6 e_{Vector6::Zero()}, e_per_s_{Vector6::Zero()};      // deflection of the tool, in T
  Vector3 q_m_{Vector3::Zero()}, q_m_per_s_{Vector3::Zero()};  // shift of the layer, in M
  BoneMountState mount_;
  bool beyond_limit_{false};
};

}  // namespace osteon::control
