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
  double noticed_m{0.1e-3};  ///< a larger displacement is reported as the acting limit kDeflection; > 0

  [[nodiscard]] bool any() const OSTEON_RT { return layer || tool || mount; }
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ComplianceParams& params);

/// Largest compliance in series with the coupling's spring [m/N], at a force. It bounds the energy that all
/// springs together can give back (ForceLimit_N). It is the sum of three compliances: of the softest
/// material's layer at a first touch, of the tool and of the mount, each in its softest direction.
[[nodiscard]] double SeriesCompliance(const ComplianceParams& params, double force_N) OSTEON_RT;

/// The compliant parts between the rigid tool's frame T and the world W. Layer and mount move the bone's
/// frame M; the tool's bending moves the frame E of its head. Cutting engine and coupling get the head's pose
/// in M, so that they need not know about compliance:
///
///     X_ME  = X_WM^-1 X_WT X_TE
///     f_T_W = R_WM f_E_M,   t_T_W = R_WM t_E_M + (p_WE - p_WT) × f_T_W
///
/// The poses use the states of the previous tick. Step advances the states with this tick's wrench of the
/// planes. No equations are solved and no memory is allocated.
class Compliance {
 public:
  /// @throws std::invalid_argument as Validate.
  Compliance(const ComplianceParams& params, double period_s);

  /// Sets all elements to rest, undeformed.
  void Reset() OSTEON_RT;
  /// Replaces the parameters of the tool's bending, at a change of tool. The new tool is undeformed at first.
  void SetTool(const std::optional<ToolLinkParams>& tool) OSTEON_RT;

  /// Pose of the bent head in the bone's frame M, for a pose of the rigid tool.
  [[nodiscard]] Pose X_ME(const Pose& X_WT) const OSTEON_RT;
  /// Velocity of E at Eo relative to M, in M.
  [[nodiscard]] Twist V_ME(const Pose& X_WT, const Twist& V_WT) const OSTEON_RT;
  /// Converts a wrench on the head (on E at Eo, in M) to the wrench on T at To, in W.
  [[nodiscard]] Wrench OnTool(const Wrench& F_E_M, const Pose& X_WT) const OSTEON_RT;
  /// Pose of the bone's frame M in W.
  [[nodiscard]] Pose X_WM() const OSTEON_RT;

  /// Advances all elements by one tick.
  /// @param F_E_M  rendered wrench of the planes on the head: after all scales and limits, but without depth
  ///   limit, passivity damping and the spindle's torque
  void Step(const Wrench& F_E_M, const simulation::ContactModel& model, const Pose& X_WT) OSTEON_RT;

  /// Whether the tool's bending, the thrust on the tool or the mount's motion is beyond its limit. The cell
  /// must then stop.
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
