#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/cell_run.h"
#include "app/cell_setup.h"
#include "app/summary.h"
#include "io/recording/recording_reader.h"
#include "tests/io/temporary_folder.h"

// A cell whose network loses packets, in virtual time, under the arm's own default policy: 5 answers lost in
// a row, or 25 a second, end COMMANDING_ACTIVE.

namespace osteon::app {
namespace {

struct Lossy {
  RunSummary summary;
  io::Recording recording;
  nlohmann::json cell;
};

Lossy Ride(double loss, double from_s, double to_s, double seconds, int recoveries) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  config::CellConfig& cell = setup->config;
  cell.simulated.fri.quality.end_after_lost_in_a_row = 5;
  cell.simulated.fri.quality.end_after_lost_per_s = 25;
  cell.simulated.fri.quality.good_max_lost_per_s = 24;
  cell.simulated.fri.request_again_after_loss = true;
  cell.injections.injections = {{.from_s = from_s, .to_s = to_s, .faults = {.loss = loss}}};
  auto engine = MakeEngine(*setup, "vulkan", "");
  EXPECT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const CellRunParams params{.seconds = seconds,
                             .virtual_time = true,
                             .recoveries = recoveries,
                             .recording = folder.path() / "r.mcap"};
  const auto result = RunCell(*setup, **engine, params);
  EXPECT_TRUE(result) << result.error();
  Lossy lossy;
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  lossy.summary = Summarise(*setup, **engine, params, *result, *recording);
  lossy.recording = std::move(*recording);
  lossy.cell = nlohmann::json::parse(lossy.summary.cell_report);
  return lossy;
}

// The commanded joints never jump while the arm follows them.
void ExpectNoJump(const io::Recording& recording) {
  const auto active = [](const control::TickRecord& tick) {
    return tick.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
  };
  for (std::size_t i = 1; i < recording.ticks.size(); ++i) {
    const control::TickRecord &a = recording.ticks[i - 1], &b = recording.ticks[i];
    if (!active(a) || !active(b)) continue;
    for (std::size_t j = 0; j < 7; ++j)
      ASSERT_LT(std::abs(b.q_cmd[j] - a.q_cmd[j]), 2e-3) << "tick " << b.tick << ", joint " << j + 1;
  }
}

TEST(LinkLoss, HalfAPercentEachWayIsHeldAndCountedExactly) {
  const Lossy run = Ride(0.005, 0.0, 1e9, 10.0, 0);
  EXPECT_TRUE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  EXPECT_EQ(run.cell["arm"]["stop"], "");
  const nlohmann::json& in = run.cell["wires"]["arm_to_controller"];
  const nlohmann::json& out = run.cell["wires"]["arm_from_controller"];
  EXPECT_GT(in["lost"].get<unsigned>(), 20u);
  EXPECT_GT(out["lost"].get<unsigned>(), 20u);
  EXPECT_EQ(run.summary.link.lost, in["lost"].get<unsigned>()) << "messages";
  EXPECT_EQ(run.summary.link.answers_lost, out["lost"].get<unsigned>())
      << "answers, as the arm reflects them";
  EXPECT_EQ(run.cell["arm"]["lost"].get<unsigned>(),
            in["lost"].get<unsigned>() + out["lost"].get<unsigned>());
  ExpectNoJump(run.recording);
}

TEST(LinkLoss, ThreePercentEndCommandingAndItIsRecoveredWithoutAJump) {
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
  ExpectNoJump(run.recording);
}

TEST(LinkLoss, WithoutARecoveryTheFirstEndIsAFault) {
  const Lossy run = Ride(0.03, 0.5, 1e9, 8.0, 0);
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.faults.front().name, "arm left COMMANDING_ACTIVE");
}

}  // namespace
}  // namespace osteon::app
