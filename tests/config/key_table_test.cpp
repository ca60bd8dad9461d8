#include "config/reading/strict/key_table.h"
#include "config/reading/file_kinds.h"

#include <gtest/gtest.h>

// What the readers ask for. That shipped files pass the schemas made of it: tests/app/schema_test.py.

namespace osteon::config {
namespace {

using Type = KeyInfo::Type;

KeyTable TableOf(const std::string& name) {
  for (const FileKind& kind : FileKinds())
    if (kind.name == name) return RecordKeys(kind.load);
  throw std::logic_error(name);
}

TEST(KeyTable, HasTypeRangeAndWordsOfAKey) {
  const KeyTable cell = TableOf("cell");
  const KeyInfo& force = cell.inner.at("limits").keys.at("max_force_N");
  EXPECT_EQ(force.type, Type::kNumber);
  EXPECT_EQ(force.min, 1.0);
  EXPECT_EQ(force.max, 200.0);
  EXPECT_TRUE(force.required);
  EXPECT_FALSE(cell.inner.at("limits").keys.at("max_power_W").required);
  EXPECT_EQ(cell.keys.at("tool").folder, "tools");
  EXPECT_EQ(cell.inner.at("limits").keys.at("on_force_limit").words,
            (std::vector<std::string>{"yield", "slow", "stop"}));
  EXPECT_EQ(cell.inner.at("zones").keys.at("at_mm").size, 3u);
}

// Keys that only one answer to another key brings are there as well, as not required.
TEST(KeyTable, FollowsEveryAnswer) {
  const KeyTable cell = TableOf("cell");
  for (const char* law :
       {"admittance", "impedance", "fri", "rsi", "bone", "calibration", "injections", "extends", "remove"}) {
    ASSERT_TRUE(cell.keys.contains(law)) << law;
    EXPECT_FALSE(cell.keys.at(law).required) << law;
  }
  const KeyTable& script = cell.inner.at("script");
  for (const char* key : {"whirl_period_s", "peck_count", "turn_count"})
    EXPECT_TRUE(script.keys.contains(key)) << key;
  const KeyTable robot = TableOf("robot");
  EXPECT_TRUE(robot.keys.contains("ortho_parallel"));
  EXPECT_TRUE(robot.inner.at("joints").keys.contains("origin"));
}

TEST(KeyTable, KnowsWhatAWordDecidesOn) {
  const KeyTable cell = TableOf("cell");
  bool found = false;
  for (const KeyCase& one : cell.inner.at("script").cases)
    if (one.key == "kind" && one.word == "drilling") {
      found = true;
      EXPECT_TRUE(one.required.contains("peck_count"));
      EXPECT_TRUE(one.excluded.contains("whirl_period_s"));
    }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace osteon::config
