#include "studies/transparency/handle_bench.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "kinematics/lbr_arm.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;

constexpr double kTick_s = 0.001;
// The cell's lag at low frequencies [s]: 2 z / w of the arm, its dead time, a tick of the sensor, and half a
// tick of sampling.
constexpr double kLag_s = 2.0 / (2.0 * std::numbers::pi * 15.0) + 0.003 + 0.001 + 0.0005;

// A bench with the scenarios' arm, in a posture away from limits and singularities.
HandleBenchParams BenchParams(hil::ArmLevel level) {
  HandleBenchParams params;
  params.arm.level = level;
  params.arm.lbr = ScenarioArm();
  params.X_FT = ScenarioTool();
  params.arm.p_FT_m = params.X_FT.translation();
  params.arm.q_start << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  params.arm_angle_rad = kinematics::LbrArm(params.arm.lbr).ArmAngle(params.arm.q_start);
  params.servo.joints.limits = params.arm.lbr.limits;
  params.servo.workspace.sphere_radius_m = 3.0;
  params.servo.workspace.plane_offset_m = -3.0;
  params.servo.max_tracking_error_m = 0.1;
  params.servo.spindle_rad_per_s = 0.0;
  return params;
}

// Oracle: the law's response from force to position by its z-transform, v+ = (v + (T/m) F) / (1 + (T/m) b),
// x+ = x + T v+. The force F is `delay` ticks old, and a kinematic arm follows one tick later. m, b: mass and
// drag of the virtual tool; T: the tick.
Complex LawTravel(double m, double b, int delay, double hz) {
  const Complex z = std::exp(Complex(0.0, 2.0 * std::numbers::pi * hz * kTick_s));
  const Complex v = (kTick_s / m) / ((1.0 + kTick_s / m * b) - 1.0 / z);
  const Complex x = kTick_s * v / (1.0 - 1.0 / z);
  return x * std::pow(z, -delay - 1);
}

// Impedance (force per speed) of a response from force to position.
Complex ImpedanceOf(const Complex& travel_per_force, double hz) {
  return 1.0 / (Complex(0.0, 2.0 * std::numbers::pi * hz) * travel_per_force);
}

// Oracle: the response of the servo w^2 / (s^2 + 2 z w s + w^2) under a held command, integrated in Euler
// steps of 50 ns, independently of the arm's closed form.
Complex ServoLag(double bandwidth_hz, double damping, int dead, double hz) {
  const double w = 2.0 * std::numbers::pi * bandwidth_hz;
  Eigen::Matrix2d A;
  A << 0.0, 1.0, -w * w, -2.0 * damping * w;
  Eigen::Matrix2d transition = Eigen::Matrix2d::Identity();
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) transition += A * (kTick_s / kSteps) * transition;
  const Eigen::Vector2d input = Eigen::Vector2d(1.0, 0.0) - transition.col(0);  // at rest, position = command
  const Complex z = std::exp(Complex(0.0, 2.0 * std::numbers::pi * hz * kTick_s));
  const Eigen::Matrix2cd system = z * Eigen::Matrix2cd::Identity() - transition.cast<Complex>();
  const Eigen::Vector2cd answer = system.inverse() * input.cast<Complex>();
  return answer[0] * z * std::pow(z, -dead);  // z: LawTravel already has the kinematic arm's tick
}

TEST(HandleBench, AnArmWithoutLagFeelsLikeTheLaw) {
  const HandleBenchParams params = BenchParams(hil::ArmLevel::kKinematic);
  for (const double hz : {0.1, 1.0, 10.0, 30.0}) {
    const std::vector<HandlePoint> points = SweepFree(params, {.axis = 2, .frequencies_hz = {hz}});
    const Complex expected = ImpedanceOf(LawTravel(3.0, 20.0, 1, hz), hz);
    EXPECT_FALSE(points[0].fault);
    // a path that is straight in the joints is slightly curved at the tool: about 1e-3 at 5 mm
    EXPECT_NEAR(std::abs(points[0].impedance / expected - 1.0), 0.0, 5e-3) << hz;
  }
}

TEST(HandleBench, TheArmsLagIsFeltAsMassThatGrowsWithTheDrag) {
  for (const double drag : {20.0, 150.0}) {
    HandleBenchParams params = BenchParams(hil::ArmLevel::kServo);
    params.servo.admittance.damping_Ns_per_m.setConstant(drag);
    for (const double hz : {0.1, 1.0, 5.0}) {
      const std::vector<HandlePoint> points = SweepFree(params, {.axis = 0, .frequencies_hz = {hz}});
      const Complex expected = ImpedanceOf(LawTravel(3.0, drag, 1, hz) * ServoLag(15.0, 1.0, 3, hz), hz);
      EXPECT_NEAR(std::abs(points[0].impedance / expected - 1.0), 0.0, 0.01) << drag << " at " << hz;
    }
    // below its corner frequency, the arm's response G with the lag tau is 1 / G = 1 + tau s. The felt mass
    // is then m + b tau, the felt drag b - m w^2 tau
    const HandleFit fit = FitMassAndDrag(SweepFree(params, {.axis = 0, .frequencies_hz = {0.1, 0.2}}), 2.0);
    EXPECT_NEAR(fit.mass, 3.0 + drag * kLag_s, 0.1 * drag * kLag_s) << drag;
    EXPECT_NEAR(fit.drag, drag, 0.02 * drag);
  }
}

TEST(HandleBench, RotationIsMeasuredAsWell) {
  const HandleBenchParams params = BenchParams(hil::ArmLevel::kKinematic);
  const std::vector<HandlePoint> points = SweepFree(
      params, {.axis = 4, .frequencies_hz = {1.0}, .max_travel = 0.02, .max_speed = 0.3, .max_wrench = 2.0});
  const Complex expected = ImpedanceOf(LawTravel(0.15, 1.5, 1, 1.0), 1.0);
  EXPECT_NEAR(std::abs(points[0].impedance / expected - 1.0), 0.0, 0.01);
}

TEST(HandleBench, AWallIsFeltWithItsOwnStiffness) {
  const HandleBenchParams params = BenchParams(hil::ArmLevel::kServo);
  const HandlePoint point =
      Shake(params, {.axis = 2, .frequency_hz = 0.2, .amplitude = 5.0, .bias = 30.0}, HandleWall{20e3});
  const double w = 2.0 * std::numbers::pi * 0.2;
  const Complex stiffness = point.impedance * Complex(0.0, w);
  EXPECT_NEAR(stiffness.real(), 20e3, 0.01 * 20e3);
  // the arm's lag adds damping to the damping of law and coupling
  EXPECT_NEAR(stiffness.imag(), w * (20.0 + 100.0 + 20e3 * kLag_s), 0.1 * w * 20e3 * kLag_s);
}

TEST(HandleBench, AFitGivesBackMassAndDrag) {
  std::vector<HandlePoint> points;
  for (const double hz : {0.1, 0.3, 1.0, 3.0, 20.0})
    points.push_back({.frequency_hz = hz, .impedance = {17.0, 2.0 * std::numbers::pi * hz * 4.0}});
  points.back().impedance = 1e6;  // this point is beyond max_hz, so the fit must ignore it
  const HandleFit fit = FitMassAndDrag(points, 5.0);
  EXPECT_NEAR(fit.mass, 4.0, 1e-12);
  EXPECT_NEAR(fit.drag, 17.0, 1e-12);
  EXPECT_LT(fit.residual, 1e-12);
}

TEST(HandleBench, RefusesAxesFrequenciesAndAmplitudesOutOfRange) {
  const HandleBenchParams params = BenchParams(hil::ArmLevel::kKinematic);
  EXPECT_THROW(static_cast<void>(Shake(params, {.axis = 6})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Shake(params, {.frequency_hz = 600.0})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Shake(params, {.amplitude = 0.0})), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::studies
