// Model B of the design's stability page: a hand that holds an admittance-controlled arm. The closed loop's
// matrix is built by applying the shipped step to unit vectors, so that the oracle tests the code that runs.

#include <cmath>
#include <numbers>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

#include "control/admittance_law.h"

namespace osteon::control {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr int kCommandDelay = 3;  // dc, ticks
constexpr int kSensorDelay = 1;   // df, ticks

enum class Wall { kNone, kCommandedOld, kCommanded, kMeasured };

struct Case {
  const char* name;
  double k_h, b_h, m_h;  // hand
  double m_v, b_v;       // virtual tool
  double K_w;            // wall
  Wall wall;
  double rho;  // the design's table
};
void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }

// State: x_c now and before, arm position and speed, v of the virtual tool, felt forces before.
constexpr int kArm = kCommandDelay + 2;
constexpr int kSpeed = kArm + 2;
constexpr int kForce = kSpeed + 1;
constexpr int kSize = kForce + kSensorDelay;
using State = Eigen::Matrix<double, kSize, 1>;

// Exact step of the arm x'' = w^2 (u - x) - 2 w x' (15 Hz, critically damped) under a held u.
Eigen::Matrix3d ArmStep(double w) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  a << 0.0, 1.0, 0.0, -w * w, -2.0 * w, w * w, 0.0, 0.0, 0.0;
  return (a * kPeriod_s).exp();
}

State Step(const Case& c, const State& s) {
  static const double w = 2.0 * std::numbers::pi * 15.0;
  static const Eigen::Matrix3d arm_step = ArmStep(w);
  const double x_r = s[kArm], v_r = s[kArm + 1], u = s[kCommandDelay];

  // what the sensor feels of the hand now, and what it says: a sample of before
  const double a_r = w * w * (u - x_r) - 2.0 * w * v_r;
  const double felt = -(c.k_h * x_r + c.b_h * v_r + c.m_h * a_r);
  const double said = kSensorDelay == 0 ? felt : s[kForce + kSensorDelay - 1];
  double wall = 0.0;
  if (c.wall == Wall::kCommanded) wall = -c.K_w * s[0];
  if (c.wall == Wall::kCommandedOld) wall = -c.K_w * s[1];
  if (c.wall == Wall::kMeasured) wall = -c.K_w * x_r;

  // the shipped law, along z of a tool that is turned, so that the frames' changes are in the loop, too
  const Vector3 axis_W = ExpRotation({0.3, -0.4, 0.2}).col(2);
  AdmittanceParams params;
  params.mass_kg.z() = c.m_v;
  params.damping_Ns_per_m.z() = c.b_v;
  AdmittanceState state;
  state.X_WT.linear() = ExpRotation({0.3, -0.4, 0.2});
  state.X_WT.translation() = s[0] * axis_W;
  state.V_WT.v = s[kSpeed] * axis_W;
  EXPECT_TRUE(StepAdmittance(params, {.f = (said + wall) * axis_W, .t = Vector3::Zero()}, kPeriod_s, state));

  State next;
  next[0] = axis_W.dot(state.X_WT.translation());
  for (int i = 1; i < kArm; ++i) next[i] = s[i - 1];
  const Eigen::Vector3d arm = arm_step * Eigen::Vector3d(x_r, v_r, u);
  next[kArm] = arm[0];
  next[kArm + 1] = arm[1];
  next[kSpeed] = axis_W.dot(state.V_WT.v);
  for (int i = 0; i < kSensorDelay; ++i) next[kForce + i] = i == 0 ? felt : s[kForce + i - 1];
  return next;
}

double SpectralRadius(const Case& c) {
  Eigen::Matrix<double, kSize, kSize> loop;
  for (int i = 0; i < kSize; ++i) loop.col(i) = Step(c, State::Unit(i));
  return loop.eigenvalues().cwiseAbs().maxCoeff();
}

class ModelB : public testing::TestWithParam<Case> {};

TEST_P(ModelB, SpectralRadiusIsTheDesignsToItsDigits) {
  EXPECT_NEAR(SpectralRadius(GetParam()), GetParam().rho, 0.6e-7) << "seven digits are given";
}

// The same loop run in time: its growth a step, over many turns of the mode, after the others have died out.
TEST_P(ModelB, GrowthInTimeIsTheSpectralRadius) {
  const double log_rho = std::log(GetParam().rho);
  State s = State::Zero();
  s[0] = 1e-3;
  const auto run = [&](int steps) {
    double log_size = 0.0;
    for (int i = 0; i < steps; ++i) {
      s = Step(GetParam(), s);
      log_size += std::log(s.norm());
      s.normalize();
    }
    return log_size;
  };
  run(2000);
  EXPECT_NEAR(run(40'000) / 40'000.0, log_rho, 0.05 * std::abs(log_rho) + 2e-5);
}

INSTANTIATE_TEST_SUITE_P(
    Design, ModelB,
    testing::Values(Case{"firm_free", 500, 20, 1.5, 3, 20, 0, Wall::kNone, 0.9957031},
                    Case{"firm_light_tool", 500, 20, 1.5, 0.15, 20, 0, Wall::kNone, 1.0035740},
                    Case{"stiff_free", 3000, 60, 3, 3, 20, 0, Wall::kNone, 0.9953211},
                    Case{"stiff_light_tool", 3000, 60, 3, 0.4, 20, 0, Wall::kNone, 1.0097459},
                    Case{"wall_one_sample_old", 500, 20, 1.5, 3, 20, 15000, Wall::kCommandedOld, 0.9832313},
                    Case{"wall_local", 500, 20, 1.5, 3, 20, 20000, Wall::kCommanded, 0.9801308},
                    Case{"wall_on_measured_pose", 500, 20, 1.5, 3, 20, 20000, Wall::kMeasured, 1.0186615},
                    Case{"fixture", 20000, 50, 0, 3, 100, 0, Wall::kNone, 1.0149522}),
    [](const auto& test) { return test.param.name; });

// The design's maximum wall stiffness for a firm hand and b_v = 20, at the first crossing.
TEST(ModelB, LocalWallIsStableUpTo190kN) {
  Case c{"wall", 500, 20, 1.5, 3, 20, 0, Wall::kCommanded, 0};
  double low = 20e3, high = 0.0;
  for (double k = low; k < 1e6 && high == 0.0; k *= 1.05) {
    c.K_w = k;
    (SpectralRadius(c) < 1.0 ? low : high) = k;
  }
  ASSERT_GT(high, 0.0) << "a first crossing exists";
  for (int i = 0; i < 40; ++i) {
    c.K_w = 0.5 * (low + high);
    (SpectralRadius(c) < 1.0 ? low : high) = c.K_w;
  }
  EXPECT_NEAR(low, 190e3, 0.01 * 190e3);
}

}  // namespace
}  // namespace osteon::control
