// The guard with controllers that send anything. For any sequence of commands, no command that the guard
// passes may exceed a limit. The oracle uses the arm's closed-form kinematics and its own arithmetic. It gets
// only the passed commands and their times.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "guard_bench.h"

namespace osteon::safety {
namespace {

// guard and oracle compute the arm's kinematics differently; rounding is 1e-15 m in steps of 1e-9 m
constexpr double kSlack = 1.0 + 1e-6;

// Checks each command that the guard passed, by the previous passed command and the time between both.
class Oracle {
 public:
  Oracle() : before_(GuardBench::StartJoints()) {}

  /// @param message  sequence number of the arm's message that the command answers
  void CheckPassed(const GuardCommand& command, const GuardJoints& q_meas, std::uint32_t message) {
    const GuardParams limits = GuardBench::Params();
    ASSERT_TRUE(command.q);
    const double time_s = std::clamp(message - before_message_, 1u, 10u) * limits.period_s;
    for (std::size_t i = 0; i < 7; ++i) {
      const kinematics::JointLimits& limit = kinematics::Iiwa14().limits[i];
      const double q = (*command.q)[i];
      ASSERT_TRUE(std::isfinite(q));
      ASSERT_TRUE(q >= limit.lower_rad && q <= limit.upper_rad);
      ASSERT_LE(std::abs(q - before_[i]), kSlack * limit.velocity_rad_per_s * time_s);
    }
    const Vector3 p = GuardBench::ToolPose(*command.q).translation(),
                  p_before = GuardBench::ToolPose(before_).translation(),
                  p_meas = GuardBench::ToolPose(q_meas).translation();
    ASSERT_LE((p - p_before).norm(), kSlack * 1.25 * limits.max_speed_m_per_s * time_s + 1e-12);
    ASSERT_LE((p - p_meas).norm(), kSlack * 1.25 * limits.max_tracking_error_m);
    ASSERT_LE((p - limits.workspace.sphere_center_W_m).norm(),
              limits.workspace.sphere_radius_m + limits.workspace_margin_m + 1e-9);
    ASSERT_GE(p.z(), limits.workspace.plane_offset_m - limits.workspace_margin_m - 1e-9);
    if (command.wrench) {
      const Vector3 f((*command.wrench)[0], (*command.wrench)[1], (*command.wrench)[2]);
      ASSERT_LE(f.stableNorm(), kSlack * limits.max_force_N);
      for (const double x : *command.wrench) ASSERT_TRUE(std::isfinite(x));
    }
    before_ = *command.q;
    before_message_ = message;
  }
  void Begin(std::uint32_t message) { before_message_ = message - 1; }

 private:
  GuardJoints before_;
  std::uint32_t before_message_{0};
};

// A special value (not finite, huge, tiny) or one of any size from 1e-7 to 100, each half of the time.
double WildValue(std::mt19937_64& random) {
  constexpr double kSpecial[] = {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity(),
                                 1e308,
                                 -1e308,
                                 std::numeric_limits<double>::denorm_min(),
                                 6.283185307179586,
                                 -0.0};
  if (random() % 2 == 0) return kSpecial[random() % std::size(kSpecial)];
  const double size = std::pow(10.0, std::uniform_real_distribution<double>(-7.0, 2.0)(random));
  return random() % 2 ? size : -size;
}

TEST(GuardWild, NoCommandBeyondALimitPassesAmongRandomErrors) {
  std::mt19937_64 random(20261122);
  std::uint64_t passed = 0, withheld = 0, latched = 0;
  for (int run = 0; run < 4000; ++run) {
    GuardBench bench;
    ASSERT_TRUE(bench.RunUntilArmFollows());
    Oracle oracle;
    oracle.Begin(bench.arm.sequence + 1);
    GuardJoints q = GuardBench::StartJoints();
    // a direction in which the controller drifts, at nominal speed or too fast
    GuardJoints drift{};
    const double speed = std::pow(10.0, std::uniform_real_distribution<double>(-6.0, -2.5)(random));
    for (double& joint : drift) joint = speed * std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    for (int tick = 0; tick < 300; ++tick) {
      if (random() % 150 == 0) bench.arm.q_meas[random() % 7] += 0.01 * WildValue(random);  // a wrong reading
      bench.Message(GuardSession::kActive);
      bench.monitor.CheckSilence(bench.now);
      if (random() % 20 == 0) continue;  // silence
      for (std::size_t i = 0; i < 7; ++i) q[i] += drift[i];
      GuardCommand command{.q = q};
      std::uint32_t reflected = bench.arm.sequence;
      switch (random() % 150) {
        case 0:
          (*command.q)[random() % 7] = WildValue(random);
          break;
        case 1:
          (*command.q)[random() % 7] += WildValue(random);
          break;
        case 2:
          command.wrench.emplace()[random() % 6] = 10.0 * WildValue(random);
          break;
        case 3:
          reflected -= static_cast<std::uint32_t>(random() % 5);
          break;
        case 4:
          command.q.reset();
          break;
        case 5:
          command.tau.emplace()[random() % 7] = WildValue(random);
          break;
        default:
          break;
      }
      command.sequence = ++bench.sequence;
      command.reflected = reflected;
      const bool was_latched = bench.monitor.latched();
      const GuardDecision decision = bench.monitor.OnCommand(command, bench.now + 300'000);
      if (decision != GuardDecision::kPass) {
        ++withheld;
        continue;
      }
      ASSERT_FALSE(was_latched) << "nothing passes any more";
      ++passed;
      ASSERT_NO_FATAL_FAILURE(oracle.CheckPassed(command, bench.arm.q_meas, reflected))
          << "run " << run << " tick " << tick;
      bench.arm.q_meas = *command.q;
    }
    latched += bench.monitor.latched();
  }
  EXPECT_GT(passed, 50'000u) << "nothing was tested";
  EXPECT_GT(latched, 1000u);
  EXPECT_GT(withheld, 10'000u);
}

}  // namespace
}  // namespace osteon::safety
