#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cell_text.h"

// Tests the key of a cell's section `console`.

namespace osteon::config {
namespace {

using testing::HasSubstr;

std::string WithConsole(const std::string& key) {
  return CellText("thin_plate") + "\nconsole:\n  " + key + "\n";
}

TEST(ConsoleKeys, AnOperatorsPageThatClosesPausesTheCellOnlyOnRequest) {
  EXPECT_FALSE(LoadText(CellText("thin_plate")).pause_when_operator_leaves);
  EXPECT_FALSE(LoadText(WithConsole("pause_when_operator_leaves: false")).pause_when_operator_leaves);
  EXPECT_TRUE(LoadText(WithConsole("pause_when_operator_leaves: true")).pause_when_operator_leaves);
  EXPECT_THAT(Refusal(WithConsole("pause_when_operator_leaves: 1")), HasSubstr("true"));
  EXPECT_THAT(Refusal(WithConsole("pause: true")), HasSubstr("pause"));
}

}  // namespace
}  // namespace osteon::config
