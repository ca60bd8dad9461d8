#include "control/sensing/tool_inertia.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_bench.h"

// Tests the compensation of the tool's inertia: the force that accelerates the tool's own mass is part of the
// sensor's reading.

namespace osteon::control {
namespace {

constexpr double kDt_s = 0.001;

// One of the four point masses of which the tool consists. The oracle of the tests is Newton's law for each
// point mass.
struct Point {
  double kg;
  Vector3 p_F_m;
};
const std::array<Point, 4> kPoints{{{0.4, {0.02, 0.0, 0.08}},
                                    {0.3, {-0.03, 0.02, 0.15}},
                                    {0.2, {0.01, -0.04, 0.20}},
                                    {0.5, {0.0, 0.01, 0.05}}}};

// A sensor with the mass, centre and inertia of the tool of four point masses.
ForceSensorParams Sensor() {
  ForceSensorParams sensor;
  Vector3 sum = Vector3::Zero();
  for (const Point& point : kPoints) {
    sensor.tool_mass_kg += point.kg;
    sum += point.kg * point.p_F_m;
  }
  const Vector3 center = sum / sensor.tool_mass_kg;
  Matrix3 I = Matrix3::Zero();
  for (const Point& point : kPoints) {
    const Vector3 r = point.p_F_m - center;
    I += point.kg * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  }
  sensor.tool_center_F_m = center;
  sensor.tool_inertia_F = I;
  return sensor;
}

TEST(ToolInertia, EqualsTheSumOfNewtonsLawOverTheToolsPoints) {
  MeasuredMotion motion;
  motion.X.linear() = ExpRotation({0.4, -0.7, 0.2});
  motion.X.translation() = Vector3(0.5, 0.1, 0.4);
  motion.V = {.v = {0.2, -0.1, 0.3}, .w = {1.0, -2.0, 0.5}};
  motion.A = {.v = {3.0, 1.0, -2.0}, .w = {8.0, 4.0, -6.0}};
  const Vector3 p_WT = motion.X * Vector3(0.0, 0.01, 0.25);
  Wrench wanted;
  for (const Point& point : kPoints) {
    const Vector3 p_W = motion.X * point.p_F_m, r = p_W - motion.X.translation();
    const Vector3 a = motion.A.v + motion.A.w.cross(r) + motion.V.w.cross(motion.V.w.cross(r));
    wanted.f += point.kg * a;
    wanted.t += (p_W - p_WT).cross(point.kg * a);
  }
  const Wrench found = InertiaWrench(Sensor(), motion, p_WT);
  EXPECT_LT((found.f - wanted.f).norm(), 1e-13 * wanted.f.norm());
  EXPECT_LT((found.t - wanted.t).norm(), 1e-13 * wanted.t.norm());
}

// The tool swings at 1 Hz with a known acceleration, far below the filters' corner frequency of 40 Hz. The
// estimate must equal the true acceleration, delayed by the filters' lag and one tick.
TEST(ToolInertia, TheEstimatedAccelerationIsTheTrueOneDelayedByTheFilters) {
  const double hz = 1.0, w = 2.0 * std::numbers::pi * hz, filter_hz = 40.0;
  const auto pose = [&](double t) {
    Pose X = Pose::Identity();
    X.translation() = Vector3(0.02 * std::sin(w * t), 0.0, 0.0);
    X.linear() = ExpRotation({0.0, 0.1 * std::sin(w * t), 0.0});
    return X;
  };
  MeasuredMotion motion{.X = pose(0.0), .V = {.v = {0.02 * w, 0.0, 0.0}, .w = {0.0, 0.1 * w, 0.0}}, .A = {}};
  const double lag_s = 2.0 / (2.0 * std::numbers::pi * filter_hz) + kDt_s;
  for (int i = 1; i < 1500; ++i) {
    const double t = i * kDt_s;
    StepMotion(pose(t), filter_hz, kDt_s, motion);
    if (t < 0.1) continue;
    const double a = -w * w * std::sin(w * (t - lag_s));
    ASSERT_NEAR(motion.A.v.x(), 0.02 * a, 0.02 * w * w * 0.01) << t;
    ASSERT_NEAR(motion.A.w.y(), 0.1 * a, 0.1 * w * w * 0.01) << t;
  }
}

TEST(ToolInertia, RefusesParametersOutOfRange) {
  ForceSensorParams sensor;
  sensor.inertia_share = 1.01;
  EXPECT_THROW(Validate(sensor), std::invalid_argument);
  sensor.inertia_share = -0.1;
  EXPECT_THROW(Validate(sensor), std::invalid_argument);
  sensor.inertia_share = 0.5;
  sensor.acceleration_hz = 0.5;
  EXPECT_THROW(Validate(sensor), std::invalid_argument);
}

// An arm moves steadily while every 20th message is lost. The messages before and after the gap are twice as
// far apart, which must not count as an acceleration.
TEST(ToolInertia, ALostMessageDoesNotCountAsAcceleration) {
  ServoParams params = ServoBench::Params();
  params.sensor = Sensor();
  params.sensor.inertia_share = 0.8;
  const kinematics::LbrArm arm = ServoBench::Arm();
  ServoLoop loop(params, arm, Pose::Identity(), ServoBench::FlangeToTool(),
                 arm.ArmAngle(ServoBench::StartJoints()));
  ArmState state;
  state.session = SessionState::kCommandingActive;
  state.period_s = kDt_s;
  ArmCommand command;
  double peak_N = 0.0;
  for (int i = 0; i < 400; ++i) {
    ++state.sequence;
    if (i > 200 && i % 20 == 0) {
      ++state.lost;
      continue;
    }
    kinematics::JointVector q = ServoBench::StartJoints();
    q[0] += 0.08 * kDt_s * i;  // about 0.05 m/s at the tool
    Eigen::Map<kinematics::JointVector>(state.q_meas.data()) = q;
    const rt::Nanoseconds now = rt::kSecond + i * rt::kMillisecond;
    state.stamp = now;
    CellReadings readings;
    readings.force = {.stamp = now, .F_S = ToolWeight(params.sensor, arm.FlangePose(q))};
    simulation::ContactModel model;
    model.frame = static_cast<std::uint64_t>(i) + 1;
    model.pose_stamp = now;
    const TickRecord record = loop.Tick(
        {.state = state, .received = ReceiveResult::kOk, .readings = readings, .model = model, .now = now},
        command);
    ASSERT_EQ(record.faults, 0u) << i;
    if (i > 200) peak_N = std::max(peak_N, Vector3(record.F_operator_T_W.f).norm());
  }
  EXPECT_LT(peak_N, 0.05) << "the turn's own, w^2 r; half a newton where two ticks' way counts as one's";
}

TEST(ToolInertia, DoesNotAllocate) {
  const ForceSensorParams sensor = Sensor();
  MeasuredMotion motion;
  rt::CheckedNoAllocScope no_alloc;
  StepMotion(Pose::Identity(), 15.0, kDt_s, motion);
  const Wrench F = InertiaWrench(sensor, motion, Vector3::Zero());
  no_alloc.End();
  EXPECT_EQ(F.f, Vector3::Zero());
}

}  // namespace
}  // namespace osteon::control
