#include "hil/operator/hand_grid.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

// Tests the grid of hands with which a cell must be stable.

namespace osteon::hil {
namespace {

// Control period; mass and damping of the virtual tool in the shipped cells.
constexpr double kDt_s = 1e-3, kToolMass_kg = 3.0, kToolDamping_Ns_per_m = 20.0;

TEST(HandGrid, CoversTheHumanArmAndStifferClamps) {
  const std::vector<GridHand> grid = HandGrid();
  std::set<std::string> names;
  int human = 0;
  for (const GridHand& hand : grid) {
    names.insert(hand.name);
    human += hand.stiffness_N_per_m <= 10000.0;
    EXPECT_NO_THROW((void)OperatorHand(OperatorWith(hand), HandScript({}, 0.025, 0.0, 2.0, {}, {})));
  }
  EXPECT_EQ(names.size(), grid.size()) << "a name twice";
  EXPECT_EQ(human, 5 * 3 * 3 + 3);
  const auto has = [&](double k, double b, double m) {
    return std::any_of(grid.begin(), grid.end(), [&](const GridHand& hand) {
      return hand.stiffness_N_per_m == k && hand.damping_Ns_per_m == b && hand.mass_kg == m;
    });
  };
  for (const double k : {50.0, 10000.0})
    for (const double b : {2.0, 80.0})
      for (const double m : {0.3, 4.0}) EXPECT_TRUE(has(k, b, m)) << k << " " << b << " " << m;
  EXPECT_TRUE(has(135.0, 6.45, 0.554));
  EXPECT_TRUE(has(50000.0, 50.0, 0.0));
}

TEST(HandGrid, OperatorKeepsParametersThatTheGridDoesNotSet) {
  const OperatorHandParams hand =
      OperatorWith({"h", 3000.0, 60.0, 3.0}, {.stiffness_N_per_m = 1.0, .tremor_N = 2.0, .tremor_seed = 7});
  EXPECT_EQ(hand.stiffness_N_per_m, 3000.0);
  EXPECT_EQ(hand.mass_kg, 3.0);
  EXPECT_EQ(hand.tremor_N, 2.0);
  EXPECT_EQ(hand.tremor_seed, 7u);
  EXPECT_NEAR(hand.stiffness_Nm_per_rad, 30.0, 1e-12);
}

// State one millisecond after the state s, for the shipped hand on a free virtual tool with M v' + D v = f
// (damping implicit). The state consists of the tool's position and speed along x, and of the speed of the
// hand's mass.
Eigen::Vector3d NextState(const OperatorHandParams& params, const Eigen::Vector3d& s) {
  HandImpedance hand(params);
  hand.Reset();
  // sets the speed of the hand's mass: a mass at rest that is dragged at the speed v has the speed share · v
  // after a period
  const double share = kDt_s / (params.grip_time_s + kDt_s);
  (void)hand.StepMass(kDt_s, {.v = {s[2] / share, 0, 0}}, 1.0);
  Pose X = Pose::Identity();
  X.translation().x() = s[0];
  const double f = hand.Step(kDt_s, X, {.v = {s[1], 0, 0}}, Pose::Identity(), {}).f.x();
  const double v = (s[1] + kDt_s / kToolMass_kg * f) / (1.0 + kDt_s * kToolDamping_Ns_per_m / kToolMass_kg);
  // reads the speed of the mass: with the handle at rest, the mass gives the same share of its momentum to
  // the handle within a period
  const double given_Ns = -kDt_s * hand.StepMass(kDt_s, {}, 1.0).f.x();
  return {s[0] + kDt_s * v, v, params.mass_kg > 0.0 ? given_Ns / params.mass_kg / share : 0.0};
}

// The logarithm of the largest growth in a period must be negative. It must equal the period times the real
// part of the slowest pole of the continuous model.
TEST(HandGrid, EveryHandIsStableOnTheFreeToolAtAPeriodOfOneMillisecond) {
  for (const GridHand& hand : HandGrid()) {
    const OperatorHandParams params = OperatorWith(hand);
    Eigen::Matrix3d A;  // matrix of the linear system for one period, computed column by column
    for (int i = 0; i < 3; ++i) A.col(i) = NextState(params, Eigen::Vector3d::Unit(i));
    const double growth = std::log(A.eigenvalues().cwiseAbs().maxCoeff());
    EXPECT_LT(growth, 0.0) << hand.name;

    const double tau_s = params.grip_time_s + 0.5 * kDt_s;  // backward Euler adds a lag of half a period
    const double drag =
        hand.mass_kg / tau_s;  // constant of the damper between the hand's mass and the handle
    Eigen::Matrix3d C;         // matrix of the continuous model: derivative of the same state
    C << 0.0, 1.0, 0.0,        //
        -hand.stiffness_N_per_m, -hand.damping_Ns_per_m - kToolDamping_Ns_per_m - drag, drag,  //
        0.0, 1.0 / tau_s, -1.0 / tau_s;
    C.row(1) /= kToolMass_kg;
    const double expected = kDt_s * C.eigenvalues().real().maxCoeff();
    // the hand's damping is integrated by explicit Euler. The relative error is half of rate times period,
    // here at most 7 %
    EXPECT_NEAR(growth, expected, 0.07 * std::abs(expected) + 2e-5) << hand.name;
  }
}

}  // namespace
}  // namespace osteon::hil
