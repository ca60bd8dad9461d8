#include <gtest/gtest.h>

#include "tests/app/command.h"

namespace osteon::app {
namespace {

// The demos of a machine that is late may end with a fault; their figures are there all the same.
TEST(BenchConsole, MeasuresEveryLegAndItsRatios) {
  const TemporaryFolder folder;
  const CommandResult result = RunCommand(
      folder.path(), {"bench", "console", "--rounds", "1", "--seconds", "1", "--json", "console.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = ReadJson(folder.path() / "console.json");
  ASSERT_EQ(json["legs"].size(), 3u);
  EXPECT_EQ(json["legs"][0]["leg"], "off");
  for (const auto& leg : json["legs"])
    for (const char* key : {"compute_us_p50", "compute_us_p99", "wakeup_us_p99", "frame_us_p50"}) {
      EXPECT_GT(leg[key]["median"].get<double>(), 0.0) << key;
      EXPECT_GT(leg[key]["ratio"].get<double>(), 0.0) << key;
    }
  EXPECT_EQ(json["legs"][0]["frame_us_p50"]["ratio"], 1.0);
}

}  // namespace
}  // namespace osteon::app
