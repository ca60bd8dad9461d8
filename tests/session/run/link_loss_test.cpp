#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"
#include "tests/session/run/virtual_run.h"

// A cell whose network loses packets, in virtual time. The arm has its default policy: it ends
// COMMANDING_ACTIVE after 5 lost answers in a row or 25 in a second.

namespace osteon::session {
namespace {

using Lossy = VirtualRun;

constexpr double kMaxStep_rad = 2e-3;  // one millisecond at 2 rad/s

// Loses the share `loss` of the packets in each direction, from from_s to to_s, in a run of `seconds`.
// @param recoveries  how often the run may recover by itself
Lossy Ride(double loss, double from_s, double to_s, double seconds, int recoveries) {
  const auto lossy = [&](config::CellConfig& cell) {
    cell.simulated.fri.quality.end_after_lost_in_a_row = 5;
    cell.simulated.fri.quality.end_after_lost_per_s = 25;
    cell.simulated.fri.quality.good_max_lost_per_s = 24;
    cell.simulated.fri.request_again_after_loss = true;
    cell.injections.injections = {{.from_s = from_s, .to_s = to_s, .faults = {.loss = loss}}};
  };
  return RunInVirtualTime("thin_plate", seconds, lossy, recoveries);
}

TEST(LinkLoss, ALossOfHalfAPercentCausesNoFaultAndIsCountedExactly) {
  const Lossy run = Ride(0.005, 0.0, 1e9, 10.0, 0);
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
      << "answers, as the arm reflects them";
  EXPECT_EQ(run.cell["arm"]["lost"].get<unsigned>(),
            in["lost"].get<unsigned>() + out["lost"].get<unsigned>());
  ExpectNoJump(run.recording, kMaxStep_rad);
}

TEST(LinkLoss, ALossOfThreePercentEndsCommandingAndTheRunRecoversWithoutAJump) {
  const Lossy run = Ride(0.03, 2.0, 5.0, 8.0, 100);
  EXPECT_GT(run.summary.recovered, 0) << "it was ended";
  EXPECT_TRUE(run.summary.faults.empty()) << "and is over";
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  std::uint32_t activations = 0;
  for (const control::TickRecord& tick : run.recording.ticks)
    activations = std::max(activations, tick.input.activation);
  EXPECT_EQ(activations, static_cast<std::uint32_t>(run.summary.recovered) + 1);
  EXPECT_EQ(run.summary.link.lost, run.cell["wires"]["arm_to_controller"]["lost"].get<unsigned>());
  ExpectNoJump(run.recording, kMaxStep_rad);
}

TEST(LinkLoss, WithoutARecoveryTheEndOfCommandingIsAFault) {
  const Lossy run = Ride(0.03, 0.5, 1e9, 8.0, 0);
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.faults.front().name, "arm left COMMANDING_ACTIVE");
}

}  // namespace
}  // namespace osteon::session
