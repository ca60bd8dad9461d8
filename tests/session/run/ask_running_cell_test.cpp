#include "session/run/ask_running_cell.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/local/local_server.h"
#include "session/process/exit_code.h"
#include "tests/io/temporary_folder.h"

namespace osteon::session {
namespace {

// The program that asks a running cell finds no local server, or a server that is not a cell of this version.
// The program must end with an exit code in every case.
class AskRunningCellTest : public testing::Test {
 protected:
  void SetUp() override { ::setenv("OSTEON_SOCKET_FOLDER", (folder_.path() / "sockets").c_str(), 1); }
  void TearDown() override { ::unsetenv("OSTEON_SOCKET_FOLDER"); }

  // @returns the exit code of a request that gets this answer
  static int Ask(const std::string& request, const std::string& answer) {
    const auto server = io::LocalServer::Start("run-" + std::to_string(::getpid()),
                                               [&](const std::string&) { return answer; });
    EXPECT_TRUE(server) << server.error();
    return RunAsk({.request = request});
  }

  io::test::TemporaryFolder folder_;
};

TEST_F(AskRunningCellTest, IgnoresValuesOfWrongTypesInAnAnswer) {
  for (
      const char* answer :
      {R"({"done": true})", R"({"done": true, "status": 5, "run": [], "procedure": "none"})",
       R"({"done": true, "status": {"known": true}, "run": {"cell": 7}})",
       R"({"done": true, "status": {"known": true, "faults": [3], "permits_known": true, "permits": "x"}})",
       R"({"done": true, "status": {"known": true, "limits": [1, {}], "latency_ms": {"parts": [null]}}})",
       R"({"done": true, "status": {"known": true, "force_N": "much"}, "procedure": {"tool": [], "known": 1}})",
       R"({"done": true, "procedure": {"passes": "many", "known": true, "beyond": [true]}})"}) {
    EXPECT_EQ(Ask("status", answer), 0) << answer;
    EXPECT_EQ(Ask("next", answer), 0) << answer;
  }
}

TEST_F(AskRunningCellTest, FailsIfTheRequestIsNotDoneOrTheAnswerIsNoJson) {
  for (const char* answer : {"", "{", "[]", "7", "{}", R"({"done": 1})", R"({"done": false, "reason": 4})"})
    EXPECT_EQ(Ask("pause", answer), kFailed) << answer;
}

// A script that reads the JSON file finds the reason there, and not the answer of an earlier request.
TEST_F(AskRunningCellTest, WithoutARunningCellTheJsonFileHasTheReason) {
  const std::filesystem::path json = folder_.path() / "status.json";
  io::test::WriteAll(json, "{\"done\": true}");
  EXPECT_EQ(RunTell({.session = "first_hip", .request = "status", .json = json}), kFailed);
  const auto answer = nlohmann::json::parse(std::ifstream(json));
  EXPECT_EQ(answer.at("done"), false);
  EXPECT_EQ(
      answer.at("reason"),
      "found no running cell of first_hip, accepted a running session's folder or the name of a running "
      "cell");
  EXPECT_EQ(RunAsk({.request = "status", .json = json}), kFailed);
  EXPECT_EQ(
      nlohmann::json::parse(std::ifstream(json)).at("reason"),
      "no cell runs on this machine under this user, and none as a service that this user may ask (group "
      "osteon)");
}

}  // namespace
}  // namespace osteon::session
