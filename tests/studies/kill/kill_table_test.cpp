#include "studies/kill/kill_table.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "session/run/cell_trace.h"
#include "tests/io/temporary_folder.h"

// The tables that `osteon failures --kill` prints of its trials, and the trace of the arm that it judges.
// kill_test.cpp kills real processes.

namespace osteon::studies {
namespace {

// A successful trial: the arm came to rest after rest_ms, and the hand felt at most hand_N.
KillRun SuccessfulTrial(KillVictim victim, double rest_ms, double hand_N) {
  KillRun run;
  run.result.victim = victim;
  run.result.at_rest = true;
  run.result.rest_ms = rest_ms;
  run.result.hand_N = hand_N;
  return run;
}

TEST(KillTable, ShowsTheWorstFiguresOfEachVictim) {
  const std::vector<KillRun> runs{SuccessfulTrial(KillVictim::kGuard, 80.0, 150.0),
                                  SuccessfulTrial(KillVictim::kGuard, 120.0, 140.0),
                                  SuccessfulTrial(KillVictim::kController, 70.0, 149.0)};
  const std::string text = KillTableText(runs);
  const std::string guard = text.substr(text.find("\nguard"));
  EXPECT_NE(guard.find("   2        2 "), std::string::npos) << text;
  EXPECT_NE(guard.find(" 120 "), std::string::npos) << text;
  EXPECT_NE(guard.find(" 150.0 "), std::string::npos) << text;
  EXPECT_NE(text.find("3 of 3 as they have to be"), std::string::npos) << text;
  EXPECT_EQ(text.find("simulation"), std::string::npos) << "was not killed";
  EXPECT_TRUE(nlohmann::json::parse(KillTableJson(runs)).at("passed").get<bool>());
}

TEST(KillTable, ShowsFailedTrialsAndTrialsThatDidNotTakePlace) {
  std::vector<KillRun> runs{SuccessfulTrial(KillVictim::kGuard, 80.0, 150.0),
                            SuccessfulTrial(KillVictim::kController, 70.0, 149.0)};
  runs[0].result.at_rest = false;
  runs[0].result.wrong = "no rest";
  runs[1].error = "no full contact in 3 attempts";
  EXPECT_EQ(KillTableText(runs).find("made anew"), std::string::npos);
  runs[0].result.attempts = 3;
  const std::string text = KillTableText(runs);
  EXPECT_NE(text.find("! guard: no rest"), std::string::npos) << text;
  EXPECT_NE(text.find("! controller: no trial: no full contact"), std::string::npos) << text;
  EXPECT_NE(text.find("2 made anew"), std::string::npos) << text;
  EXPECT_NE(text.find("0 of 2 as they have to be"), std::string::npos) << text;
  const nlohmann::json json = nlohmann::json::parse(KillTableJson(runs));
  EXPECT_FALSE(json.at("passed").get<bool>());
  EXPECT_FALSE(json.at("kills")[0].at("at_rest").get<bool>());
  EXPECT_EQ(json.at("kills")[1].at("error"), "no full contact in 3 attempts");
}

// A trial is repeated if another fault than the victim's came first, but only if everything else was as
// required.
TEST(KillTable, DetectsThatAnotherFaultCameFirst) {
  const auto run = [](KillVictim victim, std::vector<std::string> faults, std::string wrong = "") {
    return KillResult{.victim = victim, .faults = std::move(faults), .wrong = std::move(wrong)};
  };
  EXPECT_FALSE(AnotherFaultFirst(run(KillVictim::kRecorder, {"recorder stalled"})));
  EXPECT_FALSE(AnotherFaultFirst(run(KillVictim::kRecorder, {"recorder stalled", "coupling wrench rate"})));
  EXPECT_TRUE(AnotherFaultFirst(run(KillVictim::kRecorder, {"coupling wrench rate"})));
  EXPECT_TRUE(AnotherFaultFirst(run(KillVictim::kRecorder, {"coupling wrench rate", "recorder stalled"})));
  EXPECT_FALSE(AnotherFaultFirst(run(KillVictim::kSimulation, {"contact model stale"})));
  EXPECT_TRUE(AnotherFaultFirst(run(KillVictim::kSimulation, {"loop late"})));
  for (const KillVictim any :
       {KillVictim::kController, KillVictim::kLoop, KillVictim::kGuard, KillVictim::kCell})
    EXPECT_FALSE(AnotherFaultFirst(run(any, {"arm message stale"}))) << NameOf(any);
  EXPECT_FALSE(AnotherFaultFirst(run(KillVictim::kSimulation, {"loop late"}, "no rest")))
      << "what is wrong stays wrong";
}

// A tool that is pressed on bone hardly moves. While the arm is still being commanded, it is not at rest:
// rest begins only after the commands end.
TEST(CellTrace, ACommandedArmIsNotAtRestHoweverSlowItIs) {
  const auto cycle = [](int ms, control::SessionState session, double speed_m_per_s) {
    session::CellCycle made;
    made.stamp = ms * rt::kMillisecond;
    made.session = session;
    made.speed_m_per_s = speed_m_per_s;
    return made;
  };
  using enum control::SessionState;
  constexpr rt::Nanoseconds since = 100 * rt::kMillisecond;
  std::vector<session::CellCycle> cycles;
  EXPECT_EQ(session::RestedFor(cycles, since), 0);
  for (int ms = 0; ms < 2300; ++ms) cycles.push_back(cycle(ms, kCommandingActive, 0.0));
  EXPECT_EQ(session::RestedFor(cycles, since), 0);
  cycles.push_back(cycle(2300, kMonitoringReady, 0.0));
  EXPECT_EQ(session::RestedFor(cycles, since), rt::kMillisecond) << "not since the kill";
  for (int ms = 2301; ms < 2500; ++ms) cycles.push_back(cycle(ms, kMonitoringReady, 0.003));
  EXPECT_EQ(session::RestedFor(cycles, since), 0);
  for (int ms = 2500; ms < 3400; ++ms) cycles.push_back(cycle(ms, kMonitoringReady, 0.001));
  EXPECT_EQ(session::RestedFor(cycles, since), 900 * rt::kMillisecond);
  EXPECT_EQ(session::RestedFor(cycles, 3000 * rt::kMillisecond), 399 * rt::kMillisecond);
}

// A trace is read while another process writes it: every cycle must be read once, and no incomplete one.
TEST(CellTrace, IsReadWhileItIsWritten) {
  const io::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "trace.csv";
  session::CellTraceReader reader(file);
  reader.Poll();
  EXPECT_TRUE(reader.cycles().empty()) << "there is no file yet";
  auto writer = session::CellTraceWriter::Open(file);
  ASSERT_TRUE(writer) << writer.error();
  hil::CellState state;
  state.session = control::SessionState::kCommandingActive;
  state.X_WT_meas.p = Vector3(0.1, -0.2, 0.3);
  state.v_WT_meas_m_per_s = Vector3(0.003, 0.004, 0.0);
  state.F_hand_T_W.f = Vector3(0.0, 90.0, 120.0);
  for (int i = 1; i <= 3; ++i) {
    state.stamp = i * rt::kMillisecond;
    (*writer)->Write(state);
    (*writer)->Flush();
    reader.Poll();
    ASSERT_EQ(reader.cycles().size(), static_cast<std::size_t>(i));
  }
  ASSERT_TRUE((*writer)->Close(0));
  std::ofstream(file, std::ios::app) << "4000000,4,0.1,-0.2";
  reader.Poll();
  ASSERT_EQ(reader.cycles().size(), 3u) << "half a row is none";
  std::ofstream(file, std::ios::app) << ",0.3,0.005,0,150\n";
  reader.Poll();
  ASSERT_EQ(reader.cycles().size(), 4u);
  for (const session::CellCycle& cycle : reader.cycles()) {
    EXPECT_EQ(cycle.session, control::SessionState::kCommandingActive);
    EXPECT_NEAR((cycle.p_WT_m - Vector3(0.1, -0.2, 0.3)).norm(), 0.0, 1e-7) << "written to 0.1 µm";
    EXPECT_NEAR(cycle.speed_m_per_s, 0.005, 1e-6);
    EXPECT_NEAR(cycle.hand_N, 150.0, 1e-3);
  }
  EXPECT_EQ(reader.cycles().back().stamp, 4 * rt::kMillisecond);
}

}  // namespace
}  // namespace osteon::studies
