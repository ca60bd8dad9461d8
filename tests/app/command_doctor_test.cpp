#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

#include "io/fri/fri_link.h"
#include "session/setup/realtime_checks.h"
#include "tests/app/command.h"

// Runs `osteon doctor` as a user does, and tests the measurement on which its verdicts are based.

namespace osteon::app {
namespace {

// Expects that each check has a value and a known verdict, and gives advice unless the verdict is good.
// @returns the checks' names.
std::set<std::string> ExpectChecks(const nlohmann::json& doctor) {
  std::set<std::string> names;
  EXPECT_EQ(doctor.at("schema"), "osteon.doctor/1");
  for (const nlohmann::json& check : doctor.at("checks")) {
    names.insert(check.at("name").get<std::string>());
    EXPECT_FALSE(check.at("value").get<std::string>().empty()) << check;
    const std::string verdict = check.at("verdict");
    EXPECT_TRUE(verdict == "good" || verdict == "usable" || verdict == "missing") << check;
    if (verdict != "good") {
      EXPECT_FALSE(check.at("advice").get<std::string>().empty()) << check;
    }
  }
  return names;
}

std::string VerdictOf(const nlohmann::json& doctor, const std::string& name) {
  for (const nlohmann::json& check : doctor.at("checks"))
    if (check.at("name") == name) return check.at("verdict");
  return "no such check";
}

TEST(Doctor, GivesAVerdictForEachCheck) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"doctor", "--seconds", "0.2", "--port", "0", "--json", "doctor.json"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const nlohmann::json doctor = ReadJson(folder.path() / "doctor.json");
  const std::set<std::string> names = ExpectChecks(doctor);
  for (const char* name : {"System", "Vulkan device", "Cutting engine", "Real-time priority",
                           "Timer latency, ordinary thread", "Servo periods", "Locked memory", "Idle states",
                           "Kernel", "Isolated cores", "Frequency governor", "FRI port", "SocketCAN"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const std::string& name : names) EXPECT_NE(run.out.find(name), std::string::npos) << name;
  EXPECT_EQ(VerdictOf(doctor, "FRI port"), "good");
}

const nlohmann::json* FindCheck(const nlohmann::json& doctor, const std::string& name) {
  for (const nlohmann::json& check : doctor.at("checks"))
    if (check.at("name") == name) return &check;
  return nullptr;
}

// Value and advice of the check with this name, as one text.
std::string TextOf(const nlohmann::json& doctor, const std::string& name) {
  const nlohmann::json* check = FindCheck(doctor, name);
  return check ? check->at("value").get<std::string>() + "; " + check->at("advice").get<std::string>()
               : "no such check";
}

// Runs `osteon doctor` on a cell that extends the demo's and has these lines in addition.
struct CellDoctor {
  explicit CellDoctor(const std::string& lines) {
    io::test::WriteAll(folder.path() / "mine.yaml", "extends: demo\n" + lines);
    run = RunCommand(folder.path(),
                     {"doctor", "mine.yaml", "--seconds", "0.1", "--port", "0", "--json", "doctor.json"});
    if (std::filesystem::exists(folder.path() / "doctor.json"))
      json = ReadJson(folder.path() / "doctor.json");
  }
  TemporaryFolder folder;
  CommandResult run;
  nlohmann::json json;
};

TEST(Doctor, SaysThatASimulatedCellsConnectionsAreSimulated) {
  // this link occupies the arm's port, so `osteon doctor` must report the port as missing
  const auto occupant = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(occupant) << occupant.error();
  const std::string port = std::to_string((*occupant)->port());
  const std::string lines = "fri: {port: " + port + "}\n";
  const CellDoctor taken(lines);
  EXPECT_EQ(taken.run.exit_code, 1) << taken.run.out << taken.run.err;
  EXPECT_EQ(VerdictOf(taken.json, "Arm's port"), "missing");
  EXPECT_NE(TextOf(taken.json, "Arm's port").find("127.0.0.1:" + port), std::string::npos);
  ExpectChecks(taken.json);
  EXPECT_EQ(VerdictOf(taken.json, "Arm's network card"), "usable");
  EXPECT_NE(TextOf(taken.json, "PLC").find("simulated"), std::string::npos) << TextOf(taken.json, "PLC");
  EXPECT_EQ(VerdictOf(taken.json, "PLC"), "usable");
  std::size_t buses = 0;
  for (const std::string& name : ExpectChecks(taken.json))
    if (name.starts_with("CAN bus ")) {
      ++buses;
      EXPECT_EQ(VerdictOf(taken.json, name), "usable");
      EXPECT_NE(TextOf(taken.json, name).find("simulated, by UDP port"), std::string::npos);
    }
  EXPECT_GT(buses, 0u);
}

// The cell names addresses that RFC 5737 reserves for documentation, so no network has them.
TEST(Doctor, NamesEachMissingConnectionOfARealCell) {
  const CellDoctor doctor(
      "fri: {host: 192.0.2.10, arm_host: 192.0.2.2, port: 30200}\n"
      "can: [{name: tool, interface: nocan7}]\n"
      "plc: {host: 192.0.2.20, port: 502}\n");
  EXPECT_EQ(doctor.run.exit_code, 1) << doctor.run.out << doctor.run.err;
  ExpectChecks(doctor.json);
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, std::string>>{{"Arm's network card", "192.0.2.10, of no card here"},
                                                        {"Arm's port", "FRI at 192.0.2.10:30200"},
                                                        {"CAN bus tool", "nocan7, not on this machine"},
                                                        {"PLC", "192.0.2.20:502, "}}) {
    EXPECT_EQ(VerdictOf(doctor.json, name), "missing") << name;
    EXPECT_NE(TextOf(doctor.json, name).find(text), std::string::npos) << TextOf(doctor.json, name);
  }
}

TEST(Doctor, RefusesAnInterfaceThatIsNoCanBus) {
  const CellDoctor doctor("can: [{name: tool, interface: lo}]\n");
  EXPECT_EQ(VerdictOf(doctor.json, "CAN bus tool"), "missing") << doctor.run.err;
  EXPECT_NE(TextOf(doctor.json, "CAN bus tool").find("no CAN interface"), std::string::npos);
}

TEST(Doctor, RefusesAnUnknownCell) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"doctor", "no_such_cell"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("no_such_cell"), std::string::npos) << run.err;
}

TEST(Doctor, ReportsTheCpuEngineWithoutAVulkanDriver) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"doctor", "--seconds", "0.2", "--port", "0", "--json", "doctor.json"},
                 {"VK_DRIVER_FILES=/nonexistent", "VK_ICD_FILENAMES=/nonexistent"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json doctor = ReadJson(folder.path() / "doctor.json");
  ExpectChecks(doctor);
  EXPECT_EQ(VerdictOf(doctor, "Vulkan"), "usable");
  EXPECT_NE(run.out.find("cpu: one thread, "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("mesa-vulkan-drivers"), std::string::npos) << run.out;
}

TEST(Doctor, FailsIfThePortIsTaken) {
  const auto other = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(other) << other.error();
  const TemporaryFolder folder;
  const std::string port = std::to_string((*other)->port());
  const CommandResult run = RunCommand(folder.path(), {"doctor", "--seconds", "0.2", "--port", port});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("127.0.0.1:" + port), std::string::npos) << run.out;
}

TEST(Doctor, NamesAJsonFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"doctor", "--seconds", "0.2", "--port", "0", "--json", "nowhere/d.json"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("nowhere/d.json"), std::string::npos) << run.err;
}

// For a period of 1 ms, the limits are 0.1 ms (99.9th percentile of the latency) and 0.5 ms (maximum). The
// test uses latencies just below and just above.
TEST(Doctor, APeriodNeedsItsP999LatencyBelowATenthAndItsMaximumBelowHalf) {
  const session::DurationFigures late{
      .count = 10'000, .p50_s = 5e-6, .p99_s = 40e-6, .p999_s = 99e-6, .max_s = 499e-6};
  EXPECT_TRUE(session::Serves(late, 1e-3));
  session::DurationFigures tail = late, peak = late;
  tail.p999_s = 101e-6;
  EXPECT_FALSE(session::Serves(tail, 1e-3));
  EXPECT_TRUE(session::Serves(tail, 2e-3));
  peak.max_s = 501e-6;
  EXPECT_FALSE(session::Serves(peak, 1e-3));
  EXPECT_TRUE(session::Serves(peak, 2e-3));
  EXPECT_FALSE(session::Serves({}, 5e-3)) << "nothing measured is nothing promised";
}

TEST(Doctor, MeasuresOneWakeupEveryMillisecond) {
  bool realtime = false;
  const session::DurationFigures late = session::TimerLatency(0.1, realtime);
  EXPECT_FALSE(realtime) << "not asked for";
  EXPECT_EQ(late.count, 100u);
  EXPECT_GE(late.p50_s, 0.0) << "no thread wakes early";
  EXPECT_LE(late.p50_s, late.p999_s);
  EXPECT_LE(late.p999_s, late.max_s);
}

TEST(Help, ShowsExamplesAndIsPrintedWithoutArguments) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> asked{{"demo", "--help"}, {"doctor", "--help"}, {"--help"}};
  for (const auto& arguments : asked) {
    const CommandResult run = RunCommand(folder.path(), arguments);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("Examples:"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("osteon d"), std::string::npos) << run.out;
  }
  const CommandResult bare = RunCommand(folder.path(), {});
  EXPECT_EQ(bare.exit_code, 0);
  EXPECT_EQ(bare.out, RunCommand(folder.path(), {"--help"}).out);
}

TEST(Version, PrintsVersionAndCommit) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"--version"});
  EXPECT_EQ(run.exit_code, 0);
  const std::regex accepted("osteon " OSTEON_VERSION R"( \((unknown|[0-9a-f]{7,40}(-dirty)?)\)\n)");
  EXPECT_TRUE(std::regex_match(run.out, accepted)) << run.out;
}

}  // namespace
}  // namespace osteon::app
