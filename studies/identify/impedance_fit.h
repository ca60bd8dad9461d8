#pragma once

#include <span>
#include <string>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "studies/identify/measured_response.h"
#include "studies/identify/servo_fit.h"
#include "studies/stability/impedance_arm.h"

namespace osteon::studies {

/// The arm on which an overlay's force acted, as its file describes it, and its motion.
struct OverlaidArm {
  ImpedanceArmParams arm;
  Vector3 axis_B{Vector3::UnitZ()};  ///< direction of force and motion, unit
  double nominal_N_per_m{1.0};       ///< stiffness by which the force was divided in the response
  bool has_friction{false};          ///< whether friction is fitted as well, since the motion is not linear
  /// RMS speeds of the joints during the measurement; the damping by friction follows from them.
  kinematics::JointVectorN<7> joint_rms_rad_per_s{kinematics::JointVectorN<7>::Zero()};
};

/// An arm's own impedance, fitted with its seven joints.
struct ImpedanceFit {
  /// The impedance along the measured axis: mass x'' + damping x' + stiffness x = f(t - dead time), with all
  /// other directions free.
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, dead_time_s{};
  /// The same impedance in the terms of an arm that follows its command.
  Estimate bandwidth_hz{}, damping_ratio{}, lag_s{};

  /// The arm's own parameters, as in hil::DynamicArmParams. Cartesian impedance: stiffness along and about
  /// each direction. Joint impedance: stiffness of each joint.
  Estimate translation_N_per_m{}, rotation_Nm_per_rad{}, joint_Nm_per_rad{}, own_damping_ratio{};
  Estimate mass_ratio{};  ///< ratio of the arm's masses to those of the arm's file
  /// Ratio of the Coulomb friction that nothing compensates to each drive's torque limit.
  Estimate friction_ratio{};
  bool on_mount{false};  ///< true: the model with a compliant mount below the arm was kept

  double chi2{0.0};              ///< chi^2 divided by its degrees of freedom
  double residual{0.0};          ///< RMS of (measured - model) / measured
  Eigen::VectorXd parameters{};  ///< as FittedResponse() takes them
};

/// Fits an arm's impedance by weighted least squares, with a model of all joints: a force along one axis also
/// turns the tool, which a model of one axis lacks.
///
/// Fitted are: a ratio on the masses of the arm's file; a damping ratio; the dead time; and with Cartesian
/// impedance the stiffness of translation and rotation, with joint impedance one stiffness for all joints.
/// Friction enters as a constant damping of each joint, its mean over the joint's speeds. If chi^2 exceeds 3
/// and the cost falls threefold with a compliant mount below the arm, the mount is kept: two springs, a
/// damping ratio, mass and inertia.
/// @param lines  of x / (f / nominal stiffness)  @param start_dead_time_s  dead time at which the fit begins
/// @returns an error with fewer than 6 lines, or if no start converges
[[nodiscard]] tl::expected<ImpedanceFit, std::string> FitImpedance(std::span<const ResponseLine> lines,
                                                                   const OverlaidArm& arm, double period_s,
                                                                   double start_dead_time_s = 0.003);

/// The response x / f [m/N] of the fitted arm.
[[nodiscard]] OverlayResponse FittedResponse(const ImpedanceFit& fit, const OverlaidArm& arm,
                                             double period_s);

/// Chi^2 of the fitted arm for lines of x / (f / nominal stiffness) to which it was not fitted, divided by
/// the number of their real and imaginary parts.
[[nodiscard]] double ValidationChi2(const ImpedanceFit& fit, const OverlaidArm& arm,
                                    std::span<const ResponseLine> lines, double period_s);

/// Converts a response to x / f [m/N]. @param response  of x / (f / nominal stiffness)
[[nodiscard]] MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m);

}  // namespace osteon::studies
