#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "control/setup/servo_params.h"
#include "hil/arm/simulated_arm.h"
#include "kinematics/lbr_params.h"

// Measures what the handle feels like: a known wrench shakes a simulated arm under the servo loop, and the
// tool's response is measured at one frequency after another.

namespace osteon::studies {

/// The servo loop and the simulated arm that are measured.
struct HandleBenchParams {
  control::ServoParams servo;   ///< settings of drive, PLC and start path have no effect
  hil::SimulatedArmParams arm;  ///< q_start: the posture of the measurement; chain and gravity as the arm's
                                ///< level needs them
  Pose X_WB{Pose::Identity()};
  Pose X_FT{Pose::Identity()};
  double arm_angle_rad{0.0};
  int sensor_delay_ticks{1};  ///< delay from the load to the loop's reading; 0 … 100
  /// true: the sensor carries the tool of servo.sensor, with its inertia; false: it measures the hand's
  /// wrench alone
  bool sensor_feels_inertia{false};
};

/// A sinusoidal load in one of six directions: 0 … 2 a force along x, y, z of T; 3 … 5 a torque about them.
struct HandleShake {
  int axis{2};
  double frequency_hz{1.0};
  double amplitude{5.0};  ///< amplitude of the force [N] or torque [N·m]
  double bias{0.0};       ///< mean of the load
  int settle_periods{1}, periods{2};
  double min_settle_s{1.0};
};

/// A wall: a plane through the apex at the start, with normal -z of T. Every tick of the loop knows the
/// plane.
struct HandleWall {
  double stiffness_N_per_m{0.0};
};

/// The result at one frequency.
struct HandlePoint {
  double frequency_hz{0.0};
  /// The hand's wrench divided by the tool's velocity [N s/m, N·m s/rad], at angular frequency w. Expected: m
  /// i w + b in free motion with the law's mass m and drag b; K / (i w) in contact with a wall of stiffness
  /// K.
  std::complex<double> impedance;
  double travel{0.0};  ///< amplitude of the tool's motion [m, rad]
  /// Share of the motion at other frequencies, which `impedance` leaves out.
  double harmonics{0.0};
  bool fault{false};  ///< the loop stopped: the result is invalid
};

/// Shakes the handle and measures the arm's true motion (not the commanded one), by a least-squares fit of
/// bias, drift, sine and cosine over whole periods. Deterministic.
///
/// The hand exerts a given wrench and has no impedance of its own, so the result describes the cell alone.
/// @throws std::invalid_argument if a parameter is out of range.
[[nodiscard]] HandlePoint Shake(const HandleBenchParams& params, const HandleShake& shake,
                                const std::optional<HandleWall>& wall = {});

/// A sweep over frequencies. The amplitude at each frequency is such that the tool moves by at most
/// `max_travel` and at most at `max_speed`, if its impedance is the law's own, m i w + b.
struct HandleSweep {
  int axis{2};
  std::vector<double> frequencies_hz{};
  double max_travel{0.005};  ///< [m, rad]
  double max_speed{0.05};    ///< [m/s, rad/s]
  double max_wrench{20.0};   ///< [N, N·m]
};
/// Shakes the handle in free motion at each frequency. @param progress  receives the share of the sweep that
/// is done; may be empty
[[nodiscard]] std::vector<HandlePoint> SweepFree(const HandleBenchParams& params, const HandleSweep& sweep,
                                                 const std::function<void(double)>& progress = {});

/// The impedance that the law requests along an axis of T if a force acts only at To. It is m i w + b if the
/// virtual tool's centre is at To. Otherwise the tool also turns, and it is 1 / (the axis' element of (i w M
/// + D)^-1), with the law's mass matrix M and damping matrix D. The dead zone is ignored.
[[nodiscard]] std::complex<double> AskedImpedance(const control::AdmittanceParams& law, int axis,
                                                  double frequency_hz);

/// Fit of m i w + b to the impedances Z, each residual weighted by 1 / |Z|: m is a mass (or inertia), b a
/// drag.
struct HandleFit {
  double mass{0.0};      ///< [kg, kg m^2]
  double drag{0.0};      ///< [N s/m, N·m s/rad]
  double residual{0.0};  ///< RMS of |Z - fit| / |Z|
};
/// Fits the points up to max_hz; points with a fault are left out.
[[nodiscard]] HandleFit FitMassAndDrag(const std::vector<HandlePoint>& points, double max_hz);

}  // namespace osteon::studies
