#pragma once

#include <span>
#include <string>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "studies/identify/measured_response.h"
#include "studies/identify/servo_fit.h"
#include "studies/stability/impedance_arm.h"

namespace osteon::studies {

/// The arm that a force is laid over, as its file describes it, and how it was moved.
struct OverlaidArm {
  ImpedanceArmParams arm;
  Vector3 axis_B{Vector3::UnitZ()};  ///< direction of force and motion, unit
  double nominal_N_per_m{1.0};       ///< stiffness by which the forces of the response were divided
  bool has_friction{false};          ///< whether friction is fitted as well: where the motion is not linear
  /// RMS speeds of the joints during the measurement; the damping by friction follows from them.
  kinematics::JointVectorN<7> joint_rms_rad_per_s{kinematics::JointVectorN<7>::Zero()};
};

/// An arm's own impedance, fitted with its seven joints.
struct ImpedanceFit {
  /// The impedance along the measured axis: mass x'' + damping x' + stiffness x = f(t - dead time), with all
  /// other directions free.
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, dead_time_s{};
  Estimate bandwidth_hz{}, damping_ratio{}, lag_s{};  ///< the same, as an arm that follows its command

  /// The arm's own parameters, as hil::DynamicArmParams has them. Cartesian impedance: along and about each
  /// direction. Joint impedance: of all joints alike.
  Estimate translation_N_per_m{}, rotation_Nm_per_rad{}, joint_Nm_per_rad{}, own_damping_ratio{};
  Estimate mass_ratio{};      ///< ratio of the arm's masses to those of its file
  Estimate friction_ratio{};  ///< Coulomb friction that nothing compensates, to each drive's torque limit
  bool on_mount{false};       ///< the arm stands on a mount that gives way

  double chi2{0.0};              ///< divided by its degrees of freedom
  double residual{0.0};          ///< RMS of (measured - model) / measured
  Eigen::VectorXd parameters{};  ///< for FittedResponse()
};

/// Fits an arm's impedance by weighted least squares. The arm's axes are coupled: a force along one axis
/// turns the tool as well, which a model of one axis lacks. The masses are those of the arm's file, times a
/// fitted ratio. A damping ratio and the dead time are fitted as well, and with Cartesian impedance both
/// springs, with joint impedance one spring for all joints. Friction damps each joint as it does on average
/// at its speeds. If chi^2 exceeds 3 and falls threefold with a mount that gives way, the arm stands on such
/// a mount: two springs, a damping ratio, mass and inertia.
/// @param lines  of x / (f / nominal stiffness)  @param start_dead_time_s  dead time at which the fit begins
/// @returns an error with fewer than 6 lines, or if nothing converges
[[nodiscard]] tl::expected<ImpedanceFit, std::string> FitImpedance(std::span<const ResponseLine> lines,
                                                                   const OverlaidArm& arm, double period_s,
                                                                   double start_dead_time_s = 0.003);

/// The response x / f [m/N] of the fitted arm.
[[nodiscard]] OverlayResponse FittedResponse(const ImpedanceFit& fit, const OverlaidArm& arm,
                                             double period_s);

/// Chi^2 of the fitted arm against lines of x / (f / nominal stiffness) to which it was not fitted, divided
/// by their number (real and imaginary parts).
[[nodiscard]] double ValidationChi2(const ImpedanceFit& fit, const OverlaidArm& arm,
                                    std::span<const ResponseLine> lines, double period_s);

/// Converts a response to x / f [m/N]. @param response  of x / (f / nominal stiffness)
[[nodiscard]] MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m);

}  // namespace osteon::studies
