#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "io/fri/fri_link.h"
#include "tests/app/command.h"

namespace osteon::app {
namespace {

// Every check: four texts, a known verdict, advice wherever something could be better.
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
  const CommandResult run = RunCommand(folder.path(), {"doctor", "--port", "0", "--json", "doctor.json"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const nlohmann::json doctor = ReadJson(folder.path() / "doctor.json");
  const std::set<std::string> names = ExpectChecks(doctor);
  for (const char* name :
       {"System", "Vulkan device", "Real-time priority", "Locked memory", "FRI port", "SocketCAN"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const std::string& name : names) EXPECT_NE(run.out.find(name), std::string::npos) << name;
  EXPECT_EQ(VerdictOf(doctor, "FRI port"), "good");
}

TEST(Doctor, FailsWithoutAVulkanDriver) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"doctor", "--port", "0", "--json", "doctor.json"},
                                       {"VK_DRIVER_FILES=/nonexistent", "VK_ICD_FILENAMES=/nonexistent"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const nlohmann::json doctor = ReadJson(folder.path() / "doctor.json");
  ExpectChecks(doctor);
  EXPECT_EQ(VerdictOf(doctor, "Vulkan"), "missing");
  EXPECT_NE(run.out.find("mesa-vulkan-drivers"), std::string::npos) << run.out;
}

TEST(Doctor, FailsWhereThePortIsTaken) {
  const auto other = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(other) << other.error();
  const TemporaryFolder folder;
  const std::string port = std::to_string((*other)->port());
  const CommandResult run = RunCommand(folder.path(), {"doctor", "--port", port});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("127.0.0.1:" + port), std::string::npos) << run.out;
}

TEST(Doctor, SaysWhereItsJsonCanNotBeWritten) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"doctor", "--port", "0", "--json", "nowhere/d.json"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("nowhere/d.json"), std::string::npos) << run.err;
}

TEST(Help, ShowsExamplesForEverySubcommand) {
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

TEST(Version, IsTheProjects) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"--version"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out, "osteon " OSTEON_VERSION "\n");
}

}  // namespace
}  // namespace osteon::app
