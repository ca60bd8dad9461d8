#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "control/ports.h"
#include "tests/app/command.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"

// The demo in wall time, stopped by Ctrl-C. No test asserts how fast this machine is.

namespace osteon::app {
namespace {

using control::Phase;

// Commanded speed of the tool's apex, in m/s.
double SpeedOf(const control::TickRecord& tick) { return Vector3(tick.v_WT_cmd_m_per_s).norm(); }

// Expects that after the request to stop the commanded speed only decreases, and that the recording ends at
// rest.
void ExpectOrderlyStop(const io::Recording& recording) {
  ASSERT_FALSE(recording.ticks.empty());
  const auto is_stopping = [](const control::TickRecord& t) { return t.phase == Phase::kStopping; };
  const auto first = std::find_if(recording.ticks.begin(), recording.ticks.end(), is_stopping);
  ASSERT_NE(first, recording.ticks.begin());
  double speed = std::prev(first)->phase == Phase::kHaptic ? SpeedOf(*std::prev(first)) : 0.0;
  for (auto tick = first; tick != recording.ticks.end(); ++tick) {
    EXPECT_TRUE(tick->phase == Phase::kStopping || tick->phase == Phase::kStopped) << "tick " << tick->tick;
    // a tolerance of 1 um/s, because the apex's velocity is the difference of two poses over a millisecond
    EXPECT_LE(SpeedOf(*tick), speed + 1e-6) << "tick " << tick->tick;
    speed = SpeedOf(*tick);
  }
  EXPECT_EQ(recording.ticks.back().phase, Phase::kStopped);
  EXPECT_LT(speed, 1e-6);
}

// Expects exit code 130, and that summary, recording and report show an orderly stop without faults.
void ExpectInterrupted(const CommandResult& run, const std::filesystem::path& out) {
  EXPECT_EQ(run.exit_code, 130) << run.err;
  const nlohmann::json summary = ReadJson(out / "summary.json");
  EXPECT_EQ(summary.at("ended"), "interrupted");
  EXPECT_TRUE(summary.at("faults").empty()) << summary.at("faults");
  EXPECT_NE(run.out.find("interrupted"), std::string::npos) << run.out;
  const io::Recording recording = ReadComplete(out / "recording.mcap");
  EXPECT_EQ(summary.at("ticks"), recording.ticks.size());
  ExpectOrderlyStop(recording);
  EXPECT_NE(io::test::ReadAll(out / "report.html").find("</html>"), std::string::npos);
}

// Size of a recording in which the tool already moves: after 1 s of ticks, each about 0.75 kB with its frame.
constexpr std::uintmax_t kSomeBytes = 750'000;

// Size of a running demo's recording so far.
std::uintmax_t RecordedBytes(const std::filesystem::path& folder) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(folder / "demo_out/recording.mcap", error);
  return error ? 0 : bytes;
}

TEST(WallDemo, RunsOverUdpToItsEndOrReportsAStall) {
  const TemporaryFolder folder;
  const WakeupWatch watch;
  const CommandResult run = RunCommand(folder.path(), {"demo", "--seconds", "1", "--port", "0"});
  const nlohmann::json summary = ReadJson(folder.path() / "demo_out/summary.json");
  EXPECT_EQ(summary.at("virtual_time"), false);
  // a busy machine may stall the loop; the run must then report that as a fault
  if (run.exit_code == 0) {
    EXPECT_TRUE(summary.at("faults").empty()) << summary.dump(2);
  } else {
    ASSERT_TRUE(MachineWasLate(run, summary, watch.worst()));
  }
  EXPECT_EQ(summary.at("ended"), run.exit_code == 0 ? "completed" : "fault");
  EXPECT_GT(summary.at("ticks").get<int>(), 0);
  EXPECT_GT(summary.at("frames").get<int>(), 0);
  for (const char* key : {"wakeup_us", "compute_us", "frame_us"})
    EXPECT_GT(summary.at(key).at("max").get<double>(), 0.0) << key;
  const io::Recording recording = ReadComplete(folder.path() / "demo_out/recording.mcap");
  const bool active =
      std::any_of(recording.ticks.begin(), recording.ticks.end(), [](const control::TickRecord& tick) {
        return tick.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
      });
  EXPECT_TRUE(active) << "the arm never reached COMMANDING_ACTIVE";
  double peak_N = 0.0;
  for (const auto& tick : recording.ticks) peak_N = std::max(peak_N, Vector3(tick.F_coupling_T_W.f).norm());
  EXPECT_LE(peak_N, summary.at("force_limit_N").get<double>() * (1.0 + 1e-12));
}

TEST(WallDemo, StopsInOrderAtCtrlC) {
  // a busy machine may stall the loop, which then stops by itself; such a run is repeated
  RepeatWhileLate([&](Attempt& attempt) {
    const TemporaryFolder folder;
    const WakeupWatch watch;
    Command demo(folder.path(),
                 {"demo", "--seconds", "30", "--port", "0", "--cell", PatientCell(folder.path(), "demo")});
    const bool runs = demo.WaitUntil([&] { return RecordedBytes(folder.path()) > kSomeBytes; });
    if (runs) demo.Send(SIGINT);
    const CommandResult run = demo.Wait();
    if (run.exit_code == 1)
      return attempt.ExpectLate(run, ReadJson(folder.path() / "demo_out/summary.json"), watch);
    ASSERT_TRUE(runs) << run.err;
    ExpectInterrupted(run, folder.path() / "demo_out");
  });
}

TEST(VirtualDemo, StopsInOrderAtCtrlC) {
  const TemporaryFolder folder;
  Command demo(folder.path(), {"demo", "--virtual-time", "--seconds", "600"});
  ASSERT_TRUE(demo.WaitUntil([&] { return RecordedBytes(folder.path()) > kSomeBytes; })) << demo.Err();
  demo.Send(SIGTERM);  // a service manager's signal, which must have the effect of Ctrl-C
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  demo.Send(SIGTERM);  // once more, because `timeout` sends the signal twice
  ExpectInterrupted(demo.Wait(), folder.path() / "demo_out");
}

}  // namespace
}  // namespace osteon::app
