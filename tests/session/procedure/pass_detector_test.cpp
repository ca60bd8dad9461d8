#include "session/procedure/pass_detector.h"

#include <gtest/gtest.h>

#include "session/procedure/scripted_changes.h"

namespace osteon::session {
namespace {

constexpr rt::Nanoseconds kFrame = 2 * rt::kMillisecond;

// Feeds a PassDetector with frames of 2 ms and counts the passes that began and ended.
struct Frames {
  PassDetector passes;
  simulation::ContactModel model;
  rt::Nanoseconds stamp{rt::kSecond};
  int began{0}, ended{0};

  /// Feeds `count` equal frames. @param removed_m3  bone that each frame removes @param spindle  speed
  /// [rad/s]
  void Run(int count, double removed_m3, int contacts, double spindle = 26.0) {
    for (int i = 0; i < count; ++i) {
      model.removed_volume_m3 += removed_m3;
      model.contact_count = contacts;
      const auto change = passes.Step(model, stamp += kFrame, spindle);
      began += change == PassDetector::Change::kBegan ? 1 : 0;
      ended += change == PassDetector::Change::kEnded ? 1 : 0;
    }
  }
};

TEST(PassDetector, APassEndsOnceTheToolHasBeenClearForHalfASecond) {
  Frames frames;
  frames.Run(10, 0.0, 0);
  frames.Run(100, 1e-9, 3);
  frames.Run(200, 0.0, 0);  // 0.4 s
  EXPECT_EQ(frames.began, 1);
  EXPECT_EQ(frames.ended, 0);
  EXPECT_TRUE(frames.passes.open());
  frames.Run(60, 0.0, 0);
  EXPECT_EQ(frames.ended, 1);
  EXPECT_FALSE(frames.passes.open());
  EXPECT_NEAR(frames.passes.removed_m3(), 100e-9, 1e-15);
  EXPECT_NEAR(frames.passes.cutting_s(), 0.2, 1e-9);
}

TEST(PassDetector, AToolThatReturnsWithinHalfASecondContinuesItsPass) {
  Frames frames;
  frames.Run(1, 0.0, 0);
  for (int i = 0; i < 5; ++i) {
    frames.Run(50, 1e-9, 3);
    frames.Run(100, 0.0, 0);  // lifted for 0.2 s
    frames.Run(100, 0.0, 2);  // touches bone for 0.2 s without cutting
  }
  EXPECT_EQ(frames.began, 1);
  EXPECT_EQ(frames.ended, 0);
}

TEST(PassDetector, RemovalWithTheSpindleStoppedIsNoPass) {
  Frames frames;
  frames.Run(100, 1e-9, 3, 0.0);
  EXPECT_EQ(frames.began, 0);
}

// The removed volume changes only when a mass point is removed. Between two mass points the cut goes on; the
// detector must see this by the advance of the cut face.
TEST(CutDetector, AnAdvancingCutFaceCountsAsACutBetweenTwoMassPoints) {
  CutDetector cut;
  simulation::ContactModel model;
  model.removed_volume_m3 = 5e-9;
  EXPECT_FALSE(cut.Step(model, 26.0)) << "a state that was saved";
  EXPECT_EQ(cut.removed_before_m3(), 5e-9);
  model.removed_volume_m3 = 6e-9;
  EXPECT_TRUE(cut.Step(model, 26.0));
  EXPECT_EQ(cut.removed_before_m3(), 5e-9);
  EXPECT_FALSE(cut.Step(model, 26.0));
  model.advance_m_per_s = 1e-5;
  EXPECT_TRUE(cut.Step(model, 26.0));
  EXPECT_FALSE(cut.Step(model, 0.0)) << "the spindle stands";
  model.status = simulation::EngineStatus::kBadInput;
  EXPECT_FALSE(cut.Step(model, 26.0));
  EXPECT_EQ(cut.removed_m3(), cut.removed_before_m3());
  cut.Restart();
  model = {};
  model.removed_volume_m3 = 9e-9;
  EXPECT_FALSE(cut.Step(model, 26.0)) << "another state of the bone";
}

TEST(PassDetector, ARestoredStateOfTheBoneIsNoCut) {
  Frames frames;
  frames.Run(50, 1e-9, 3);
  frames.Run(300, 0.0, 0);
  frames.passes.Restart();
  frames.model.removed_volume_m3 = 0.0;  // an undo
  frames.Run(1, 0.0, 0);
  frames.passes.Restart();
  frames.model.removed_volume_m3 = 1e-6;  // a resume from a later state
  frames.Run(300, 0.0, 0);
  EXPECT_EQ(frames.began, 1);
  EXPECT_EQ(frames.ended, 1);
}

TEST(ScriptedChanges, AsksForPauseNextAndResumeOnceEachAndOnlyWithARetractedTool) {
  ScriptedChanges script({});
  rt::Nanoseconds stamp = rt::kSecond;
  using Action = ScriptedChanges::Action;
  int pressed = 0;
  const auto run = [&](int frames, double height_m, bool paused, bool next) {
    Action last = Action::kNone;
    for (int i = 0; i < frames; ++i) {
      const Action action = script.Step(stamp += kFrame, height_m, paused, next);
      if (action == Action::kNone) continue;
      last = action;
      ++pressed;
    }
    return last;
  };
  EXPECT_EQ(run(1000, 0.04, false, true), Action::kNone) << "it has not been down yet";
  EXPECT_EQ(run(1000, 0.0, false, true), Action::kNone) << "it reams";
  EXPECT_EQ(run(1000, 0.03, false, true), Action::kPause);
  EXPECT_EQ(run(100, 0.03, true, true), Action::kNext);
  EXPECT_EQ(run(100, 0.03, true, true), Action::kNone) << "not answered yet";
  script.OnNextAnswered("");
  EXPECT_EQ(run(100, 0.03, true, true), Action::kResume);
  EXPECT_EQ(run(1000, 0.03, false, true), Action::kNone) << "the next tool has not been down";
  EXPECT_EQ(run(1000, 0.0, false, false), Action::kNone);
  EXPECT_EQ(run(1000, 0.03, false, false), Action::kNone) << "no further tool";
  EXPECT_EQ(pressed, 3);
}

TEST(ScriptedChanges, SaysWhyAChangeWasNotMade) {
  ScriptedChanges script({});
  rt::Nanoseconds stamp = rt::kSecond;
  const auto run = [&](double height_m, bool paused) {
    for (int i = 0; i < 1000; ++i) (void)script.Step(stamp += kFrame, height_m, paused, true);
    return script.WhyNotChanged();
  };
  EXPECT_EQ(run(0.04, false), "the tool before was not led below 15 mm over the plan");
  EXPECT_EQ(run(0.0, false),
            "the tool before was not retracted to 25 mm over the plan and held at rest there for 0.3 s");
  EXPECT_EQ(run(0.03, false), "the tool before was retracted and at rest only as the run ended");
  EXPECT_EQ(run(0.03, true), "the run ended before the request for the next tool was answered");
  script.OnNextAnswered("retract 1.0 mm first");
  EXPECT_EQ(run(0.03, true), "retract 1.0 mm first");
}

}  // namespace
}  // namespace osteon::session
