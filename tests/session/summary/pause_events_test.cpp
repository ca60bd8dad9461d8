#include "session/summary/pause_events.h"

#include <gtest/gtest.h>

#include "safety/cell_state.h"

namespace osteon::session {
namespace {

using safety::CellState;

// A part of a run in one state; a pause or a resume may be requested in its first tick.
struct Part {
  int milliseconds;
  CellState state;
  bool pause{false}, resume{false};
};

// The events of a run that consists of these parts.
std::vector<EventRow> EventsOf(const std::vector<Part>& parts) {
  PauseEvents events;
  rt::Nanoseconds now = 7 * rt::kSecond;
  for (const Part& part : parts)
    for (int i = 0; i < part.milliseconds; ++i) {
      control::TickRecord tick;
      tick.stamp = now += rt::kMillisecond;
      tick.cell_state = static_cast<std::uint8_t>(part.state);
      tick.input.pause = part.pause && i == 0;
      tick.input.resume = part.resume && i == 0;
      events.Add(tick);
    }
  return events.rows();
}

TEST(PauseEvents, ThePausesRowHoldsTheStoppingTimeAndTheResumesRowThePausedTime) {
  const auto rows = EventsOf({{.milliseconds = 2000, .state = CellState::kCutting},
                              {.milliseconds = 120, .state = CellState::kStop2, .pause = true},
                              {.milliseconds = 880, .state = CellState::kPaused},
                              {.milliseconds = 1000, .state = CellState::kChecking, .resume = true},
                              {.milliseconds = 500, .state = CellState::kCutting}});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].name, "pause");
  EXPECT_DOUBLE_EQ(rows[0].time_s, 2.0);
  EXPECT_DOUBLE_EQ(rows[0].value, 0.12);
  EXPECT_EQ(rows[0].unit, "s");
  EXPECT_EQ(rows[1].name, "resume");
  EXPECT_DOUBLE_EQ(rows[1].time_s, 3.0);
  EXPECT_DOUBLE_EQ(rows[1].value, 0.88);
}

TEST(PauseEvents, ARequestWithoutEffectIsNoEvent) {
  EXPECT_TRUE(EventsOf({{.milliseconds = 100, .state = CellState::kCutting, .resume = true}}).empty());
  const auto twice = EventsOf({{.milliseconds = 100, .state = CellState::kStop2, .pause = true},
                               {.milliseconds = 100, .state = CellState::kPaused, .pause = true},
                               {.milliseconds = 100, .state = CellState::kPaused, .pause = true}});
  ASSERT_EQ(twice.size(), 1u);
  EXPECT_EQ(twice[0].name, "pause");
  const auto ended = EventsOf({{.milliseconds = 100, .state = CellState::kPaused, .pause = true},
                               {.milliseconds = 100, .state = CellState::kOff}});
  ASSERT_EQ(ended.size(), 1u) << "a run that ends in its pause is not resumed";
}

TEST(PauseEvents, EachOfSeveralPausesIsAnEvent) {
  const std::vector<Part> once{{.milliseconds = 100, .state = CellState::kCutting},
                               {.milliseconds = 50, .state = CellState::kStop2, .pause = true},
                               {.milliseconds = 100, .state = CellState::kPaused},
                               {.milliseconds = 50, .state = CellState::kChecking, .resume = true}};
  std::vector<Part> twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const auto rows = EventsOf(twice);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2].name, "pause");
  EXPECT_DOUBLE_EQ(rows[2].value, 0.05);
  EXPECT_EQ(rows[3].name, "resume");
}

}  // namespace
}  // namespace osteon::session
