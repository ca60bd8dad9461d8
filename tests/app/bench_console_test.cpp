#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `osteon bench console` as a user does, briefly. No time is judged.

namespace osteon::app {
namespace {

// The benchmark runs the demo in several ways, the legs: without the console, and with its server and
// viewers. On a slow machine a demo may end with a fault; its figures are reported nevertheless.
TEST(BenchConsole, MeasuresEveryLegAndItsRatios) {
  const TemporaryFolder folder;
  const CommandResult result = RunCommand(
      folder.path(), {"bench", "console", "--rounds", "1", "--seconds", "1", "--json", "console.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = ReadJson(folder.path() / "console.json");
  ASSERT_EQ(json["legs"].size(), 5u);
  EXPECT_EQ(json["legs"][0]["leg"], "off");
  for (const auto& leg : json["legs"])
    for (const char* key : {"compute_us_p50", "compute_us_p99", "wakeup_us_p99", "frame_us_p50"}) {
      EXPECT_GT(leg[key]["median"].get<double>(), 0.0) << key;
      EXPECT_GT(leg[key]["ratio"].get<double>(), 0.0) << key;
    }
  EXPECT_EQ(json["legs"][0]["frame_us_p50"]["ratio"], 1.0);
  EXPECT_GT(json["legs"][3]["received_ms_p50"].get<double>(), 0.0);
  for (std::size_t leg : {2u, 3u, 4u})
    for (const char* key : {"mesh_per_s", "whole_per_s", "longest_gap_ms", "age_ms_p50", "age_ms_p95"})
      EXPECT_TRUE(json["legs"][leg]["bone"].contains(key)) << leg << " " << key;
}

// 100 pages are loaded during a demo, and 33 of them are killed without closing their connections. The demo
// must end with no more threads, descriptors or memory than before. If a fault occurs, the demo is held, and
// the pages are loaded as before.
TEST(BenchConsole, AHundredReloadsLeaveNoResourceBehind) {
  const TemporaryFolder folder;
  const CommandResult result =
      RunCommand(folder.path(), {"bench", "console", "--reloads", "100", "--json", "reloads.json"});
  const nlohmann::json json = ReadJson(folder.path() / "reloads.json");
  EXPECT_EQ(json["loaded"], 100) << result.out << result.err;
  EXPECT_EQ(json["killed"], 33);
  EXPECT_EQ(json["left_nothing"], true) << json;
  if (json["faults"].empty()) {  // a fault means that this machine woke a thread late
    EXPECT_EQ(result.exit_code, 0) << result.out;
  }
}

}  // namespace
}  // namespace osteon::app
