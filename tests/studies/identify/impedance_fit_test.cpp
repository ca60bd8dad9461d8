#include "studies/identify/impedance_fit.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "control/excitation/multisine.h"
#include "hil/arm/dynamic_arm.h"

// Fits an arm's own impedance to its response to a wrench. The true values are known and the seeds fixed.

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;
constexpr double kPeriod_s = 1e-3, kNominal_N_per_m = 2000.0;

// The arm as in the cell's file, from which the fit starts. @param torque  true: joint impedance; false:
// Cartesian impedance
OverlaidArm ArmByFile(bool torque) {
  static const config::CellConfig cell =
      config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate_impedance.yaml");
  return {
      .arm = {.chain = cell.robot.lbr()->chain, .X_FT = cell.tool.X_FT, .q = cell.start.q, .torque = torque},
      .axis_B = Vector3::UnitX(),
      .nominal_N_per_m = kNominal_N_per_m};
}

// The true parameters; spring: N/m, or Nm/rad of each joint.
struct Truth {
  double spring{1500.0}, rotation_Nm_per_rad{150.0}, damping_ratio{0.5}, mass_ratio{1.1}, dead_time_s{3.4e-3};
  bool on_mount{false};
};

// The true arm's response from wrench to position, with relative noise.
std::vector<ResponseLine> LinesOf(const OverlaidArm& file_arm, const Truth& truth, double relative_sd) {
  ImpedanceArmParams params = file_arm.arm;
  params.arm.stiffness_N_per_m = truth.spring;
  params.arm.stiffness_Nm_per_rad_turn = truth.rotation_Nm_per_rad;
  params.arm.cartesian_damping_ratio = params.arm.joint_damping_ratio = truth.damping_ratio;
  if (params.torque) params.arm.stiffness_Nm_per_rad.setConstant(truth.spring);
  const ImpedanceArm arm = ImpedanceArmAt(params, truth.mass_ratio);
  const kinematics::JointVectorN<7> along = arm.J.topRows<3>().transpose() * file_arm.axis_B;
  const hil::FlexibleMountParams mount{.stiffness_N_per_m = 1.2e6, .mass_kg = 35.0};
  const OverlayResponse response = truth.on_mount
                                       ? OverlayResponse(OnMount(arm, params, mount, truth.mass_ratio), along,
                                                         truth.dead_time_s, kPeriod_s)
                                       : OverlayResponse(arm, along, truth.dead_time_s, kPeriod_s);
  std::mt19937_64 random(5);
  std::normal_distribution<double> unit(0.0, 1.0);
  std::vector<ResponseLine> lines;
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic);
    const Complex value = kNominal_N_per_m * response(hz);
    const double sd = relative_sd * std::abs(value);
    lines.push_back({.hz = hz, .value = value + sd * Complex(unit(random), unit(random)), .sd = sd});
  }
  return lines;
}

// Oracle: the simulated arm. Its motion after a force of one period is the impulse response, whose Fourier
// transform must equal the response.
TEST(OverlayResponse, IsTheTransformOfTheSimulatedArmsImpulseResponse) {
  for (const bool on_mount : {false, true}) {
    ImpedanceArmParams params = ArmByFile(false).arm;
    params.arm.dead_cycles = 2;
    params.arm.substeps = 40;
    if (on_mount)
      params.arm.mount = hil::FlexibleMountParams{.stiffness_N_per_m = 1.2e6, .damping_ratio = 0.1};
    const ImpedanceArm arm = ImpedanceArmAt(params);
    const Vector3 axis_B = Vector3(0.6, 0.0, 0.8);
    const kinematics::JointVectorN<7> along = arm.J.topRows<3>().transpose() * axis_B;
    const OverlayResponse response =
        on_mount ? OverlayResponse(OnMount(arm, params, *params.arm.mount), along, 2e-3, kPeriod_s)
                 : OverlayResponse(arm, along, 2e-3, kPeriod_s);
    hil::DynamicArm simulated_arm(params.arm, params.chain, params.gravity_B, params.X_FT.translation(),
                                  kPeriod_s, params.q);
    hil::ArmDrive drive;
    drive.q_cmd = params.q;
    drive.control = control::ControlMode::kCartesianImpedance;
    constexpr double kForce_N = 2.0;
    std::vector<double> moved_m;
    for (int k = 0; k < 8000; ++k) {
      moved_m.push_back(along.dot(simulated_arm.q() - params.q) / kForce_N);
      drive.F_T_B.f = k == 0 ? Vector3(kForce_N * axis_B) : Vector3(Vector3::Zero());
      simulated_arm.Step(drive, {});
    }
    for (const double hz : {1.0, 4.0, 10.0, 33.0, 60.0}) {
      Complex sum = 0.0;
      for (std::size_t k = 0; k < moved_m.size(); ++k)
        sum +=
            moved_m[k] * std::polar(1.0, -2.0 * std::numbers::pi * hz * kPeriod_s * static_cast<double>(k));
      // the simulated mount steps by backward Euler, which damps it a little more
      EXPECT_LT(std::abs(sum - response(hz)), (on_mount ? 0.02 : 2e-3) * std::abs(sum))
          << hz << ' ' << on_mount;
    }
  }
}

// Expects the estimate at the truth, within a relative error and twice its interval.
void ExpectFound(const Estimate& found, double truth, double relative) {
  EXPECT_NEAR(found.value, truth, relative * truth);
  EXPECT_NEAR(found.value, truth, 2.0 * found.half_width) << "within its interval, twice as wide";
}

TEST(Impedance, IsFittedInCartesianAndInJointSpace) {
  for (const bool torque : {false, true}) {
    const OverlaidArm file_arm = ArmByFile(torque);
    const Truth truth{.spring = torque ? 900.0 : 1500.0};
    const auto fit = FitImpedance(LinesOf(file_arm, truth, 2e-3), file_arm, kPeriod_s);
    ASSERT_TRUE(fit) << fit.error();
    EXPECT_FALSE(fit->on_mount);
    EXPECT_LT(fit->chi2, 2.0);
    ExpectFound(torque ? fit->joint_Nm_per_rad : fit->translation_N_per_m, truth.spring, 0.02);
    if (!torque) ExpectFound(fit->rotation_Nm_per_rad, truth.rotation_Nm_per_rad, 0.02);
    ExpectFound(fit->own_damping_ratio, truth.damping_ratio, 0.02);
    ExpectFound(fit->mass_ratio, truth.mass_ratio, 0.02);
    ExpectFound(fit->dead_time_s, truth.dead_time_s, 0.02);
  }
}

TEST(Impedance, IsFittedOnAFlexibleMount) {
  const OverlaidArm file_arm = ArmByFile(false);
  const Truth truth{.on_mount = true};
  const auto fit = FitImpedance(LinesOf(file_arm, truth, 2e-3), file_arm, kPeriod_s);
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_TRUE(fit->on_mount);
  EXPECT_LT(fit->chi2, 2.0);
  ExpectFound(fit->translation_N_per_m, truth.spring, 0.02);
  ExpectFound(fit->own_damping_ratio, truth.damping_ratio, 0.03);
  ExpectFound(fit->mass_ratio, truth.mass_ratio, 0.03);
  ExpectFound(fit->dead_time_s, truth.dead_time_s, 0.03);
  const std::vector<ResponseLine> other = LinesOf(file_arm, truth, 2e-3);
  EXPECT_LT(ValidationChi2(*fit, file_arm, other, kPeriod_s), 2.0);
}

TEST(Impedance, TheStiffnessAlongTheAxisIsReported) {
  const OverlaidArm file_arm = ArmByFile(false);
  const auto fit = FitImpedance(LinesOf(file_arm, {}, 1e-6), file_arm, kPeriod_s);
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_NEAR(fit->stiffness_N_per_m.value, 1500.0, 0.1) << "all other directions free";
  EXPECT_NEAR(kNominal_N_per_m * std::abs(FittedResponse(*fit, file_arm, kPeriod_s)(0.01)),
              kNominal_N_per_m / 1500.0, 1e-3);
}

TEST(Impedance, NeedsSixLines) {
  const OverlaidArm file_arm = ArmByFile(false);
  std::vector<ResponseLine> lines = LinesOf(file_arm, {}, 1e-3);
  lines.resize(5);
  const auto fit = FitImpedance(lines, file_arm, kPeriod_s);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error(), "found 5 lines, accepted 6 or more");
}

}  // namespace
}  // namespace osteon::studies
