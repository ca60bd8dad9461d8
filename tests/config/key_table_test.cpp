#include "config/reading/strict/key_table.h"
#include "config/reading/file_kinds.h"

#include <gtest/gtest.h>

// Tests the table of the keys that the readers of one kind of file ask for. tests/app/schema_test.py checks
// the shipped files against the schemas that are generated from this table.

namespace osteon::config {
namespace {

using Type = KeyInfo::Type;

// Table of the keys of one kind of file, e.g. "cell".
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

// A key that exists only with a certain value of another key ("kind: drilling") is listed as well, as not
// required.
TEST(KeyTable, ListsTheKeysOfEveryChoice) {
  const KeyTable cell = TableOf("cell");
  for (const char* key :
       {"admittance", "impedance", "fri", "rsi", "bone", "calibration", "injections", "extends", "remove"}) {
    ASSERT_TRUE(cell.keys.contains(key)) << key;
    EXPECT_FALSE(cell.keys.at(key).required) << key;
  }
  const KeyTable& script = cell.inner.at("script");
  for (const char* key : {"whirl_period_s", "peck_count", "turn_count"})
    EXPECT_TRUE(script.keys.contains(key)) << key;
  const KeyTable robot = TableOf("robot");
  EXPECT_TRUE(robot.keys.contains("ortho_parallel"));
  EXPECT_TRUE(robot.inner.at("joints").keys.contains("origin"));
}

TEST(KeyTable, KnowsWhichKeysAChoiceRequiresAndExcludes) {
  const KeyTable cell = TableOf("cell");
  bool found = false;
  for (const KeyCase& key_case : cell.inner.at("script").cases)
    if (key_case.key == "kind" && key_case.word == "drilling") {
      found = true;
      EXPECT_TRUE(key_case.required.contains("peck_count"));
      EXPECT_TRUE(key_case.excluded.contains("whirl_period_s"));
    }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace osteon::config
