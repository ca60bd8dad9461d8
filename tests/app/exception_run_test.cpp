// An exception is thrown in a run whose arm already moves. The arm must still stop in order. The test runs a
// whole simulated cell with its real protocols in this process.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "io/recording/recording_reader.h"
#include "session/run/cell_ports.h"
#include "session/run/cell_run.h"
#include "session/run/simulated_setup.h"
#include "studies/regress/plane_engine.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

namespace osteon::app {
namespace {

using control::Phase;

// Widens the time limits, so that a slow machine does not end these runs before the exception is thrown.
void MakePatient(config::CellConfig& cell) {
  hil::QualityPolicyParams& quality = cell.simulated.fri.quality;
  quality.end_after_lost_in_a_row = quality.end_after_lost_per_s = quality.good_max_lost_per_s = 1'000'000;
  safety::WatchdogParams& watchdog = cell.servo.watchdog;
  watchdog.arm_misses = 1000;
  watchdog.sensor_stop_s = watchdog.spindle_stop_s = watchdog.interlock_stop_s = 3.0;
}

// An engine with one plane. It throws in its n-th frame with a turning spindle. The spindle turns only while
// the loop renders, so frames before the arm is ready do not count.
class ThrowingEngine : public simulation::CuttingEngine {
 public:
  ThrowingEngine(const config::CellConfig& cell, int throws_at)
      : plane_(cell.tool.tool, cell.X_WG.translation(), cell.X_WG.linear().col(2), cell.cutting),
        throws_at_(throws_at) {}
  simulation::ContactModel Step(const simulation::FrameInput& input) override {
    if (input.spindle_rad_per_s > 0.0 && ++steps_ == throws_at_)
      throw std::runtime_error("the engine's own defect");
    return plane_.Step(input);
  }
  [[nodiscard]] simulation::CarvedState Snapshot() const override { return plane_.Snapshot(); }
  void Restore(const simulation::CarvedState& state) override { plane_.Restore(state); }
  [[nodiscard]] std::string name() const override { return plane_.name(); }
  [[nodiscard]] std::string device() const override { return plane_.device(); }

 private:
  studies::PlaneEngine plane_;
  int throws_at_, steps_{0};
};

// The outcome of one run: its result, its recording and the last state of the simulated cell.
struct RunOutcome {
  session::CellRunResult result;
  io::Recording recording;
  hil::CellHostState cell;
};

// Runs a cell for at most 30 s.
// @param throws_at  number of the frame with a turning spindle in which the engine throws; -1: it never
// throws
RunOutcome RunWithException(int throws_at, std::function<void(double)> progress) {
  RunOutcome outcome;
  auto setup = session::SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  EXPECT_TRUE(session::UseSimulated(setup->config, 0));
  MakePatient(setup->config);
  ThrowingEngine engine(setup->config, throws_at);
  const io::test::TemporaryFolder folder;
  hil::CellHost host(session::HostParams(setup->config), session::MakeSimulatedCell(setup->config, 60.0));
  const session::CellRunParams params{
      .seconds = 30.0, .recording = folder.path() / "r.mcap", .progress = std::move(progress)};
  auto result = session::RunCell(*setup, engine, params);
  EXPECT_TRUE(result) << result.error().what;
  host.Stop();
  outcome.cell = host.State();
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  if (!result || !recording) return outcome;
  outcome.result = std::move(*result);
  outcome.recording = std::move(*recording);
  return outcome;
}

// Expects in a complete recording that the arm was rendering, came to rest and was commanded no further
// motion.
void ExpectAnOrderlyStop(const RunOutcome& outcome) {
  ASSERT_FALSE(outcome.recording.ticks.empty());
  EXPECT_TRUE(outcome.recording.complete);
  EXPECT_EQ(outcome.recording.ticks.back().phase, Phase::kStopped);
  const auto ticks_in = [&](Phase phase) {
    return std::count_if(outcome.recording.ticks.begin(), outcome.recording.ticks.end(),
                         [phase](const control::TickRecord& tick) { return tick.phase == phase; });
  };
  EXPECT_GT(ticks_in(Phase::kHaptic), 100) << "it had begun";
  ASSERT_GT(ticks_in(Phase::kStopped), 100) << "and was recorded at rest";
  // a slow tool stops within one tick, so there is no braking to check: expect only that no further motion
  // was commanded
  const auto& ticks = outcome.recording.ticks;
  const auto stopped = std::ranges::find(ticks, Phase::kStopped, &control::TickRecord::phase);
  const auto follows_commands = [](const control::TickRecord& tick) {
    return tick.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
  };
  for (auto tick = stopped; tick != ticks.end() && follows_commands(*tick); ++tick)
    ASSERT_EQ(tick->q_cmd, stopped->q_cmd) << "held, tick " << tick->tick;
  EXPECT_LT(Vector3(outcome.cell.arm.cell.v_WT_meas_m_per_s).norm(), 5e-3);
  EXPECT_LT(outcome.recording.ticks.back().tick, 20'000u) << "it did not wait for its seconds";
}

TEST(ExceptionRun, AnExceptionOfTheProgressCallbackStopsTheArmInOrder) {
  int thrown = 0;
  const RunOutcome outcome = RunWithException(-1, [&](double rendered_s) {
    if (rendered_s < 0.5) return;
    ++thrown;
    throw std::runtime_error("nobody draws this");
  });
  EXPECT_EQ(outcome.result.internal_error, "nobody draws this");
  EXPECT_EQ(thrown, 1) << "who has thrown is not asked again";
  EXPECT_EQ(outcome.result.end, control::RunEnd::kStopFlag);
  EXPECT_EQ(outcome.result.faults.bits(), 0u);
  ExpectAnOrderlyStop(outcome);
}

TEST(ExceptionRun, AnExceptionOfTheSimulationStopsTheArmByAStaleModel) {
  const RunOutcome outcome = RunWithException(300, {});
  EXPECT_EQ(outcome.result.internal_error, "simulation: the engine's own defect");
  EXPECT_EQ(outcome.result.end, control::RunEnd::kFault);
  EXPECT_TRUE(outcome.result.faults.Has(safety::Fault::kModelStale));
  ExpectAnOrderlyStop(outcome);
}

}  // namespace
}  // namespace osteon::app
