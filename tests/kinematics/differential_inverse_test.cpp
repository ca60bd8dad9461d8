#include "kinematics/differential_inverse.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "iiwa14.h"
#include "kinematics/lbr_arm.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::kinematics {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
constexpr double kDt_s = 0.001;

const LbrArm& Arm() {
  static const LbrArm arm{Iiwa14()};
  return arm;
}

const std::array<JointLimits, 7>& Limits() { return Arm().params().limits; }

DifferentialInverseParams<7> Params() {
  DifferentialInverseParams<7> params;
  params.limits = Limits();
  return params;
}

// The LBR with A3 fixed: an arm of six joints with a spherical wrist.
constexpr std::array<int, 6> kWithoutA3{0, 1, 3, 4, 5, 6};
DifferentialInverseParams<6> ParamsWithoutA3() {
  DifferentialInverseParams<6> params;
  for (std::size_t i = 0; i < 6; ++i) params.limits[i] = Limits()[static_cast<std::size_t>(kWithoutA3[i])];
  return params;
}
JointVectorN<7> WithA3AtZero(const JointVectorN<6>& q) {
  JointVectorN<7> all = JointVectorN<7>::Zero();
  for (int i = 0; i < 6; ++i) all[kWithoutA3[static_cast<std::size_t>(i)]] = q[i];
  return all;
}

Pose FlangePose(const JointVectorN<7>& q) { return Arm().FlangePose(q); }
Pose FlangePose(const JointVectorN<6>& q) { return Arm().FlangePose(WithA3AtZero(q)); }
JacobianN<7> Jacobian(const JointVectorN<7>& q) { return Arm().JacobianAt(q, Vector3::Zero()); }
JacobianN<6> Jacobian(const JointVectorN<6>& q) {
  const JacobianN<7> all = Arm().JacobianAt(WithA3AtZero(q), Vector3::Zero());
  JacobianN<6> J;
  for (int i = 0; i < 6; ++i) J.col(i) = all.col(kWithoutA3[static_cast<std::size_t>(i)]);
  return J;
}

Vector6 Stacked(const Twist& V) {
  Vector6 all;
  all << V.v, V.w;
  return all;
}

// An arm simulated tick by tick, with the flange as the tool.
template <int N>
struct SimulatedArm {
  explicit SimulatedArm(const DifferentialInverseParams<N>& params, const JointVectorN<N>& start)
      : inverse(params), q(start) {}

  MotionOutput<N> Tick(const Twist& V) {
    MotionInput<N> in{
        .J = Jacobian(q), .V_BT = V, .q = q, .qd_before = qd, .share_before = share, .qd_null = qd_null};
    const MotionOutput<N> out = inverse.Step(in);
    for (int i = 0; i < N; ++i) {
      const JointLimits& limit = inverse.params().limits[static_cast<std::size_t>(i)];
      peak_speed = std::max(peak_speed, std::abs(out.qd[i]) / limit.velocity_rad_per_s);
      peak_acceleration =
          std::max(peak_acceleration, std::abs(out.qd[i] - qd[i]) / kDt_s / limit.acceleration_rad_per_s2);
    }
    qd = out.qd;
    share = out.share;
    q += kDt_s * qd;
    return out;
  }

  DifferentialInverse<N> inverse;
  JointVectorN<N> q, qd{JointVectorN<N>::Zero()}, qd_null{JointVectorN<N>::Zero()};
  double share{1.0};
  double peak_speed{0.0}, peak_acceleration{0.0};  // shares of the limits
};

class DifferentialInverseTest : public ::testing::Test {
 protected:
  double Unit() { return unit_(random_); }
  Vector3 UnitVector() { return {Unit(), Unit(), Unit()}; }
  // Within 70 % of the limits, with elbow and wrist bent: far from singular directions.
  JointVectorN<7> RegularPosture() {
    while (true) {
      JointVectorN<7> q;
      for (int i = 0; i < 7; ++i) q[i] = 0.7 * Unit() * Limits()[static_cast<std::size_t>(i)].upper_rad;
      JacobianN<7> J = Jacobian(q);
      J.bottomRows<3>() *= Params().turning_length_m;
      if (J.jacobiSvd().singularValues()[5] > 1.5 * Params().singular_zone_m) return q;
    }
  }
  std::mt19937_64 random_{20261120};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

// The pose after a tick equals the previous pose moved by the twist V over the tick. The error is of third
// order in the joints' step: |qd|^3 dt^3 ~ (0.5e-3)^3 = 1e-10.
TEST_F(DifferentialInverseTest, AwayFromLimitsTheToolMovesAsWantedToThirdOrder) {
  for (int n = 0; n < 200; ++n) {
    DifferentialInverseParams<7> params = Params();
    params.acceleration_share = 1e6;
    SimulatedArm<7> simulated(params, RegularPosture());
    const Twist V{.v = 0.05 * UnitVector(), .w = 0.1 * UnitVector()};
    simulated.Tick(V);  // reaches the speed
    const Pose X = FlangePose(simulated.q);
    const MotionOutput<7> out = simulated.Tick(V);
    EXPECT_EQ(out.limit, MotionLimit::kNone);
    EXPECT_EQ(out.share, 1.0);
    EXPECT_LT((Stacked(out.V_BT) - Stacked(V)).norm(), 1e-6);
    Pose X_wanted = X;
    X_wanted.translation() += kDt_s * V.v;
    X_wanted.linear() = ExpRotation(kDt_s * V.w) * X.linear();
    EXPECT_LT((FlangePose(simulated.q).matrix() - X_wanted.matrix()).norm(), 1e-9);
  }
}

// The test compares the share of the twist with that of a search over speeds of the null motion. The search
// uses another decomposition of the Jacobian. One joint is near its limit.
TEST_F(DifferentialInverseTest, KeepsTheLargestShareOfTheTwistThatNullMotionAllows) {
  constexpr double kShort_s = 1e-7;  // so short that the curvature of the path does not matter within a tick
  DifferentialInverseParams<7> free = Params();
  free.acceleration_share = 1e12;
  const DifferentialInverse<7> inverse(free);
  int limited = 0, by_position = 0, helped = 0;
  for (int n = 0; n < 300; ++n) {
    MotionInput<7> in;
    in.q = RegularPosture();
    const int near = n % 7;
    const double room = 0.02 * (1.0 + Unit());
    in.q[near] = Limits()[static_cast<std::size_t>(near)].upper_rad - Params().position_margin_rad - room;
    in.J = Jacobian(in.q);
    in.V_BT = {.v = 0.3 * UnitVector(), .w = 0.8 * UnitVector()};
    in.dt_s = kShort_s;
    in.qd_null = 0.3 * JointVectorN<7>::NullaryExpr([this] { return Unit(); });
    JacobianN<7> J = in.J;
    J.bottomRows<3>() *= Params().turning_length_m;
    if (J.jacobiSvd().singularValues()[5] < Params().singular_zone_m) continue;

    const JointVectorN<7> task = in.J.completeOrthogonalDecomposition().solve(Stacked(in.V_BT));
    const JointVectorN<7> null = in.J.fullPivLu().kernel().col(0).normalized();
    // bounds of the joint velocities, from their definition
    double tau_s = 0.0;
    for (const JointLimits& limit : Limits())
      tau_s = std::max(tau_s, 0.9 * limit.velocity_rad_per_s / limit.acceleration_rad_per_s2);
    JointVectorN<7> low, high;
    for (int i = 0; i < 7; ++i) {
      const JointLimits& limit = Limits()[static_cast<std::size_t>(i)];
      const double up = limit.upper_rad - Params().position_margin_rad - in.q[i];
      const double down = in.q[i] - limit.lower_rad - Params().position_margin_rad;
      high[i] = std::min(0.9 * limit.velocity_rad_per_s, up / (tau_s + kShort_s));
      low[i] = -std::min(0.9 * limit.velocity_rad_per_s, down / (tau_s + kShort_s));
    }
    // largest share of the twist within the bounds at null motion r [rad/s]; -1 if there is none
    const auto largest_share = [&](double r) {
      double least = 0.0, most = 1.0;
      for (int i = 0; i < 7; ++i) {
        const double a = (low[i] - r * null[i]) / task[i], b = (high[i] - r * null[i]) / task[i];
        least = std::max(least, std::min(a, b));
        most = std::min(most, std::max(a, b));
      }
      return least <= most ? most : -1.0;
    };
    // the largest null-motion speed that may relieve a joint at its limit, from its definition
    const double r_wanted = std::clamp(null.dot(in.qd_null), -0.5, 0.5);
    double relief = 100.0;
    for (int i = 0; i < 7; ++i) {
      const double asked = std::abs(task[i]), space = task[i] > 0.0 ? high[i] : -low[i];
      if (asked > space) relief = std::min(relief, 4.0 * std::abs(null[i]) * asked / (asked - space));
    }
    relief = std::max(relief, std::abs(r_wanted));
    double best = std::max(largest_share(relief), largest_share(-relief));
    for (double r = -std::min(relief, 6.0); r <= std::min(relief, 6.0); r += 1e-3)
      best = std::max(best, largest_share(r));

    const MotionOutput<7> out = inverse.Step(in);
    EXPECT_GE(out.share, best - 1e-6) << n;
    EXPECT_LE(out.share, best + 5e-3) << n;  // 5e-3: the search's step of r, in shares of the twist
    for (int i = 0; i < 7; ++i) {
      EXPECT_GE(out.qd[i], low[i] - 1e-6);
      EXPECT_LE(out.qd[i], high[i] + 1e-6);
    }
    // the remaining twist keeps its direction
    EXPECT_LT((in.J * out.qd - out.share * Stacked(in.V_BT)).norm(), 1e-6);
    if (out.share < 1.0) ++limited;
    if (out.limit == MotionLimit::kPosition) ++by_position;
    if (out.share > largest_share(0.0) + 1e-3) ++helped;
  }
  EXPECT_GT(limited, 50);
  EXPECT_GT(by_position, 20);
  EXPECT_GT(helped, 50) << "the null space made way";
}

// A requested null motion changes the joint velocities only along the null space, and by the requested speed.
TEST_F(DifferentialInverseTest, NullMotionLeavesTheToolStillAndIsKeptWhereLimitsAllowIt) {
  for (int n = 0; n < 200; ++n) {
    MotionInput<7> in;
    in.q = RegularPosture();
    in.J = Jacobian(in.q);
    in.V_BT = {.v = 0.05 * UnitVector(), .w = 0.1 * UnitVector()};
    DifferentialInverseParams<7> params = Params();
    params.acceleration_share = 1e6;
    const DifferentialInverse<7> inverse(params);
    const MotionOutput<7> without = inverse.Step(in);
    in.qd_null = 0.1 * JointVectorN<7>::NullaryExpr([this] { return Unit(); });
    const MotionOutput<7> with = inverse.Step(in);
    if (without.share < 1.0) continue;
    EXPECT_LT((in.J * (with.qd - without.qd)).norm(), 1e-12);
    const JointVectorN<7> null = in.J.fullPivLu().kernel().col(0).normalized();
    EXPECT_NEAR(null.dot(with.qd - without.qd), null.dot(in.qd_null), 1e-12);
  }
}

// An arm of six joints has no null motion. The tool moves at 0.1 m/s in the direction in which A2 alone moves
// it, until A2 comes to its limit. The tool must keep its direction, only slow down, never turn back, and
// never pass the limit.
TEST_F(DifferentialInverseTest, ApproachToAJointLimitKeepsTheDirectionAndIsMonotone) {
  JointVectorN<6> start;
  start << 0.3, 1.6, -0.9, 0.4, 0.9, 0.2;
  SimulatedArm<6> simulated(ParamsWithoutA3(), start);
  const double bound = ParamsWithoutA3().limits[1].upper_rad - ParamsWithoutA3().position_margin_rad;
  Vector3 direction = Jacobian(start).block<3, 1>(0, 1).normalized();  // the tool's motion by A2 alone
  double last_share = 1.0, last_q = start[1];
  bool arrived = false;
  for (int i = 0; i < 6000; ++i) {
    const double speed = 0.1 * std::min(1.0, i * kDt_s / 0.1);
    direction = Jacobian(simulated.q).block<3, 1>(0, 1).normalized();
    const Twist V{.v = speed * direction, .w = Vector3::Zero()};
    const MotionOutput<6> out = simulated.Tick(V);
    ASSERT_LE(simulated.q[1], bound + 1e-12);
    if (out.limit == MotionLimit::kPosition) {
      ASSERT_EQ(out.joint, 1);
      arrived = true;
    }
    if (!arrived) continue;
    ASSERT_GE(simulated.q[1], last_q - 1e-15) << i;
    ASSERT_LE(out.share, last_share + 1e-6) << i;
    last_share = out.share;
    last_q = simulated.q[1];
    const double along = direction.dot(out.V_BT.v);
    ASSERT_LT((out.V_BT.v - along * direction).norm(), 1e-3 * along + 1e-6) << i;
  }
  ASSERT_TRUE(arrived);
  EXPECT_GT(simulated.q[1], bound - 1e-3) << "and gets there";
  EXPECT_LE(simulated.peak_speed, 0.9);
  EXPECT_LE(simulated.peak_acceleration, 1.0 + 1e-9);
}

struct ElbowPush {
  double speed_m_per_s;
  double seconds;
};

// The wrist is pushed away from the shoulder for a time, then pulled back.
class ElbowTest : public ::testing::TestWithParam<ElbowPush> {};
INSTANTIATE_TEST_SUITE_P(, ElbowTest,
                         ::testing::Values(ElbowPush{0.02, 3.0}, ElbowPush{0.1, 1.0}, ElbowPush{0.1, 10.0},
                                           ElbowPush{0.25, 1.0}));

TEST_P(ElbowTest, PushedStraightTheArmStopsSmoothlyAndReturnsAtOnce) {
  JointVectorN<7> start;
  start << 0.1, 0.7, 0.0, -0.5, 0.1, 0.7, 0.2;
  SimulatedArm<7> simulated(Params(), start);
  const double upper = Arm().params().shoulder_to_elbow_m, fore = Arm().params().elbow_to_wrist_m;
  const auto from_shoulder = [](const JointVectorN<7>& q) -> Vector3 {
    return FlangePose(q) * Vector3(0, 0, -Arm().params().wrist_to_flange_m) -
           Vector3(0, 0, Arm().params().base_to_shoulder_m);
  };
  const int out_ticks = static_cast<int>(GetParam().seconds * 1000);
  double V = 0.0;
  Vector6 last = Vector6::Zero();
  double farthest = 0.0, roughest = 0.0;  // largest reach [m], largest velocity change in a tick [m/s]
  int reversals = 0, back_after = -1;
  double last_a4 = 0.0;
  double reach_turn = 0.0;
  for (int i = 0; i < out_ticks + 1000; ++i) {
    // the requested speed reverses within 50 ms, like that of a hand
    const double goal = i < out_ticks ? GetParam().speed_m_per_s : -GetParam().speed_m_per_s;
    V += std::clamp(goal - V, -GetParam().speed_m_per_s / 50, GetParam().speed_m_per_s / 50);
    // the flange moves without rotation, along the line from the shoulder to the wrist
    const MotionOutput<7> out =
        simulated.Tick({.v = V * from_shoulder(simulated.q).normalized(), .w = Vector3::Zero()});
    ASSERT_TRUE(out.finite);
    const Vector6 now = Stacked(out.V_BT);
    roughest = std::max(roughest, (now - last).head<3>().norm());
    last = now;
    const double reach = from_shoulder(simulated.q).norm();
    farthest = std::max(farthest, reach);
    if (i == out_ticks) reach_turn = reach;
    if (i > out_ticks && back_after < 0 && reach < reach_turn - 1e-3) back_after = i - out_ticks;
    // counts chatter of A4 while the arm is pressed straight
    if (i > out_ticks - 300 && i < out_ticks && std::abs(simulated.qd[3]) > 1e-3 &&
        simulated.qd[3] * last_a4 < 0.0)
      ++reversals;
    if (std::abs(simulated.qd[3]) > 1e-3) last_a4 = simulated.qd[3];
  }
  EXPECT_LE(simulated.peak_speed, 0.9);
  EXPECT_LE(simulated.peak_acceleration, 1.0 + 1e-9);
  EXPECT_LT(farthest, upper + fore);
  if (GetParam().seconds > 1.0) {
    EXPECT_GT(farthest, upper + fore - 1e-5) << "all of the reach is used";
  }
  EXPECT_EQ(reversals, 0);
  EXPECT_LT(simulated.q[3], 0.0) << "the elbow is still on its side";
  // A4 needs some 130 ms from rest for 1 mm back, if only the joints' accelerations limit it
  EXPECT_GT(back_after, 0);
  EXPECT_LT(back_after, 400) << "however long it was pushed";
  // A4's 11.36 rad/s^2 at 0.42 m + 0.4 m of arm give at most 9.3 m/s^2, or some 9 mm/s per tick
  EXPECT_LT(roughest, 9e-3);
}

// The arm stands straight up, exactly singular and at rest: A2, A4 and A6 are zero. A pull must start a
// motion.
TEST_F(DifferentialInverseTest, AnExactlyStraightArmRestsUntilItIsPulledBack) {
  SimulatedArm<7> simulated(Params(), JointVectorN<7>::Zero());
  const double height = FlangePose(simulated.q).translation().z();
  for (int i = 0; i < 100; ++i) simulated.Tick({});
  EXPECT_TRUE(simulated.q.isZero(0.0)) << "at rest nothing moves";
  for (int i = 0; i < 2000; ++i) simulated.Tick({.v = Vector3(0, 0, -0.05), .w = Vector3::Zero()});
  EXPECT_LT(FlangePose(simulated.q).translation().z(), height - 0.03);
  EXPECT_LE(simulated.peak_speed, 0.9);
  EXPECT_LE(simulated.peak_acceleration, 1.0 + 1e-9);
}

// A6 turns through zero, past the straight (singular) wrist. The test's parameter is the smallest angle to
// the singular posture along the path [rad].
class WristTest : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(, WristTest, ::testing::Values(0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.05));

TEST_P(WristTest, TurningThroughAStraightWristKeepsJointSpeedsAndTheToolsPath) {
  JointVectorN<6> start;
  start << 0.2, 0.6, -1.2, 0.0, -0.4, 0.1;
  start[3] =
      std::asin(GetParam() / std::sin(0.4));  // A5 tilts the plane in which A6 turns: this gives the miss
  SimulatedArm<6> simulated(ParamsWithoutA3(), start);
  // A6's axis with A5 at zero: a rotation about it leads exactly through the singular posture
  JointVectorN<6> exact = start;
  exact[3] = 0.0;
  const Vector3 axis = Jacobian(exact).block<3, 1>(3, 4);
  const Pose X_start = FlangePose(start);
  double turned = 0.0, worst_tilt = 0.0;
  for (int i = 0; i < 4000 && turned < 0.8; ++i) {
    const double rate = 0.5 * std::min(1.0, i * kDt_s / 0.1);
    const Vector3 p_WF = FlangePose(simulated.q).linear().col(2) * Arm().params().wrist_to_flange_m;
    const MotionOutput<6> out = simulated.Tick({.v = rate * axis.cross(p_WF), .w = rate * axis});
    turned += kDt_s * axis.dot(out.V_BT.w);
    const Matrix3 R_error =
        ExpRotation(turned * axis) * X_start.linear() * FlangePose(simulated.q).linear().transpose();
    worst_tilt = std::max(worst_tilt, LogRotation(R_error).norm());
  }
  EXPECT_GE(turned, 0.8) << "it comes out on the other side";
  EXPECT_LE(simulated.peak_speed, 0.9);
  EXPECT_LE(simulated.peak_acceleration, 1.0 + 1e-9);
  EXPECT_LT(worst_tilt, std::min(0.03, 6.0 * GetParam() + 1e-6)) << "what is lost is of the size of the miss";
}

TEST_F(DifferentialInverseTest, GradientOfTheSmallestSingularValueEqualsDifferences) {
  const double L = Params().turning_length_m;
  const auto sigma_min = [L](const JointVectorN<7>& q) {
    JacobianN<7> J = Jacobian(q);
    J.bottomRows<3>() *= L;
    return J.jacobiSvd().singularValues()[5];
  };
  for (int n = 0; n < 100; ++n) {
    MotionInput<7> in;
    in.q = RegularPosture();
    in.J = Jacobian(in.q);
    const MotionOutput<7> out = DifferentialInverse<7>(Params()).Step(in);
    EXPECT_NEAR(out.sigma_min_m, sigma_min(in.q), 1e-14);
    for (int i = 0; i < 7; ++i) {
      // error of the central difference: h^2 times a third derivative, which grows near the next singular
      // value; some 1e-8
      constexpr double h = 1e-5;
      JointVectorN<7> more = in.q, less = in.q;
      more[i] += h;
      less[i] -= h;
      EXPECT_NEAR(out.sigma_gradient_m[i], (sigma_min(more) - sigma_min(less)) / (2 * h), 1e-6);
    }
  }
}

TEST_F(DifferentialInverseTest, TheSameInputGivesTheSameBitsAndNothingIsAllocated) {
  const DifferentialInverse<7> inverse(Params());
  MotionInput<7> in;
  in.V_BT.v = Vector3(0.1, 0.0, 0.2);
  for (int n = 0; n < 50; ++n) {
    if (n > 0) in.q = RegularPosture();  // the first pass keeps the singular posture
    in.J = Jacobian(in.q);
    const MotionOutput<7> first = inverse.Step(in);
    rt::CheckedNoAllocScope no_alloc;
    const MotionOutput<7> second = inverse.Step(in);
    no_alloc.End();
    EXPECT_EQ(std::memcmp(first.qd.data(), second.qd.data(), 7 * sizeof(double)), 0);
  }
}

TEST_F(DifferentialInverseTest, NonFiniteInputGivesNoMotion) {
  const DifferentialInverse<7> inverse(Params());
  MotionInput<7> in;
  in.q = RegularPosture();
  in.J = Jacobian(in.q);
  in.V_BT.w.y() = std::numeric_limits<double>::quiet_NaN();
  const MotionOutput<7> out = inverse.Step(in);
  EXPECT_FALSE(out.finite);
  EXPECT_TRUE(out.qd.isZero(0.0));
}

TEST_F(DifferentialInverseTest, RefusesLimitsThatAreNotSet) {
  EXPECT_THROW(DifferentialInverse<7>{DifferentialInverseParams<7>{}}, std::invalid_argument);
  DifferentialInverseParams<7> params = Params();
  params.limits[4].acceleration_rad_per_s2 = 0.0;
  try {
    const DifferentialInverse<7> inverse(params);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("A5"), std::string::npos) << error.what();
  }
  params = Params();
  params.singular_zone_m = 0.0;
  EXPECT_THROW(DifferentialInverse<7>{params}, std::invalid_argument);
}

}  // namespace
}  // namespace osteon::kinematics
