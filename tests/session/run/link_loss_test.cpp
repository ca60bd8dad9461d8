#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"
#include "tests/session/run/virtual_run.h"

// A cell whose network loses packets, in virtual time. The simulated arm has its default policy: it leaves
// COMMANDING_ACTIVE after 5 lost answers in a row or 25 in a second.

namespace osteon::session {
namespace {

constexpr double kMaxStep_rad = 2e-3;  // one millisecond at 2 rad/s

// Runs the thin plate's cell for `seconds` with the policy above. From from_s to to_s, each direction of the
// arm's link loses the share `loss` of its packets. The arm's program requests motion again after a loss.
// @param recoveries  how often the run may recover by itself
VirtualRun RunWithPacketLoss(double loss, double from_s, double to_s, double seconds, int recoveries) {
  const auto add_packet_loss = [&](config::CellConfig& cell) {
    cell.simulated.fri.quality.end_after_lost_in_a_row = 5;
    cell.simulated.fri.quality.end_after_lost_per_s = 25;
    cell.simulated.fri.quality.good_max_lost_per_s = 24;
    cell.simulated.fri.request_again_after_loss = true;
    cell.injections.injections = {{.from_s = from_s, .to_s = to_s, .faults = {.loss = loss}}};
  };
  return RunInVirtualTime("thin_plate", seconds, add_packet_loss, recoveries);
}

TEST(LinkLoss, ALossOfHalfAPercentCausesNoFaultAndIsCountedExactly) {
  const VirtualRun run = RunWithPacketLoss(0.005, 0.0, 1e9, 10.0, 0);
  EXPECT_TRUE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  EXPECT_EQ(run.summary.arm_stop, "");
  const nlohmann::json& in = run.cell["wires"]["arm_to_controller"];
  const nlohmann::json& out = run.cell["wires"]["arm_from_controller"];
  EXPECT_GT(in["lost"].get<unsigned>(), 20u);
  EXPECT_GT(out["lost"].get<unsigned>(), 20u);
  EXPECT_EQ(run.summary.link.lost, in["lost"].get<unsigned>()) << "messages";
  EXPECT_EQ(run.summary.link.answers_lost, out["lost"].get<unsigned>())
      << "lost answers, by the sequence numbers that the arm sends back";
  // the arm misses an answer if its message or the answer was lost
  EXPECT_EQ(run.cell["arm"]["lost"].get<unsigned>(),
            in["lost"].get<unsigned>() + out["lost"].get<unsigned>());
  ExpectNoJump(run.recording, kMaxStep_rad);
}

TEST(LinkLoss, ALossOfThreePercentEndsCommandingAndTheRunRecoversWithoutAJump) {
  const VirtualRun run = RunWithPacketLoss(0.03, 2.0, 5.0, 8.0, 100);
  EXPECT_GT(run.summary.recovered, 0) << "the arm never left COMMANDING_ACTIVE";
  EXPECT_TRUE(run.summary.faults.empty()) << "a fault remains after the last recovery";
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  std::uint32_t activations = 0;  // each recovery begins a new one
  for (const control::TickRecord& tick : run.recording.ticks)
    activations = std::max(activations, tick.input.activation);
  EXPECT_EQ(activations, static_cast<std::uint32_t>(run.summary.recovered) + 1);
  EXPECT_EQ(run.summary.link.lost, run.cell["wires"]["arm_to_controller"]["lost"].get<unsigned>());
  ExpectNoJump(run.recording, kMaxStep_rad);
}

TEST(LinkLoss, WithoutARecoveryTheEndOfCommandingIsAFault) {
  const VirtualRun run = RunWithPacketLoss(0.03, 0.5, 1e9, 8.0, 0);
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.faults.front().name, "arm left COMMANDING_ACTIVE");
}

}  // namespace
}  // namespace osteon::session
