#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// A one-sided spring of the guidance. Its units are metres and newtons, or for an angle radians and newton
/// metres.
struct GuidanceSpring {
  double stiffness{0.0};  ///< k >= 0; 0: this part of the guidance is off
  double ease{0.5e-3};    ///< s > 0: excess over which the stiffness builds up
  double cap{0.0};        ///< largest force, at least k s / 2
};

/// A funnel and a cone around the planned axis of one reamer, and its planned depth. Every field but axis,
/// centre and head has a usable default.
struct GuidanceParams {
  Vector3 axis_W{0.0, 0.0, 1.0};    ///< a, unit vector: axis of the cup, pointing out of its opening
  Vector3 centre_W{0.0, 0.0, 0.0};  ///< C: planned centre of this reamer's head [m]
  double head_m{0.0};               ///< distance of the head's centre H behind the apex To, against the feed
  double gain{1.0};                 ///< 0 … 1; 0: neither force nor stop of the spindle
  bool stops_spindle{true};         ///< the spindle stops beyond a `stop`
  double cone_free_rad{0.13962634015954636};  ///< 8°: largest angle to the axis without a torque
  double cone_stop_rad{0.17453292519943295};  ///< 10°: angle beyond which the spindle stops; >= cone_free_rad
  double lateral_free_m{1e-3};  ///< largest distance from the axis without a force, at the height h = 0
  double lateral_stop_m{3e-3};  ///< distance beyond which the spindle stops; >= lateral_free_m
  double widening_rad{0.17453292519943295};  ///< psi: half of the funnel's opening angle, 0 … 60°
  double depth_soft_m{0.0};  ///< height h of H above C below which the spring of the depth acts
  GuidanceSpring cone{.stiffness = 200.0, .ease = 0.008726646259971648, .cap = 6.0};
  GuidanceSpring lateral{.stiffness = 5e3, .ease = 0.5e-3, .cap = 40.0};
  GuidanceSpring depth{.stiffness = 10e3, .ease = 0.5e-3, .cap = 100.0};
  double return_m_per_s{0.05};      ///< speed toward the corridor at which the force is zero; > 0
  double return_rad_per_s{1.0};     ///< as return_m_per_s, for the cone's torque; > 0
  double damping_Ns_per_m{100.0};   ///< acts while the excess grows, up to a quarter of the spring's force
  double damping_Nms_per_rad{1.0};  ///< as damping_Ns_per_m, for the cone's torque
};

/// Largest accepted stiffnesses and forces: half of those at the stability boundary
/// (docs/theory/guidance.md).
inline constexpr double kMaxConeStiffness_Nm_per_rad = 400.0, kMaxConeTorque_Nm = 8.0;
inline constexpr double kMaxLateralStiffness_N_per_m = 5e3, kMaxLateralForce_N = 60.0;
inline constexpr double kMaxDepthStiffness_N_per_m = 20e3, kMaxDepthForce_N = 150.0;

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const GuidanceParams& params);

/// Distance by which the tool is outside each part of the corridor; <= 0: inside.
struct GuidanceExcess {
  double cone_rad{0.0};   ///< e_c
  double lateral_m{0.0};  ///< e_l
  double depth_m{0.0};    ///< e_d
};

/// The guidance at a pose, before it is scaled.
struct GuidanceField {
  GuidanceExcess excess;
  Wrench F_T_W;                       ///< wrench on the tool, at To, in W
  Vector3 f_spring_W{0.0, 0.0, 0.0};  ///< force of funnel and depth without damping
  double potential_J{0.0};            ///< U >= 0; 0 inside the corridor
  bool inside{true};                  ///< every excess is <= 0
  bool beyond_stop{false};            ///< the tool is beyond the stop of the cone or of the funnel
};

/// Force phi of a spring at an excess e, and the potential whose derivative it is:
///
///     phi(e) = 0 | k e^2 / 2s for 0 < e < s | min(k (e - s/2), cap)
[[nodiscard]] double SpringForce(const GuidanceSpring& spring, double excess) OSTEON_RT;
[[nodiscard]] double SpringPotential(const GuidanceSpring& spring, double excess) OSTEON_RT;

/// Evaluates the guidance at a pose of the tool. H is the head's centre, z the feed, h = a·(H - C), r the
/// part of H - C perpendicular to a, rho = |r|, r^ = r / rho, and psi the widening. The indices c, l and d
/// stand for cone, funnel (lateral) and depth:
///
///     e_c = angle(z, -a) - cone_free    e_l = (rho - lateral_free - h tan psi) cos psi    e_d = depth_soft - h
///     U   = sum of the integrals of phi(e)
///     f   = -phi_l (cos psi r^ - sin psi a) + phi_d a      t = phi_c unit(z × -a) + p_TH × f
///
/// Each phi is changed by the speed e' of its excess: it is larger while the excess grows and smaller while
/// it falls. Therefore a tool that is let go hardly moves by itself.
///
///     e' >= 0:  phi (1 + min(b e' / phi, 0.25))        e' < 0:  phi max(0, 1 + e' / v_return)
///
/// Assumes |a| = 1. The result is finite for every finite input: on the axis, where r^ and z × -a have no
/// direction, cone and funnel have no positive excess. Source: fixtures as potentials: Bowyer, Davies and
/// Rodriguez y Baena, IEEE Trans. Robotics 30(1), 2014.
[[nodiscard]] GuidanceField EvaluateGuidance(const GuidanceParams& params, const Pose& X_WT,
                                             const Twist& V_WT) OSTEON_RT;

}  // namespace osteon::control
