// Tests the requirement that, for any input, no coupling wrench above the limit is integrated or sent.

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "safety/limits.h"
#include "servo_bench.h"

namespace osteon::control {
namespace {

// Random inputs: plausible inputs as from a bone, and wrong inputs as from a broken or hostile sender.
class Adversary {
 public:
  explicit Adversary(std::uint64_t seed) : random_(seed) {}

  // A uniform random number from -1 to 1.
  double Unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  std::uint64_t Bits() { return random_(); }
  bool Chance(double p) { return Unit() * 0.5 + 0.5 < p; }
  // A value that careless arithmetic does not handle: not finite, huge, tiny or negative.
  double Hostile() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    const double values[] = {0.0,
                             -0.0,
                             1e-320,
                             1e300,
                             -1e300,
                             kInf,
                             -kInf,
                             std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::max(),
                             1e7,
                             -1.0};
    return values[Bits() % std::size(values)];
  }
  Vector3 Direction() { return Vector3(Unit(), Unit(), Unit() + 1e-9).normalized(); }

  // Fills the model with up to 8 random planes near the tool. The planes are plausible, so the loop does not
  // refuse them.
  void SetPlausiblePlanes(simulation::ContactModel& model, const Pose& X_WT) {
    model.contact_count = static_cast<std::int32_t>(Bits() % 9);
    for (simulation::Contact& c : model.contacts) {
      c.p_TP_m = Vector3(0.1 * Vector3(Unit(), Unit(), Unit()));
      c.n_W = Direction();
      c.p_W_m = Vector3(X_WT * Vector3(c.p_TP_m) + 0.05 * Unit() * Vector3(c.n_W));
      c.stiffness_N_per_m = Chance(0.5) ? 20e3 : 1e7;
      c.advance_m_per_s = Chance(0.5) ? 0.0 : 1.0;
    }
    model.spindle_torque_Nm = Chance(0.5) ? 0.0 : 100.0;
    model.F_T_W.f = Vector3(100.0 * Direction());
  }
  // Sets a random field of the model to a hostile value.
  void SetHostileField(simulation::ContactModel& model) {
    auto& c = model.contacts[Bits() % model.contacts.size()];
    double* fields[] = {
        &c.p_TP_m.x, &c.p_W_m.y, &c.n_W.z,         &c.stiffness_N_per_m,     &c.advance_m_per_s,
        &c.gap_m,    &c.weight,  &model.F_T_W.f.x, &model.spindle_torque_Nm, &model.X_WP.p.x};
    *fields[Bits() % std::size(fields)] = Hostile();
  }

 private:
  std::mt19937_64 random_;
};

// Asserts that a tick is finite and within the limits of force, torque and speed.
void CheckTick(const TickRecord& record, const ServoLoop& loop, double limit_N, double limit_Nm) {
  const Wrench F = record.F_coupling_T_W;
  ASSERT_TRUE(safety::IsFinite(F));
  ASSERT_LE(F.f.norm(), limit_N);
  ASSERT_LE(F.t.norm(), limit_Nm);
  ASSERT_GE(record.wrench_scale, 0.0);
  ASSERT_LE(record.wrench_scale, 1.0);
  for (const double q : record.q_cmd) ASSERT_TRUE(std::isfinite(q));
  ASSERT_TRUE(Pose(record.X_WT_cmd).matrix().allFinite());
  ASSERT_LE(loop.statistics().peak_coupling_force_N, limit_N);
  ASSERT_LE(Vector3(record.v_WT_cmd_m_per_s).norm(), 0.25 * 1.1);
}

TEST(ServoLimit, NoWrenchAboveTheLimitIsIntegratedForAnyInput) {
  int limited = 0, faulted = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Adversary adversary(seed);
    ServoParams params = ServoBench::Params();
    params.wrench.max_force_N =
        // with the absurd limit of 1e9 N, the built-in ceiling of 200 N must hold
        seed % 3 == 0 ? 1e9 : 150.0;
    params.wrench.max_torque_Nm = 5.0;
    params.spindle_rad_per_s = seed % 2 == 0 ? 26.18 : 0.0;
    const double limit_N = seed % 3 == 0 ? 200.0 : 150.0;
    ServoBench bench(params);
    bench.Activate();
    bench.push_N = 200.0 * adversary.Unit();
    bench.Run(130);  // until the coupling has faded in
    auto before = bench.command.q;
    for (int i = 0; i < 60; ++i) {
      bench.simulation_lives = adversary.Chance(0.3);
      const TickRecord record = bench.Tick();
      ASSERT_NO_FATAL_FAILURE(CheckTick(record, bench.loop, limit_N, 5.0));
      for (std::size_t j = 0; j < 7; ++j)
        ASSERT_LE(std::abs(record.q_cmd[j] - before[j]),
                  0.001 * kinematics::Iiwa14().limits[j].velocity_rad_per_s);
      before = record.q_cmd;
      if (record.wrench_scale < 1.0) ++limited;

      // changes the input of the next tick
      adversary.SetPlausiblePlanes(bench.model, bench.loop.tool_command().X_WT);
      ++bench.model.frame;
      bench.model.pose_stamp = bench.now;
      bench.simulation_lives = false;
      if (adversary.Chance(0.05)) adversary.SetHostileField(bench.model);
      if (adversary.Chance(0.05)) bench.model.pose_stamp = static_cast<rt::Nanoseconds>(adversary.Bits());
      if (adversary.Chance(0.02)) bench.model.contact_count = static_cast<std::int32_t>(adversary.Bits());
      if (adversary.Chance(0.1)) bench.push_N = 240.0 * adversary.Unit();
      if (adversary.Chance(0.01)) bench.push_N = adversary.Hostile();
    }
    if (bench.loop.faults().Any()) ++faulted;
  }
  EXPECT_GT(limited + faulted, 250) << "the draws must reach the limits to prove anything";
}

// The hand's 240 N are below the trip on the sensor's force. So only the limiter can keep the wrench at 200
// N.
TEST(ServoLimit, AHandStrongerThanTheLimitMeetsTheLimitInItsDirection) {
  ServoParams params = ServoBench::Params();
  params.max_tracking_error_m = 1.0;
  ServoBench bench(params);
  bench.Activate();
  bench.push_N = 240.0;
  int limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const TickRecord record = bench.Tick();
    ASSERT_NO_FATAL_FAILURE(CheckTick(record, bench.loop, 200.0, 20.0));
    const Vector3 f = record.F_coupling_T_W.f;
    if (record.wrench_scale < 1.0) {
      ++limited;
      ASSERT_NEAR(f.norm(), 200.0, 1e-9);
      ASSERT_LT(f.cross(bench.feed_W).norm(), 1e-9) << "the direction is kept";
    }
  }
  EXPECT_GT(limited, 10);
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kWrench).events, 0u);
}

TEST(ServoLimit, MessagesWithHostileValuesNeverMoveTheArmTooFast) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Adversary adversary(seed);
    ServoBench bench;
    bench.Activate();
    bench.Run(50);
    auto before = bench.command.q;
    for (int i = 0; i < 50; ++i) {
      ArmState arm = bench.arm;
      if (adversary.Chance(0.2)) arm.q_meas[adversary.Bits() % 7] = adversary.Hostile();
      if (adversary.Chance(0.2)) arm.q_ipo[adversary.Bits() % 7] = adversary.Hostile();
      if (adversary.Chance(0.1)) arm.safety_state = static_cast<std::uint8_t>(adversary.Bits());
      const TickRecord record = bench.loop.Tick({.state = arm,
                                                 .received = ReceiveResult::kOk,
                                                 .readings = bench.readings,
                                                 .model = bench.model,
                                                 .now = bench.now + i * rt::kMillisecond},
                                                bench.command);
      for (std::size_t j = 0; j < 7; ++j)
        ASSERT_LE(std::abs(record.q_cmd[j] - before[j]),
                  0.001 * kinematics::Iiwa14().limits[j].velocity_rad_per_s);
      before = record.q_cmd;
    }
  }
}

}  // namespace
}  // namespace osteon::control
