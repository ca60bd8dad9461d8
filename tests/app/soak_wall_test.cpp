#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs the first episode of `osteon soak --wall`: reaming with three processes and three pages. A real
// measurement lasts hours. The tests in tests/studies/soak check script, records and verdict.

namespace osteon::app {
namespace {

// A late machine may stop the cell, and the soak then fails; its figures must be reported nevertheless.
TEST(SoakWall, RunsTheCellsProcessesAndReportsTheirFigures) {
  const TemporaryFolder folder;
  const CommandResult result = RunCommand(
      folder.path(), {"soak", "--wall", "--hours", "0.001", "--out", "out", "--json", "soak.json"});
  ASSERT_LE(result.exit_code, 1) << result.err;
  const nlohmann::json json = ReadJson(folder.path() / "soak.json");
  EXPECT_EQ(json.at("schema"), "osteon.soak.wall/1");
  ASSERT_EQ(json.at("episodes").size(), 1u) << result.out;
  const nlohmann::json& episode = json["episodes"][0];
  SCOPED_TRACE(episode.dump(2));
  EXPECT_EQ(result.exit_code == 0, episode["wrong"].empty());
  EXPECT_TRUE(episode["complete"].get<bool>());
  EXPECT_EQ(episode["missing_ticks"], 0);
  EXPECT_GT(episode["peak_rendered_N"], 50.0);
  EXPECT_LE(episode["peak_rendered_N"], 200.0);
  EXPECT_GT(episode["page_messages"][0], 10);
  EXPECT_GT(episode["page_messages"][1], 10);
  EXPECT_EQ(episode["page_messages"][2], 0) << "it hangs";
  for (const char* part : {"controller", "guard", "cell", "soak"}) {
    EXPECT_GT(episode["use"][part]["memory_MB"], 5.0) << part;
    EXPECT_GT(episode["use"][part]["files"], 2) << part;
  }
  EXPECT_LE(episode["exit"], 1) << "nothing crashed";
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "soak.html"));
}

}  // namespace
}  // namespace osteon::app
