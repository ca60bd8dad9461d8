#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <gtest/gtest.h>

#include "session/procedure/session_file.h"
#include "tests/app/command.h"

// Demos with a plan, as a user runs them. One demo is killed and resumed at its last pass. The sessions are
// then assessed, reported, exported and replayed.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

std::string ReadText(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// A demo with a plan of two reamers, which is killed and resumed.
class KilledDemo : public testing::Test {
 protected:
  KilledDemo() {  // writes the demo's plan, but without the plan's first two reamers
    std::string plan = ReadText(OSTEON_SOURCE_DIR "/config/plans/acetabulum.yaml");
    for (const char* reamer : {"  - {diameter_mm: 44", "  - {diameter_mm: 46"}) {
      const std::size_t line = plan.find(reamer);
      EXPECT_NE(line, std::string::npos) << reamer;
      plan.erase(line, plan.find('\n', line) + 1 - line);
    }
    std::ofstream(folder_.path() / "plan.yaml") << plan;
  }

  [[nodiscard]] std::vector<std::string> Demo(const char* seconds, bool resume) const {
    std::vector<std::string> words{"demo",           "--plan",    "plan.yaml", "--session",  "s",
                                   "--virtual-time", "--seconds", seconds,     "--overwrite"};
    if (resume) words.emplace_back("--resume");
    return words;
  }
  // The session's content; nothing if there is no session yet.
  [[nodiscard]] std::optional<session::SessionFile> Session() const {
    auto session = session::ReadSession(folder_.path() / "s");
    return session ? std::optional(std::move(*session)) : std::nullopt;
  }
  // Runs the demo, and kills it as soon as the session fulfils the condition.
  template <class Condition>
  void RunAndKillOnce(bool resume, const Condition& condition) {
    Command demo(folder_.path(), Demo("8", resume));
    ASSERT_TRUE(demo.WaitUntil([&] {
      const auto session = Session();
      return session && condition(*session);
    })) << demo.Err();
    demo.Send(SIGKILL);
    ASSERT_EQ(demo.Wait().exit_code, 128 + SIGKILL);
  }
  CommandResult Ask(const std::vector<std::string>& words) { return RunCommand(folder_.path(), words); }

  TemporaryFolder folder_;
};

TEST_F(KilledDemo, ResumesAtItsLastPassAndIsAssessedReportedAndExported) {
  // the demo is killed before its first pass ends, resumed and killed after that pass, and then resumed to
  // the end
  ASSERT_NO_FATAL_FAILURE(RunAndKillOnce(false, [](const session::SessionFile&) { return true; }));
  ASSERT_TRUE(Session()->passes.empty());
  ASSERT_NO_FATAL_FAILURE(
      RunAndKillOnce(true, [](const session::SessionFile& s) { return !s.passes.empty(); }));
  const auto killed = Session();
  ASSERT_FALSE(killed->ended);
  const CommandResult resumed = Ask(Demo("1", true));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_NE(resumed.out.find("Pass 1"), std::string::npos) << resumed.out;
  const auto session = Session();
  EXPECT_TRUE(session->ended);
  ASSERT_GE(session->passes.size(), killed->passes.size());
  EXPECT_EQ(session->passes[0].state_hash, killed->passes[0].state_hash);
  EXPECT_EQ(session->segments.back().recording, "run_3.mcap");
  EXPECT_EQ(session->segments.back().begin_state, killed->LastState());

  const CommandResult assessed = Ask({"assess", "s", "--json", "a.json"});
  ASSERT_EQ(assessed.exit_code, 0) << assessed.err;
  EXPECT_GT(ReadJson(folder_.path() / "a.json")["result"]["removed_mm3"], 1.0);
  EXPECT_NE(ReadText(folder_.path() / "s/assess.html").find("data-first=\"deviation\""), std::string::npos);

  const CommandResult reported = Ask({"report", "s/run_2.mcap", "--json", "r.json"});
  ASSERT_EQ(reported.exit_code, 0) << reported.err;
  const auto report = ReadJson(folder_.path() / "r.json");
  ASSERT_FALSE(report["passes"].empty());
  EXPECT_EQ(report["passes"][0]["tool_diameter_mm"], 48.0);
  EXPECT_EQ(report["state_hash"], killed->passes.back().state_hash);
  EXPECT_NE(ReadText(folder_.path() / "s/run_2_report.html").find("Deviation from the plan"),
            std::string::npos);

  const CommandResult exported =
      Ask({"export", "s/run_2.mcap", "--csv", "--surface", "bone.ply", "--out", "tables"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const std::string table = ReadText(folder_.path() / "tables/run_2_passes.csv");
  EXPECT_EQ(table.find("number,tool_mm,begin_s,end_s,cutting_s,removed_mm3,to_go_mm,undone\n1,48,"), 0U)
      << table;
  EXPECT_NE(exported.out.find("watertight"), std::string::npos) << exported.out;
}

// Uses the plan for a scanned hip bone, whose mesh is not part of the repository.
TEST(HipBonePlan, IsReamedAssessedAndReplayed) {
  const char* data = std::getenv("OSTEON_DATA_DIR");
  const fs::path mesh = fs::path(data ? data : ".") / "hip_bone_left.obj";
  if (!fs::exists(mesh)) GTEST_SKIP() << "no anatomical meshes: OSTEON_DATA_DIR has no hip_bone_left.obj";
  const TemporaryFolder folder;
  const auto ask = [&](const std::vector<std::string>& words) { return RunCommand(folder.path(), words); };
  const CommandResult planned =
      ask({"surgical-plan", "hip_bone_left", "--mesh", mesh.string(), "--cell", "demo", "--json", "p.json"});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const auto plan = ReadJson(folder.path() / "p.json");
  EXPECT_GT(plan["planned_volume_mm3"], 1000.0);
  EXPECT_GT(plan["least_wall_mm"], 3.0);
  EXPECT_EQ(ask({"demo", "--plan", "hip_bone_left", "--virtual-time"}).exit_code, 2) << "it needs its mesh";

  const CommandResult demo = ask({"demo", "--plan", "hip_bone_left", "--mesh", mesh.string(),
                                  "--virtual-time", "--seconds", "6", "--session", "s", "--json", "d.json"});
  ASSERT_EQ(demo.exit_code, 0) << demo.err;
  EXPECT_GT(ReadJson(folder.path() / "d.json")["removed_volume_mm3"], 10.0);
  const CommandResult assessed = ask({"assess", "s", "--json", "a.json"});
  ASSERT_EQ(assessed.exit_code, 0) << assessed.err;
  EXPECT_LT(ReadJson(folder.path() / "a.json")["result"]["axis_error_deg"], 2.0);
  const CommandResult replayed = ask({"replay", "s"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;
}

// The plan for the molar is an opening that needs two burrs. The score must distinguish a novice from an
// expert.
TEST(MolarPlan, IsOpenedAssessedAndReplayed) {
  const TemporaryFolder folder;
  const auto ask = [&](const std::vector<std::string>& words) { return RunCommand(folder.path(), words); };
  const CommandResult planned = ask({"surgical-plan", "molar", "--cell", "molar", "--json", "p.json"});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const auto plan = ReadJson(folder.path() / "p.json");
  EXPECT_EQ(plan["kind"], "opening");
  EXPECT_EQ(plan["burrs"].size(), 2u);
  EXPECT_NEAR(plan["planned_volume_mm3"].get<double>(), 53.0, 2.0);
  for (const auto& burr : plan["burrs"]) EXPECT_GT(burr["volume_mm3"], 5.0) << plan;

  std::map<std::string, double> scores;
  for (const std::string hand : {"expert", "novice"}) {
    const CommandResult demo =
        ask({"demo", "--cell", "molar", "--plan", "molar", "--virtual-time", "--operator", hand, "--seconds",
             "18", "--out", hand, "--json", "d.json"});
    ASSERT_EQ(demo.exit_code, 0) << demo.err;
    EXPECT_EQ(ReadJson(folder.path() / "d.json")["verdict"]["level"], "good") << demo.out;
    const CommandResult assessed = ask({"assess", hand + "/session", "--json", "a.json"});
    ASSERT_EQ(assessed.exit_code, 0) << assessed.err;
    const auto json = ReadJson(folder.path() / "a.json");
    EXPECT_EQ(json["plan"]["kind"], "opening");
    EXPECT_EQ(json["score"]["rubric"], "opening");
    EXPECT_FALSE(json["result"].contains("coverage")) << "an opening is no sphere";
    EXPECT_GT(json["result"]["unroofed"], 0.05);
    scores[hand] = json["score"]["total"];
  }
  // the run of 18 s is a seventh of the whole demo, so the roof is only partly open
  EXPECT_GT(scores["expert"], scores["novice"] + 20.0);
  EXPECT_LT(scores["novice"], 40.0);
  const CommandResult compared = ask({"assess", "expert/session", "--against", "novice/session"});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  const CommandResult replayed = ask({"replay", "expert/session"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;
}

}  // namespace
}  // namespace osteon::app
