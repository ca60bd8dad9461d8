#include <unistd.h>

#include <csignal>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/first_port.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"
#include "tests/config/cell_text.h"

// `osteon cell` and `osteon run` as a user starts them: two processes that are connected only by the network.
// No test asserts how fast this machine is. If a run fails because the machine woke a thread late, the test
// repeats the run, at most three times in all, and is then skipped.

namespace osteon::app {
namespace {

// Whether the command has printed the words to standard output.
bool Says(const Command& command, const std::string& words) {
  return command.Out().find(words) != std::string::npos;
}

// Arm, interlock and spindle drive must all work over the network until the run completes.
TEST(CellProcess, ARunConnectsToACellInAnotherProcess) {
  RepeatWhileLate([&](Attempt& attempt) {
    const TemporaryFolder folder, cell_folder;  // one for each process
    const std::string file = PatientCell(folder.path(), "thin_plate");
    Command cell(cell_folder.path(), {"cell", file, "--port", FirstPort(), "--json", "cell.json"});
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
    const WakeupWatch watch;
    const CommandResult run = RunCommand(folder.path(), {"run", file, "--port", FirstPort(), "--seconds", "2",
                                                         "--record", "r.mcap", "--json", "run.json"});
    const bool saw_active = Says(cell, "COMMANDING_ACTIVE");
    cell.Send(SIGTERM);
    EXPECT_EQ(cell.Wait().exit_code, 0);
    const nlohmann::json summary = ReadJson(folder.path() / "run.json");
    EXPECT_EQ(summary.at("schema"), "osteon.run/1");
    if (run.exit_code != 0) return attempt.ExpectLate(run, summary, watch);
    EXPECT_TRUE(saw_active) << cell.Out();
    EXPECT_EQ(summary.at("ended"), "completed");
    const io::Recording recording = ReadComplete(folder.path() / "r.mcap");
    const control::TickInput& last = recording.ticks.back().input;
    EXPECT_TRUE(last.spindle_ready);
    EXPECT_NE(last.interlock_stamp, 0);
    EXPECT_GT(last.spindle_stamp, 0);
    double turns = 0.0;
    for (const auto& tick : recording.ticks) turns = std::max(turns, tick.spindle_rad_per_s);
    EXPECT_GT(turns, 50.0) << "the drill turned, as its drive said";
    const nlohmann::json report = ReadJson(cell_folder.path() / "cell.json");
    EXPECT_EQ(report.at("schema"), "osteon.cell/1");
    EXPECT_GT(report.at("arm").at("answered").get<int>(), 2000);  // 2 s at 1 kHz
    EXPECT_GT(report.at("plc").at("requests").get<int>(), 100);
  });
}

// The cell must serve a second controller, for which its simulated operator presses the reset button again.
TEST(CellProcess, ASecondRunConnectsToTheSameCell) {
  const TemporaryFolder folder, cell_folder;
  const std::string file = PatientCell(folder.path(), "thin_plate");
  Command cell(cell_folder.path(), {"cell", file, "--port", FirstPort(), "--seconds", "3"});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
  for (int runs = 0; runs < 2 && !IsSkipped() && !HasFailure(); ++runs)
    RepeatWhileLate([&](Attempt& attempt) {
      const WakeupWatch watch;
      const CommandResult run =
          RunCommand(folder.path(), {"run", file, "--port", FirstPort(), "--seconds", "4", "--overwrite",
                                     "--record", "r.mcap", "--json", "run.json"});
      if (run.exit_code != 0)
        attempt.ExpectLate(run, ReadJson(folder.path() / "run.json"), watch, run.err + cell.Out());
    });
}

// Three processes: the cell simulates the operator's hand, the run controls, `osteon tell` changes the tool.
TEST(CellProcess, AThirdProcessChangesThePlansToolDuringARun) {
  RepeatWhileLate([&](Attempt& attempt) {
    const TemporaryFolder folder, cell_folder;
    const std::string file = PatientCell(folder.path(), "demo");
    // the simulated hand works 5 s with each of four tools, and holds the tool still in the last of these
    // seconds
    Command cell(cell_folder.path(),
                 {"cell", file, "--plan", "acetabulum", "--port", FirstPort(), "--seconds", "20"});
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
    const WakeupWatch watch;
    Command run(folder.path(), {"run", file, "--plan", "acetabulum", "--session", "hip", "--port",
                                FirstPort(), "--seconds", "10", "--json", "run.json"});
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "COMMANDING_ACTIVE"); })) << run.Err();
    usleep(4'200'000);  // until the last second of the first tool
    // repeats a request until the session accepts it, at most 40 times
    const auto ask = [&](const char* request) {
      for (int times = 0; times < 40; ++times) {
        if (RunCommand(folder.path(), {"tell", "hip", request}).exit_code == 0) return true;
        usleep(50'000);
      }
      return false;
    };
    const bool changed = ask("pause") && ask("next") && ask("resume");
    const CommandResult told = RunCommand(folder.path(), {"tell", "hip", "status", "--json", "told.json"});
    const CommandResult ended = run.Wait();
    const nlohmann::json summary = ReadJson(folder.path() / "run.json");
    if (ended.exit_code != 0) return attempt.ExpectLate(ended, summary, watch);
    ASSERT_TRUE(changed);
    EXPECT_NE(told.out.find("Tool              46 mm, 2 of 4"), std::string::npos) << told.out;
    EXPECT_NE(told.out.find("its planned place"), std::string::npos) << told.out;
    const nlohmann::json procedure = ReadJson(folder.path() / "told.json").at("procedure");
    EXPECT_EQ(procedure.at("tool"), (nlohmann::json{{"number", 2}, {"of", 4}, {"diameter_mm", 46.0}}));
    EXPECT_EQ(procedure.at("passes"), 1);
    const nlohmann::json& passes = summary.at("passes");
    ASSERT_EQ(passes.size(), 2u) << ended.out;
    EXPECT_EQ(passes[0].at("tool_diameter_mm"), 44.0);
    EXPECT_EQ(passes[1].at("tool_diameter_mm"), 46.0);
    for (const nlohmann::json& pass : passes) EXPECT_GT(pass.at("removed_mm3").get<double>(), 100.0);
  });
}

// A KR robot over RSI with a period of 4 ms, instead of an LBR over FRI.
TEST(CellProcess, ARunConnectsToAKrOverRsiInAnotherProcess) {
  RepeatWhileLate([&](Attempt& attempt) {
    const TemporaryFolder folder, cell_folder;
    Command cell(cell_folder.path(),
                 {"cell", "kr_16_thin_plate", "--port", FirstPort(), "--json", "cell.json"});
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
    EXPECT_TRUE(Says(cell, "the arm sends RSI im_free, axes, 4 ms to 127.0.0.1:" + FirstPort()))
        << cell.Out();
    const WakeupWatch watch;
    const CommandResult run =
        RunCommand(folder.path(), {"run", "kr_16_thin_plate", "--port", FirstPort(), "--seconds", "2",
                                   "--record", "r.mcap", "--json", "run.json"});
    const bool saw_active = Says(cell, "RSI is answered, the arm follows the corrections");
    cell.Send(SIGTERM);
    EXPECT_EQ(cell.Wait().exit_code, 0);
    EXPECT_NE(run.err.find("osteon run: RSI im_free, axes, 4 ms on 127.0.0.1:" + FirstPort()),
              std::string::npos)
        << run.err;
    const nlohmann::json summary = ReadJson(folder.path() / "run.json");
    if (run.exit_code != 0) return attempt.ExpectLate(run, summary, watch);
    EXPECT_TRUE(saw_active) << cell.Out();
    EXPECT_EQ(summary.at("ended"), "completed");
    EXPECT_EQ(ReadComplete(folder.path() / "r.mcap").ticks.back().q_cmd[6], 0.0);  // a KR has six joints
    const nlohmann::json report = ReadJson(cell_folder.path() / "cell.json");
    EXPECT_GT(report.at("arm").at("answered").get<int>(), 500);  // 2 s at 250 Hz
    EXPECT_EQ(report.at("arm").at("malformed").get<int>(), 0);
  });
}

TEST(CellProcess, KillingTheCellStopsTheRun) {
  const TemporaryFolder folder, cell_folder;  // one for each process
  const std::string file = PatientCell(folder.path(), "thin_plate");
  Command cell(cell_folder.path(), {"cell", file, "--port", FirstPort()});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
  Command run(folder.path(),
              {"run", file, "--port", FirstPort(), "--record", "r.mcap", "--json", "run.json"});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "COMMANDING_ACTIVE"); })) << run.Err();
  usleep(500'000);
  cell.Send(SIGKILL);
  EXPECT_EQ(run.Wait().exit_code, 1) << run.Err();
  const nlohmann::json summary = ReadJson(folder.path() / "run.json");
  EXPECT_TRUE(IsStall(summary)) << summary.dump(2);
  EXPECT_LE(summary.at("peak_force_N").get<double>(), summary.at("force_limit_N").get<double>());
  EXPECT_EQ(ReadComplete(folder.path() / "r.mcap").ticks.back().phase, control::Phase::kStopped);
}

TEST(CellProcess, AfterARunIsKilledTheCellWaitsForTheNext) {
  const TemporaryFolder folder, cell_folder;  // one for each process
  const std::string file = PatientCell(folder.path(), "thin_plate");
  Command cell(cell_folder.path(), {"cell", file, "--port", FirstPort(), "--json", "cell.json"});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
  {
    Command run(folder.path(), {"run", file, "--port", FirstPort(), "--record", "r.mcap"});
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "COMMANDING_ACTIVE"); })) << run.Err();
    run.Send(SIGKILL);
    run.Wait();
  }
  const auto waits_again = [&] {
    const std::string out = cell.Out();
    return out.find("MONITORING_WAIT", out.find("COMMANDING_ACTIVE")) != std::string::npos;
  };
  EXPECT_TRUE(cell.WaitUntil(waits_again)) << cell.Out();
  usleep(600'000);  // longer than the 0.25 s for which the PLC tolerates a missing heartbeat
  cell.Send(SIGTERM);
  EXPECT_EQ(cell.Wait().exit_code, 0);
  const nlohmann::json report = ReadJson(cell_folder.path() / "cell.json");
  EXPECT_FALSE(report.at("plc").at("run_permitted").get<bool>()) << "its heartbeat stands still";
  EXPECT_FALSE(report.at("arm").at("stop").get<std::string>().empty());
}

// The bone is 20 mm higher in the run's file than in the cell's. So the tool is inside the bone from the
// start, as after a controller was killed in contact.
TEST(CellProcess, ARunThatStartsInsideBoneFailsAndSaysHowDeep) {
  const TemporaryFolder folder, cell_folder;
  const auto higher = folder.path() / "higher.yaml";
  io::test::WriteAll(higher, config::With(config::CellText("thin_plate"), "[620, 0, 210]", "[620, 0, 230]"));
  Command cell(cell_folder.path(), {"cell", "thin_plate", "--port", FirstPort()});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
  const CommandResult run = RunCommand(folder.path(), {"run", higher.string(), "--port", FirstPort()});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  for (const char* words : {"the way to the start: at 0 % of the path: found the tool", "mm inside the bone",
                            "bring the tool out by hand, along its axis (a simulated cell: start it anew)"})
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  cell.Send(SIGTERM);
  EXPECT_EQ(cell.Wait().exit_code, 0);
  EXPECT_FALSE(Says(cell, "COMMANDING_ACTIVE"));
}

TEST(CellProcess, BothProcessesRunTheirRealTimeThreadsOnTheGivenCpu) {
  const TemporaryFolder folder;
  const WakeupWatch watch;
  const CommandResult run =
      RunCommand(folder.path(), {"run", PatientCell(folder.path(), "thin_plate"), "--simulated", "--port",
                                 "0", "--cpu", "0", "--seconds", "0.5", "--json", "run.json"});
  const nlohmann::json summary = ReadJson(folder.path() / "run.json");
  if (run.exit_code != 0) {
    ASSERT_TRUE(MachineWasLate(run, summary, watch.worst()));
  }
  EXPECT_EQ(summary.at("servo_cpu"), 0);
  EXPECT_EQ(summary.at("cell").at("arm").at("cpu"), 0);
}

TEST(CellProcess, CellsTakeFreePortsAndNameThem) {
  const TemporaryFolder folders[2];
  std::string ports[2];
  const std::string before = "the arm sends FRI 1.15 to 127.0.0.1:";
  Command first(folders[0].path(), {"cell", "thin_plate", "--port", "0"});
  Command second(folders[1].path(), {"cell", "thin_plate", "--port", "0"});
  for (int i = 0; i < 2; ++i) {
    Command& cell = i == 0 ? first : second;
    ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
    const std::string out = cell.Out();
    const std::size_t at = out.find(before);
    ASSERT_NE(at, std::string::npos) << out;
    ports[i] = out.substr(at + before.size(), out.find('\n', at) - at - before.size());
    EXPECT_GT(std::stoi(ports[i]), 1023);
  }
  EXPECT_NE(ports[0], ports[1]);
}

TEST(CellProcess, ATakenPortIsNamed) {
  const TemporaryFolder folder, cell_folder;  // one for each process
  Command cell(cell_folder.path(), {"cell", "thin_plate", "--port", FirstPort()});
  ASSERT_TRUE(cell.WaitUntil([&] { return Says(cell, "Ctrl-C ends it"); })) << cell.Err();
  const CommandResult other = RunCommand(folder.path(), {"cell", "thin_plate", "--port", FirstPort()});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("127.0.0.1:"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace osteon::app
