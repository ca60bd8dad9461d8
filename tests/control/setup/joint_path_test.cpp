#include "control/setup/joint_path.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_params.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::control {
namespace {

using kinematics::JointVector;

constexpr double kDt_s = 0.001;
constexpr double kLongTick_s = 0.004;  // period of a slower arm, with which long tests run four times as fast
// Position of the tool's apex in the flange's frame.
const Vector3 kTool_F_m{0.02, -0.01, 0.18};
const std::array<kinematics::JointLimits, 7>& Limits() { return kinematics::Iiwa14().limits; }

JointPath<7> MakePath(const JointPathParams& params = {}) {
  return JointPath<7>(params, kinematics::ChainFrom(kinematics::Iiwa14()), kTool_F_m);
}

// A posture within `share` of the joints' limits.
JointVector RandomPosture(std::mt19937_64& random, double share = 1.0) {
  JointVector q;
  for (int i = 0; i < 7; ++i) {
    const kinematics::JointLimits& limits = Limits()[static_cast<std::size_t>(i)];
    q[i] = share * std::uniform_real_distribution<double>(limits.lower_rad, limits.upper_rad)(random);
  }
  return q;
}

// Largest values over a path, each as a share of its limit, and the number of ticks.
struct Peaks {
  double speed{0.0}, acceleration{0.0}, tool{0.0};
  int ticks{0};
  int stood{0};  ///< number of ticks without motion
};

// Runs a path to its end. Asserts in every tick that joints and tool keep their limits and that the joints
// stay on the straight line. Speeds and accelerations are differences of positions, and the tool's motion
// follows from the closed-form arm, so the checks do not use the path's own velocities. The tolerances allow
// for rounding, which the second difference divides by dt^2.
// @param permitted  whether the path may move in this tick
template <typename Permitted>
void Drive(JointPath<7>& path, const JointPathParams& params, const JointVector& from,
           const JointVector& goal, Permitted permitted, Peaks& peaks, double dt_s = kDt_s) {
  const kinematics::LbrArm arm(kinematics::Iiwa14());
  const JointVector line = (goal - from).normalized();
  ASSERT_TRUE(path.StartPath(from, goal));
  JointVector q = from, step_before = JointVector::Zero(), qd_before = JointVector::Zero();
  Vector3 apex = arm.FlangePose(q) * kTool_F_m, flange = arm.FlangePose(q).translation();
  double progress = 0.0;
  bool done = false;
  for (int tick = 0; !done; ++tick) {
    ASSERT_LT(tick, 400'000) << "it never ends";
    const JointPathOutput<7> out = path.Step(dt_s, permitted(tick));
    const JointVector step = out.q - q;
    for (int i = 0; i < 7; ++i) {
      const kinematics::JointLimits& limits = Limits()[static_cast<std::size_t>(i)];
      ASSERT_TRUE(out.q[i] >= limits.lower_rad && out.q[i] <= limits.upper_rad);
      const double speed = std::abs(step[i]) / dt_s / (params.speed_share * limits.velocity_rad_per_s);
      const double acceleration = std::abs(step[i] - step_before[i]) / (dt_s * dt_s) /
                                  (params.acceleration_share * limits.acceleration_rad_per_s2);
      const double change = std::abs(out.qd[i] - qd_before[i]) / dt_s /
                            (params.acceleration_share * limits.acceleration_rad_per_s2);
      ASSERT_LE(speed, 1.0 + 1e-6) << "A" << i + 1 << ", tick " << tick;
      ASSERT_LE(acceleration, 1.0 + 1e-4) << "A" << i + 1 << ", tick " << tick;
      ASSERT_LE(change, 1.0 + 1e-6) << "A" << i + 1 << ", tick " << tick;
      peaks.speed = std::max(peaks.speed, speed);
      peaks.acceleration = std::max(peaks.acceleration, acceleration);
    }
    // checks the reported velocity: the mean velocity over a tick must lie between the reported velocities at
    // both ends of the tick. It may lie outside by dt^2 times the jerk (1e3 rad/s^3), if the maximum is
    // within the tick
    const double mean = line.dot(step) / dt_s, ends = line.dot(out.qd + qd_before) / 2.0;
    ASSERT_LE(std::abs(mean - ends), std::abs(line.dot(out.qd - qd_before)) / 2.0 + 1e3 * dt_s * dt_s)
        << "tick " << tick;
    ASSERT_LT(((out.q - from) - line * line.dot(out.q - from)).norm(), 1e-12) << "off the line";
    const Pose X_BF = arm.FlangePose(out.q);
    const double tool = std::max((X_BF * kTool_F_m - apex).norm(), (X_BF.translation() - flange).norm());
    ASSERT_LE(tool / dt_s, params.tool_speed_m_per_s * (1.0 + 1e-6)) << "tick " << tick;
    peaks.tool = std::max(peaks.tool, tool / dt_s / params.tool_speed_m_per_s);
    ASSERT_GE(out.progress, progress);
    ASSERT_LE(out.progress, 1.0);
    if (step.isZero(0.0)) ++peaks.stood;

    q = out.q;
    apex = X_BF * kTool_F_m;
    flange = X_BF.translation();
    step_before = step;
    qd_before = out.qd;
    progress = out.progress;
    done = out.done;
    ++peaks.ticks;
  }
  ASSERT_EQ(q, goal) << "to the bit";
  ASSERT_EQ(progress, 1.0);
  ASSERT_TRUE(qd_before.isZero(0.0));
}

TEST(JointPath, AThousandRandomPathsKeepEveryLimitAndTheLine) {
  std::mt19937_64 random(21);
  const JointPathParams params{.speed_share = 0.3, .acceleration_share = 0.5, .tool_speed_m_per_s = 0.25};
  JointPath<7> path = MakePath(params);
  double min_peak = 1.0;
  for (int pair = 0; pair < 1000; ++pair) {
    // path lengths from a thousandth of the range to the whole range
    const JointVector from = RandomPosture(random);
    const JointVector goal = from + std::pow(10.0, -(pair % 4)) * (RandomPosture(random) - from);
    Peaks peaks;
    Drive(
        path, params, from, goal, [](int) { return true; }, peaks, kLongTick_s);
    if (HasFatalFailure()) FAIL() << "pair " << pair;
    EXPECT_LE(peaks.ticks * kLongTick_s, path.duration_s() + params.pause_s / 3.0 + 2 * kLongTick_s);
    // a short path ends before the clock reaches its full rate, so it is not counted
    if (path.duration_s() > 5.0) min_peak = std::min(min_peak, std::max(peaks.speed, peaks.tool));
  }
  EXPECT_GT(min_peak, 0.75)
      << "it dawdles: what is added for sampling is a fifth where all joints cross their range";
}

TEST(JointPath, PathsPausedAtRandomTimesKeepEveryLimitAndTheLine) {
  std::mt19937_64 random(22);
  for (const double pause_s : {0.1, 0.5}) {
    JointPathParams params{.tool_speed_m_per_s = 0.25, .pause_s = pause_s};
    params.speed_share = 1.0;
    JointPath<7> path = MakePath(params);
    for (int pair = 0; pair < 40; ++pair) {
      const JointVector from = RandomPosture(random), goal = from + 0.3 * (RandomPosture(random) - from);
      bool held = true;
      // mean number of ticks between changes of the permission: some during a change of the clock's rate,
      // others long after it
      const int mean_ticks = pair % 2 == 0 ? 60 : 700;
      Peaks peaks;
      Drive(
          path, params, from, goal,
          [&](int) {
            if (random() % static_cast<unsigned>(mean_ticks) == 0) held = !held;
            return held;
          },
          peaks);
      if (HasFatalFailure()) FAIL() << "pair " << pair;
    }
  }
}

// On a short path, the limits on acceleration are the tightest. A pause adds to the accelerations, wherever
// on the path it begins.
TEST(JointPath, AShortPathPausedAtAnyPlaceKeepsTheAccelerationLimits) {
  const JointPathParams params{.speed_share = 1.0, .acceleration_share = 0.3};
  JointPath<7> path = MakePath(params);
  JointVector from = JointVector::Zero(), goal = JointVector::Zero();
  goal[6] = 0.2;
  for (int at = 0; at < 900; at += 5) {
    Peaks peaks;
    Drive(
        path, params, from, goal, [&](int tick) { return tick < at || tick > at + 800; }, peaks);
    if (HasFatalFailure()) FAIL() << "released at tick " << at;
  }
}

TEST(JointPath, ComesToRestWithinThePauseAndContinuesFromThere) {
  std::mt19937_64 random(23);
  const JointPathParams params;
  JointPath<7> path = MakePath(params);
  const JointVector from = RandomPosture(random), goal = RandomPosture(random);
  ASSERT_TRUE(path.StartPath(from, goal));
  EXPECT_EQ(path.Step(kDt_s, false).q, from) << "it waits for the switch";
  JointPathOutput<7> out;
  for (int i = 0; i < 3000; ++i) out = path.Step(kDt_s, true);
  ASSERT_FALSE(out.done);
  for (int i = 0; i < 500; ++i) out = path.Step(kDt_s, false);
  EXPECT_EQ(out.rate, 0.0);
  EXPECT_TRUE(out.qd.isZero(0.0));
  const JointVector q_rest = out.q;
  for (int i = 0; i < 10'000; ++i) {
    out = path.Step(kDt_s, false);
    ASSERT_EQ(out.q, q_rest);
  }
  EXPECT_FALSE(out.done);
  for (int i = 0; i < 100; ++i) out = path.Step(kDt_s, true);
  EXPECT_GT(out.progress, 0.0);
  EXPECT_NE(out.q, q_rest);
}

TEST(JointPath, APathOfNoLengthIsDoneAtOnce) {
  JointPath<7> path = MakePath();
  const JointVector q = JointVector::Constant(0.3);
  ASSERT_TRUE(path.StartPath(q, q));
  EXPECT_EQ(path.duration_s(), 0.0);
  const JointPathOutput<7> out = path.Step(kDt_s, false);
  EXPECT_TRUE(out.done);
  EXPECT_EQ(out.q, q);
}

TEST(JointPath, RefusesEndsBeyondTheJointLimits) {
  JointPath<7> path = MakePath();
  const JointVector q = JointVector::Constant(0.3);
  ASSERT_TRUE(path.StartPath(q, -q));
  const double duration_s = path.duration_s();
  JointVector beyond = q, none = q;
  beyond[3] = Limits()[3].upper_rad + 1e-9;
  none[6] = std::numeric_limits<double>::quiet_NaN();
  for (const JointVector& bad : {beyond, none}) {
    EXPECT_FALSE(path.StartPath(q, bad));
    EXPECT_FALSE(path.StartPath(bad, q));
  }
  EXPECT_EQ(path.duration_s(), duration_s);
  EXPECT_EQ(path.q_goal(), -q) << "and the path before goes on";
}

TEST(JointPath, RefusesParametersOutOfRange) {
  EXPECT_THROW(MakePath({.speed_share = 0.0}), std::invalid_argument);
  EXPECT_THROW(MakePath({.acceleration_share = 1.1}), std::invalid_argument);
  EXPECT_THROW(MakePath({.tool_speed_m_per_s = 0.3}), std::invalid_argument) << "beyond reduced speed";
  EXPECT_THROW(MakePath({.pause_s = std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
  kinematics::ChainParams<7> chain = kinematics::ChainFrom(kinematics::Iiwa14());
  chain.joints[2].limits.acceleration_rad_per_s2 = 0.0;
  EXPECT_THROW(JointPath<7>({}, chain, kTool_F_m), std::invalid_argument);
}

TEST(JointPath, AlsoMovesAnArmOfSixJoints) {
  kinematics::OrthoParallelParams params = kinematics::Kr6R900Params();
  for (kinematics::JointLimits& limits : params.limits) limits.acceleration_rad_per_s2 = 10.0;
  const kinematics::ChainParams<6> chain = kinematics::ChainFrom(params);
  JointPath<6> path({}, chain, kTool_F_m);
  const kinematics::SerialChain<6> arm(chain);
  kinematics::JointVectorN<6> from, goal;
  from << 0.5, -1.0, 1.2, 0.1, 0.6, 0.0;
  goal << -0.4, -1.5, 1.0, 1.0, -0.6, 2.0;
  ASSERT_TRUE(path.StartPath(from, goal));
  Vector3 apex = arm.FlangePose(from) * kTool_F_m;
  JointPathOutput<6> out;
  int ticks = 0;
  for (; !out.done && ticks < 100'000; ++ticks) {
    out = path.Step(kDt_s, true);
    const Vector3 p = arm.FlangePose(out.q) * kTool_F_m;
    ASSERT_LE((p - apex).norm() / kDt_s, 0.2 * (1.0 + 1e-6));
    apex = p;
  }
  EXPECT_EQ(out.q, goal);
}

TEST(JointPath, SameInputsGiveTheSameBits) {
  std::mt19937_64 random(24);
  const JointVector from = RandomPosture(random), goal = RandomPosture(random);
  JointPath<7> first = MakePath(), second = MakePath();
  ASSERT_TRUE(second.StartPath(goal, from)) << "what it did before makes no difference";
  for (int i = 0; i < 500; ++i) static_cast<void>(second.Step(kDt_s, true));
  ASSERT_TRUE(first.StartPath(from, goal) && second.StartPath(from, goal));
  for (int i = 0; i < 20'000; ++i) {
    const bool held = i % 1700 > 300;
    const JointPathOutput<7> a = first.Step(kDt_s, held), b = second.Step(kDt_s, held);
    ASSERT_EQ(std::memcmp(a.q.data(), b.q.data(), sizeof(a.q)), 0);
    ASSERT_EQ(std::memcmp(a.qd.data(), b.qd.data(), sizeof(a.qd)), 0);
  }
}

TEST(JointPath, DoesNotAllocate) {
  JointPath<7> path = MakePath();
  const JointVector q = JointVector::Constant(0.3);
  rt::CheckedNoAllocScope no_alloc;
  const bool begun = path.StartPath(q, -q);
  const JointPathOutput<7> out = path.Step(kDt_s, true);
  no_alloc.End();
  EXPECT_TRUE(begun);
  EXPECT_FALSE(out.done);
}

}  // namespace
}  // namespace osteon::control
