#include <csignal>
#include <cstdlib>

#include <gtest/gtest.h>

#include "console/server/page_client.h"
#include "io/local/local_client.h"
#include "tests/app/command.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"

// Sends commands to a running cell from another process, as an operator does in a second terminal. Also
// serves a recording.

namespace osteon::app {
namespace {

// A running cell and the commands that an operator gives it, in one folder.
class OperatorCommands : public testing::Test {
 protected:
  // Environment with a socket folder of this test alone, because another cell may run on this machine.
  [[nodiscard]] std::vector<std::string> Environment() const {
    return {"OSTEON_SOCKET_FOLDER=" + (folder_.path() / "sockets").string()};
  }
  CommandResult Ask(const std::vector<std::string>& words) {
    return RunCommand(folder_.path(), words, Environment());
  }
  // The state of the running cell; empty if no cell runs.
  std::string State() {
    if (Ask({"status", "--json", "status.json"}).exit_code != 0) return "";
    return ReadJson(folder_.path() / "status.json")["status"].value("state", "");
  }

  // Starts a run, pauses, resumes and stops it.
  void PausesResumesAndStops(Attempt& attempt) {
    const WakeupWatch watch;
    Command run(folder_.path(),
                {"run", PatientCell(folder_.path(), "thin_plate"), "--simulated", "--port", "0", "--console",
                 "0", "--overwrite", "--record", "r.mcap", "--json", "run.json", "--at-fault", "end"},
                Environment());
    const auto late = [&] {
      const CommandResult result = run.Wait();
      attempt.ExpectLate(result, ReadJson(folder_.path() / "run.json"), watch);
    };
    if (!run.WaitUntil([&] { return State() == "cutting"; })) return late();
    EXPECT_EQ(Ask({"resume"}).exit_code, 1) << "it is not paused";
    const CommandResult refused = Ask({"recover"});
    EXPECT_EQ(refused.exit_code, 1) << "it has no fault";
    EXPECT_NE(refused.err.find("no fault to recover from"), std::string::npos) << refused.err;
    const CommandResult paused = Ask({"pause"});
    EXPECT_EQ(paused.exit_code, 0);
    EXPECT_EQ(paused.out, "osteon pause: the cell brakes to rest\n");
    if (!run.WaitUntil([&] { return State() == "paused"; })) return late();
    const CommandResult told = Ask({"status"});
    EXPECT_NE(told.out.find("paused"), std::string::npos) << told.out;
    EXPECT_NE(told.out.find("osteon resume"), std::string::npos) << told.out;
    EXPECT_EQ(Ask({"resume"}).exit_code, 0);
    if (!run.WaitUntil([&] { return State() == "cutting" || State() == "haptic"; })) return late();
    EXPECT_EQ(Ask({"stop"}).exit_code, 0);
    const CommandResult result = run.Wait();
    const nlohmann::json summary = ReadJson(folder_.path() / "run.json");
    if (result.exit_code == 1) return late();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(summary.value("ended_by", ""), "operator");
    EXPECT_TRUE(summary["console"].get<std::string>().starts_with("http://127.0.0.1:")) << summary["console"];
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "r_report.html"));
    EXPECT_EQ(Ask({"pause"}).exit_code, 1) << "no cell runs any more";
  }

  TemporaryFolder folder_;
};

TEST_F(OperatorCommands, PauseResumeAndStopARunningCell) {
  RepeatWhileLate([&](Attempt& attempt) { PausesResumesAndStops(attempt); });
}

// Asks a run for its status until its process has ended. A page that never reads slows down the end of the
// run, so requests arrive while page server and socket are being closed.
TEST_F(OperatorCommands, AskARunUntilItsProcessHasEnded) {
  Command run(folder_.path(),
              {"run", PatientCell(folder_.path(), "thin_plate"), "--simulated", "--port", "0", "--seconds",
               "2", "--console", "0", "--overwrite", "--record", "r.mcap", "--json", "run.json"},
              Environment());
  // the run's status; null if the run does not answer
  const auto answer = [&] {
    setenv("OSTEON_SOCKET_FOLDER", (folder_.path() / "sockets").c_str(), 1);
    const auto running = io::FindLocalServers();
    const auto text = running.empty() ? tl::expected<std::string, std::string>(tl::unexpect, "none")
                                      : io::AskLocalServer(running.front(), "status");
    return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
  };
  nlohmann::json status;
  ASSERT_TRUE(run.WaitUntil([&] {
    status = answer();
    return status.is_object();
  })) << run.Err();
  const std::string url = status["run"].value("console", "");
  const std::size_t colon = url.rfind(':');
  ASSERT_NE(colon, std::string::npos) << status.dump(2);
  const auto page = console::PageClient::Open("127.0.0.1", std::stoi(url.substr(colon + 1)), false);
  ASSERT_TRUE(page) << page.error();
  int answers = 0;
  static_cast<void>(run.WaitUntil([&] {
    answers += answer().is_object() ? 1 : 0;
    return false;
  }));
  EXPECT_GT(answers, 20);
  EXPECT_LE(run.Wait().exit_code, 1) << "a late machine may stop it, nothing may crash it";
  EXPECT_FALSE(ReadJson(folder_.path() / "run.json").is_null());
}

TEST_F(OperatorCommands, SayThatNoCellRuns) {
  for (const char* name : {"pause", "resume", "recover", "stop", "status"}) {
    const CommandResult result = Ask({name});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("no cell runs"), std::string::npos) << result.err;
  }
}

TEST_F(OperatorCommands, ViewServesARecordingUntilCtrlC) {
  ASSERT_EQ(RunCommand(folder_.path(), {"demo", "--virtual-time", "--seconds", "0.5", "--cell", "thin_plate"})
                .exit_code,
            0);
  Command view(folder_.path(), {"view", "demo_out/recording.mcap", "--port", "0", "--json", "view.json"});
  ASSERT_TRUE(view.WaitUntil([&] { return std::filesystem::exists(folder_.path() / "view.json"); }))
      << view.Err();
  EXPECT_TRUE(
      ReadJson(folder_.path() / "view.json")["url"].get<std::string>().starts_with("http://127.0.0.1:"));
  view.Send(SIGINT);
  EXPECT_EQ(view.Wait().exit_code, 0);
}

}  // namespace
}  // namespace osteon::app
