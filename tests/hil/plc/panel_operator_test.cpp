#include "hil/plc/panel_operator.h"

#include <gtest/gtest.h>

// Tests the simulated person at the panel: after which stops the person presses reset.

namespace osteon::hil {
namespace {

// Whether the person presses the reset button within one second. Advances `now` by up to this second.
// @param connections  number of connections to the PLC so far
bool Presses(PanelOperator& person, bool permitted, std::uint64_t connections, rt::Nanoseconds& now) {
  bool pressed = false;
  for (int cycle = 0; cycle < 100; ++cycle, now += 10 * rt::kMillisecond)
    pressed |= person.Step(now, {.run_permitted = permitted}, connections).reset;
  return pressed;
}

TEST(PanelOperator, ResetsTheStartAndNoLaterStop) {
  PanelOperator person;
  rt::Nanoseconds now = 0;
  EXPECT_TRUE(Presses(person, false, 0, now));
  EXPECT_TRUE(Presses(person, false, 1, now));
  EXPECT_FALSE(Presses(person, true, 1, now));
  EXPECT_FALSE(Presses(person, false, 1, now)) << "a person must decide to go on";
}

TEST(PanelOperator, ResetsAgainAfterAControllerConnects) {
  PanelOperator person;
  rt::Nanoseconds now = 0;
  EXPECT_FALSE(Presses(person, true, 2, now));
  EXPECT_FALSE(Presses(person, false, 2, now));
  EXPECT_TRUE(Presses(person, false, 3, now)) << "somebody has started it";
  EXPECT_FALSE(Presses(person, true, 3, now));
  EXPECT_FALSE(Presses(person, false, 3, now));
}

}  // namespace
}  // namespace osteon::hil
