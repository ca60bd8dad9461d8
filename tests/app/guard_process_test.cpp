#include <unistd.h>

#include <csignal>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/first_port.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"

// Runs `osteon cell`, `guard` and `run` as three processes, and checks how the other processes react if one
// of them is killed.

namespace osteon::app {
namespace {

// Whether the command has printed the words to standard output.
bool Says(const Command& command, const std::string& words) {
  return command.Out().find(words) != std::string::npos;
}

// A cell with a guard, each process in a folder of its own.
class GuardProcess : public testing::Test {
 protected:
  void SetUp() override {
    file_ = PatientCell(folder_.path(), "thin_plate",
                        {{"plc.guard", "true"}, {"guard", "{port: 30209, silence_ms: 500}"}});
  }

  void StartCellAndGuard() {
    cell_.emplace(cell_folder_.path(),
                  std::vector<std::string>{"cell", file_, "--port", FirstPort(), "--json", "cell.json"});
    ASSERT_TRUE(cell_->WaitUntil([&] { return Says(*cell_, "Ctrl-C ends it"); })) << cell_->Err();
    guard_.emplace(guard_folder_.path(),
                   std::vector<std::string>{"guard", file_, "--port", FirstPort(), "--json", "guard.json"});
    ASSERT_TRUE(guard_->WaitUntil([&] { return Says(*guard_, "Ctrl-C ends it"); })) << guard_->Err();
  }
  // Arguments of `osteon run` for this cell, without a time limit.
  [[nodiscard]] std::vector<std::string> RunArguments() const {
    return {"run", file_, "--port", FirstPort(), "--record", "r.mcap", "--overwrite", "--json", "run.json"};
  }
  [[nodiscard]] nlohmann::json GuardReport() const { return ReadJson(guard_folder_.path() / "guard.json"); }
  // Ends the cell. @returns its report.
  [[nodiscard]] nlohmann::json EndCell() {
    cell_->Send(SIGTERM);
    EXPECT_EQ(cell_->Wait().exit_code, 0);
    return ReadJson(cell_folder_.path() / "cell.json");
  }
  // Waits until the arm has left COMMANDING_ACTIVE. Returns false if it does not within the time limit.
  [[nodiscard]] bool ArmLeft() {
    return cell_->WaitUntil([&] {
      const std::string out = cell_->Out();
      const std::size_t active = out.find("COMMANDING_ACTIVE");
      return active != std::string::npos && out.find("MONITORING", active) != std::string::npos;
    });
  }

  const TemporaryFolder folder_, cell_folder_, guard_folder_, run_folder_;
  std::string file_;  // the cell thin_plate with a guard
  std::optional<Command> cell_, guard_;
};

TEST_F(GuardProcess, ARunThroughTheGuardCompletes) {
  RepeatWhileLate([&](Attempt& attempt) {
    StartCellAndGuard();
    std::vector<std::string> words = RunArguments();
    words.insert(words.end(), {"--seconds", "2"});
    const WakeupWatch watch;
    const CommandResult run = RunCommand(run_folder_.path(), words);
    guard_->Send(SIGTERM);
    const CommandResult guard = guard_->Wait();
    const nlohmann::json cell = EndCell();
    const nlohmann::json report = GuardReport(), summary = ReadJson(run_folder_.path() / "run.json");
    EXPECT_EQ(report.at("schema"), "osteon.guard/1");
    EXPECT_EQ(report.at("config_checksum"), summary.at("config_checksum")) << "both read the same files";
    if (run.exit_code != 0)  // the run may fail only because the machine was late, as a run without a guard
      return attempt.ExpectLate(run, summary, watch, report.dump(2));
    EXPECT_EQ(guard.exit_code, 0) << guard.err << report.dump(2);
    EXPECT_EQ(report.at("withheld"), 0);
    EXPECT_EQ(report.at("reason"), nullptr);
    EXPECT_GT(report.at("relayed").at("to_arm").get<int>(), 2000);  // 2 s at 1 kHz
    EXPECT_GE(report.at("relayed").at("to_arm").get<int>(), cell.at("arm").at("answered").get<int>());
    for (const char* way : {"to_controller", "to_arm"}) {
      const nlohmann::json& delay = report.at("added_latency_us").at(way);
      EXPECT_GT(delay.at("p50"), 0.0);
      EXPECT_LE(delay.at("p50"), delay.at("p99"));
      EXPECT_LE(delay.at("p99"), delay.at("max"));
    }
    EXPECT_TRUE(report.at("plc").at("connected").get<bool>());
  });
}

// A run that starts its simulated cell must also start the cell's guard, and end it.
TEST_F(GuardProcess, ARunOfASimulatedCellStartsAndEndsItsGuard) {
  RepeatWhileLate([&](Attempt& attempt) {
    const WakeupWatch watch;
    const CommandResult run = RunCommand(
        run_folder_.path(), {"run", file_, "--simulated", "--port", FirstPort(), "--seconds", "2",
                             "--rate-hz", "150", "--record", "r.mcap", "--overwrite", "--json", "run.json"});
    ASSERT_NE(run.err.find("the arm is reached through the guard"), std::string::npos) << run.err;
    const nlohmann::json summary = ReadJson(run_folder_.path() / "run.json");
    if (run.exit_code != 0) return attempt.ExpectLate(run, summary, watch);
    EXPECT_EQ(summary.at("ended"), "completed");
    EXPECT_TRUE(summary.at("faults").empty());
    EXPECT_EQ(summary.at("planned").at("rate_hz"), 150.0);
    // the killed guard's port is free again, so a new guard can use it
    guard_.emplace(guard_folder_.path(), std::vector<std::string>{"guard", file_, "--port", FirstPort()});
    EXPECT_TRUE(guard_->WaitUntil([&] { return Says(*guard_, "Ctrl-C ends it"); })) << guard_->Err();
  });
}

TEST_F(GuardProcess, KillingTheGuardStopsArmAndRun) {
  StartCellAndGuard();
  Command run(run_folder_.path(), RunArguments());
  ASSERT_TRUE(cell_->WaitUntil([&] { return Says(*cell_, "COMMANDING_ACTIVE"); }))
      << run.Err() << guard_->Err();
  usleep(300'000);
  guard_->Send(SIGKILL);
  EXPECT_EQ(run.Wait().exit_code, 1) << run.Err();
  EXPECT_TRUE(ArmLeft()) << cell_->Out();
  EXPECT_FALSE(ReadJson(run_folder_.path() / "run.json").at("faults").empty());
  usleep(600'000);  // longer than the 0.25 s for which the PLC tolerates a missing heartbeat
  const nlohmann::json report = EndCell();
  EXPECT_FALSE(report.at("plc").at("run_permitted").get<bool>());
  EXPECT_NE(report.at("plc").at("blocks").get<std::string>().find("guard's heartbeat lost"),
            std::string::npos)
      << report.dump(2);
}

TEST_F(GuardProcess, KillingTheControllerWithdrawsItsRequestAtThePlc) {
  StartCellAndGuard();
  Command run(run_folder_.path(), RunArguments());
  ASSERT_TRUE(cell_->WaitUntil([&] { return Says(*cell_, "COMMANDING_ACTIVE"); }))
      << run.Err() << guard_->Err();
  usleep(1'000'000);  // by then the hand has moved the tool
  run.Send(SIGKILL);
  run.Wait();
  EXPECT_TRUE(ArmLeft()) << cell_->Out();
  EXPECT_TRUE(guard_->WaitUntil([&] {
    return Says(*guard_, "left an arm at rest") ||
           guard_->Err().find("silence of the controller") != std::string::npos;
  })) << guard_->Out();
  usleep(200'000);
  const nlohmann::json cell = EndCell();
  EXPECT_NE(cell.at("plc").at("blocks").get<std::string>().find("guard withdrew the request"),
            std::string::npos)
      << cell.dump(2);
  guard_->Send(SIGTERM);
  const CommandResult guard = guard_->Wait();
  const nlohmann::json report = GuardReport();
  EXPECT_EQ(guard.exit_code, report.at("latched").get<bool>() ? 1 : 0);
}

TEST_F(GuardProcess, ARunWithoutItsGuardFailsAndAsksForIt) {
  std::vector<std::string> run = RunArguments();
  run.insert(run.end(), {"--wait", "1"});
  const CommandResult alone = RunCommand(run_folder_.path(), run);
  EXPECT_EQ(alone.exit_code, 1) << alone.err;
  EXPECT_NE(alone.out.find("does `osteon guard` run?"), std::string::npos) << alone.out;
  EXPECT_EQ(alone.out.find("Bone removed"), std::string::npos) << "there was no cut";
}

TEST_F(GuardProcess, WrongInputIsNamedAndExitsWithTwo) {
  const CommandResult without = RunCommand(folder_.path(), {"guard", "thin_plate"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.err.find("guard: found no such section, accepted guard: {port: N}"), std::string::npos)
      << without.err;
  EXPECT_EQ(RunCommand(folder_.path(), {"guard", "no_such_cell"}).exit_code, 2);
  const CommandResult any_port = RunCommand(folder_.path(), {"guard", file_, "--port", "0"});
  EXPECT_EQ(any_port.exit_code, 2);
  EXPECT_NE(any_port.err.find("--port: found 0"), std::string::npos) << any_port.err;
  const CommandResult help = RunCommand(folder_.path(), {"guard", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
