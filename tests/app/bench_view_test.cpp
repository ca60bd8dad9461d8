#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `osteon bench view` as a user does. No time is judged.

namespace osteon::app {
namespace {

// Repeats a recording of 1 s until it lasts 0.025 h (90 s), and shows it at four of its times.
TEST(BenchView, OpensARepeatedRecordingAndSeeksInIt) {
  const TemporaryFolder folder;
  const CommandResult demo =
      RunCommand(folder.path(), {"demo", "--virtual-time", "--seconds", "1", "--out", "out"});
  ASSERT_EQ(demo.exit_code, 0) << demo.err;
  const CommandResult result = RunCommand(folder.path(), {"bench", "view", "out/recording.mcap", "--hours",
                                                          "0.025", "--seeks", "4", "--json", "view.json"});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  const nlohmann::json json = ReadJson(folder.path() / "view.json");
  EXPECT_EQ(json["schema"], "osteon.bench.view/1");
  EXPECT_GE(json["duration_s"].get<double>(), 90.0);
  EXPECT_EQ(json["seeks"], 4);
  for (const char* key : {"seek_tick", "seek_before", "seek_bone"}) {
    EXPECT_GT(json[key]["median_s"].get<double>(), 0.0) << key;
    EXPECT_GE(json[key]["most_s"], json[key]["median_s"]) << key;
  }
  EXPECT_GE(json["seek_bone"]["most_s"], json["seek_tick"]["median_s"]);
}

}  // namespace
}  // namespace osteon::app
