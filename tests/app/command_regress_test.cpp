#include <gtest/gtest.h>

#include "studies/regress/golden_file.h"
#include "tests/app/command.h"

// Runs `osteon regress` as a CI server does: compares scenarios with their golden traces.

namespace osteon::app {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/scenarios";

// Runs `osteon regress` in a folder of its own.
class Regress : public testing::Test {
 protected:
  CommandResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "regress");
    return RunCommand(folder_.path(), std::move(arguments));
  }
  nlohmann::json RunWithJson(std::vector<std::string> arguments, int exit_code) {
    arguments.insert(arguments.end(), {"--json", "r.json"});
    const CommandResult run = Run(std::move(arguments));
    EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
    return ReadJson(folder_.path() / "r.json");
  }
  /// Writes a short scenario into this test's folder. `more` is appended to its text. @returns its name.
  std::string WriteScenario(const std::string& more = "") {
    io::test::WriteAll(folder_.path() / "own.yaml",
                       "shows: a short push\ncell: " OSTEON_SOURCE_DIR
                       "/config/cells/demo.yaml\nengine: plane\nduration_s: 0.2\nsample_ms: 20\n"
                       "overrides:\n  scene.packing.spacing_mm: 5\n  scene.packing.surface_gap_mm: 2\n"
                       "  scene.packing.max_surface_gap_mm: 2\n  scene.packing.sample_spacing_mm: 4\n"
                       "  scene.mass_points.spacing_mm: 8\n  scene.events.min_wall_mm: 0\n" +
                           more);
    return "own.yaml";
  }
  /// The golden trace of that scenario.
  [[nodiscard]] std::filesystem::path OwnGolden() const { return folder_.path() / "golden/own.txt"; }

  TemporaryFolder folder_;
};

// Runs all shipped scenarios on all cores.
TEST_F(Regress, AllShippedScenariosPass) {
  const auto json = RunWithJson({"--junit", "r.xml"}, 0);
  EXPECT_EQ(json["schema"], "osteon.regress/1");
  EXPECT_GE(json["scenarios"].size(), 20u);
  for (const auto& scenario : json["scenarios"]) {
    EXPECT_EQ(scenario["passed"], true) << scenario["name"];
    EXPECT_GT(scenario["seconds_simulated"], 0.2) << scenario["name"];
    EXPECT_EQ(scenario["hash"].get<std::string>().size(), 16u);
  }
  EXPECT_NE(io::test::ReadAll(folder_.path() / "r.xml").find("failures=\"0\" errors=\"0\""),
            std::string::npos);
}

TEST_F(Regress, ARunIsBitIdenticalWhateverRunsBesideIt) {
  const std::vector<std::string> some{"wall_reamer", "packet_loss", "drilling_lbr", "wall_kr"};
  // the hash of each scenario, if so many scenarios run at the same time
  const auto hashes = [&](const std::string& jobs) {
    std::vector<std::string> arguments = some;
    arguments.insert(arguments.end(), {"--jobs", jobs});
    std::map<std::string, std::string> all;
    const auto json = RunWithJson(arguments, 0);
    for (const auto& scenario : json["scenarios"]) all[scenario["name"]] = scenario["hash"];
    return all;
  };
  const auto alone = hashes("1"), together = hashes("4");
  EXPECT_EQ(alone.size(), some.size());
  EXPECT_EQ(alone, together);
}

// One scenario in five steps: it has no golden trace, is accepted with a reason, is unchanged, changes, and
// is accepted again.
TEST_F(Regress, AChangeIsAcceptedWithAReason) {
  WriteScenario();
  const CommandResult none = Run({"own.yaml"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.out.find("no golden trace"), std::string::npos) << none.out;
  EXPECT_FALSE(std::filesystem::exists(OwnGolden()));

  EXPECT_EQ(Run({"own.yaml", "--update"}).exit_code, 2) << "no reason";
  const CommandResult accepted = Run({"own.yaml", "--update", "--reason", "the first"});
  EXPECT_EQ(accepted.exit_code, 0);
  EXPECT_NE(accepted.out.find("the first of its golden traces; its run: completed"), std::string::npos)
      << accepted.out;
  EXPECT_NE(accepted.out.find("1 golden trace written, in "), std::string::npos) << accepted.out;
  const auto first = studies::ReadGolden(OwnGolden());
  ASSERT_TRUE(first) << first.error();
  ASSERT_EQ(first->head.reasons.size(), 1u);
  EXPECT_NE(first->head.reasons[0].find(": the first"), std::string::npos);
  EXPECT_NE(first->head.reasons[0].find(" commit "), std::string::npos);
  EXPECT_TRUE(first->head.reasons[0].starts_with("20"));
  // removes the page that reports the missing trace
  std::filesystem::remove_all(folder_.path() / "regress_out");
  EXPECT_EQ(RunWithJson({"own.yaml", "--exact"}, 0)["scenarios"][0]["identical"], true);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "regress_out")) << "nothing to show";

  // the golden trace of a scenario that passes is not rewritten
  EXPECT_EQ(Run({"own.yaml", "--update", "--reason", "in vain"}).exit_code, 0);
  EXPECT_EQ(studies::ReadGolden(OwnGolden())->head.reasons.size(), 1u);

  WriteScenario("  operator.stiffness_N_per_m: 1900\n");
  const auto differs = RunWithJson({"own.yaml", "--junit", "r.xml"}, 1);
  EXPECT_EQ(differs["scenarios"][0]["passed"], false);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "regress_out/regress.html"));
  EXPECT_NE(
      differs["scenarios"][0]["explained"].dump().find("files changed since the golden trace: own.yaml"),
      std::string::npos);
  EXPECT_NE(io::test::ReadAll(folder_.path() / "r.xml").find("<failure"), std::string::npos);
  // the run that differs was recorded, so that a user can watch it
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "regress_out/own.mcap"));
  EXPECT_NE(differs["scenarios"][0]["explained"].dump().find("osteon view regress_out/own.mcap"),
            std::string::npos);
  EXPECT_EQ(Run({"own.yaml", "--update", "--reason", "a softer hand"}).exit_code, 0);
  const auto second = studies::ReadGolden(OwnGolden());
  ASSERT_EQ(second->head.reasons.size(), 2u);
  EXPECT_NE(second->head.reasons[1].find(": a softer hand"), std::string::npos);
  EXPECT_EQ(Run({"own.yaml"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "regress_out/regress.html")) << "no longer true";
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "regress_out/own.mcap")) << "nothing to watch";

  // a file changes without an effect on the run; the update stores the file's new checksum, so that a later
  // difference is not attributed to it
  io::test::WriteAll(folder_.path() / "own.yaml",
                     io::test::ReadAll(folder_.path() / "own.yaml") + "# a remark\n");
  const CommandResult remark = Run({"own.yaml", "--update", "--reason", "a remark"});
  EXPECT_EQ(remark.exit_code, 0);
  EXPECT_NE(remark.out.find("the same bits, from files that have changed; its run: completed"),
            std::string::npos)
      << remark.out;
  const auto third = studies::ReadGolden(OwnGolden());
  ASSERT_EQ(third->head.reasons.size(), 3u);
  EXPECT_EQ(third->trace.hash, second->trace.hash);
  EXPECT_NE(third->head.sources, second->head.sources) << "its checksum";
  EXPECT_EQ(Run({"own.yaml", "--update", "--reason", "in vain"}).exit_code, 0);
  EXPECT_EQ(studies::ReadGolden(OwnGolden())->head.reasons.size(), 3u);
}

// If the arm is silent from 0.1 s on, the run must end within 40 s of virtual time.
TEST_F(Regress, AnArmThatStaysSilentEndsTheRun) {
  WriteScenario(
      "  injections: [{wire: arm, direction: both, from_s: 0.1, to_s: 9999, silence: true}]\nrecovery_count: "
      "1\n");
  const auto json = RunWithJson({"own.yaml"}, 1);
  EXPECT_EQ(json["scenarios"][0]["ended"], "arm never ready");
  EXPECT_LT(json["scenarios"][0]["seconds_simulated"], 40.0);
}

// A small change of a cell's file. The comparison with the golden trace must detect it.
struct Mutation {
  const char *scenario, *set;
};
class RegressSees : public Regress, public testing::WithParamInterface<Mutation> {};

TEST_P(RegressSees, ASmallChangeAndExplainsIt) {
  const auto json = RunWithJson({GetParam().scenario, "--set", GetParam().set}, 1);
  const auto& scenario = json["scenarios"][0];
  EXPECT_EQ(scenario["passed"], false);
  EXPECT_EQ(scenario["error"], nullptr);
  EXPECT_FALSE(scenario["quantities"].empty());
  EXPECT_GE(scenario["explained"].size(), 2u);
  EXPECT_NE(scenario["explained"].dump().find("this run had --set " + std::string(GetParam().set)),
            std::string::npos)
      << scenario["explained"];
}

INSTANTIATE_TEST_SUITE_P(
    Mutations, RegressSees,
    testing::Values(
        // a change of stiffness or damping by 1 %
        Mutation{"wall_reamer", "coupling.stiffness_N_per_mm=20.2"},
        Mutation{"wall_drill", "coupling.stiffness_N_per_mm=20.2"},
        Mutation{"wall_impedance_wrench", "coupling.stiffness_N_per_mm=10.1"},
        Mutation{"wall_impedance_torque", "coupling.stiffness_N_per_mm=10.1"},
        Mutation{"wall_kr", "coupling.stiffness_N_per_mm=40.4"},
        Mutation{"wall_reamer", "admittance.damping_Ns_per_m=[30, 30, 30.3]"},
        // a change of a pose by 0.1° or 0.1 mm
        Mutation{"wall_reamer", "base_in_world.rpy_deg=[0, 0, 0.1]"},
        Mutation{"wall_kr", "tool.mounting.position_mm=[0, 0, 0.1]"},
        // a change of a delay by one tick
        Mutation{"wall_reamer", "simulated_arm.dead_time_ms=4"},
        Mutation{"wall_kr", "simulated_arm.dead_time_ms=12"},
        Mutation{
            "wall_reamer",
            "injections=[{wire: force_sensor, direction: to_controller, from_s: 0, to_s: 9, delay_ms: 1}]"},
        Mutation{"sensor_silent", "watchdog.sensor_stop_ms=101"},
        // a change of the tool's diameter by 1 mm, and of the spheres' largest radius by 1 %
        Mutation{"wall_reamer", "tool_diameter_mm=51"},
        Mutation{"molar", "scene.packing.cup_radius_cap_mm=0.4545"},
        Mutation{"reaming_lbr", "scene.packing.cup_radius_cap_mm=2.97"}));

TEST_F(Regress, WrongInputIsRefusedBeforeAnythingRuns) {
  const auto expect_refused = [&](const std::vector<std::string>& arguments,
                                  const std::vector<std::string>& texts) {
    const CommandResult run = Run(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& text : texts) EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
  };
  expect_refused({"nothing"}, {"nothing", "wall_reamer"});
  expect_refused({"wall_reamer", (kShipped / "wall_reamer.yaml").string()}, {"found twice"});
  expect_refused({"wall_reamer", "--update"}, {"--reason"});
  expect_refused({"wall_reamer", "--reason", "x"}, {"--update"});
  expect_refused({"wall_reamer", "--update", "--reason", " "}, {"found no reason", "--reason"});
  expect_refused({"wall_reamer", "--update", "--reason", ""}, {"found no reason", "--reason"});
  expect_refused({"--update", "--reason", "x"}, {"--update: found no scenario", "--all"});
  expect_refused({"wall_reamer", "--all"}, {"--update"});
  expect_refused({"wall_reamer", "--update", "--reason", "x", "--set", "a.b=1"}, {"--set"});
  expect_refused({"wall_reamer", "--set", "limits.max_force_N=900"},
                 {"--set limits.max_force_N=900: max_force_N: found 900"});
  expect_refused({"wall_reamer", "--set", "nothing"}, {"KEY=VALUE"});
  // if an override conflicts with a line of the cell's file, the error names that line and the override
  expect_refused({"wall_reamer", "--set", "script.push_force_N=300"},
                 {"demo.yaml:", "max_force_N: found 150", "(with --set script.push_force_N=300)"});
  expect_refused({"wall_reamer", "--jobs", "-1"}, {"--jobs"});
  expect_refused({"wall_reamer", "--json", "nowhere/r.json"}, {"--json", "nowhere"});
  expect_refused({"wall_reamer", "--junit", "."}, {"--junit", "folder"});
  WriteScenario("  limits.max_forc_N: 5\n");
  expect_refused({"own.yaml"}, {"own.yaml:13", "max_forc_N", "max_force_N"});
  io::test::WriteAll(folder_.path() / "own.yaml", "shows: x\n");
  expect_refused({"own.yaml"}, {"own.yaml", "missing key"});
}

}  // namespace
}  // namespace osteon::app
