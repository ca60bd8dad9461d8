// The request to finish a session, by `osteon tell DIR finish` or the console's button.

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "simulation/files/carved_file.h"
#include "tests/session/procedure/procedure_rig.h"

namespace osteon::session {
namespace {

// Posts requests to finish a session, one at a time: Ask does nothing while a request waits for its answer.
// Keeps each answer that differs from the previous answer.
struct Asker {
  ProcedureSession* session;
  std::vector<std::string> reasons{};  // each kept answer: why it was refused; an empty text: done
  bool open{false};                    // a request waits for its answer

  void Ask(bool confirmed) {
    if (open) return;
    open = session->Post({.kind = SessionRequest::Kind::kFinish, .confirmed = confirmed},
                         [this](const SessionAnswer& answer) {
                           open = false;
                           EXPECT_EQ(answer.done, answer.reason.empty());
                           if (reasons.empty() || reasons.back() != answer.reason)
                             reasons.push_back(answer.reason);
                         });
  }
};

TEST(Finish, IsRefusedUntilConfirmedThenSavesTheBoneAndEndsTheRun) {
  Rig rig("finished", 14.0);
  Asker asker{rig.session.get()};
  // requests lack the word `confirmed` until three different answers have come and a pass is in the file
  rig.params.ticked = [&](const control::TickRecord&, const simulation::ContactModel&) {
    const bool has_cut = rig.session->File().PassesLeft() > 0;
    asker.Ask(has_cut && asker.reasons.size() >= 3);
  };
  rig.Run();
  // five different answers: before the first cut, in bone, clear of bone again, with `confirmed`, and
  // once more afterwards
  ASSERT_EQ(asker.reasons.size(), 5u) << testing::PrintToString(asker.reasons);
  const std::string not_done =
      "finish: the plan is not finished: no pass of its last tool, 50 mm, counts; `finish confirmed` ends "
      "the "
      "session so";
  EXPECT_EQ(asker.reasons[0], not_done);
  EXPECT_EQ(asker.reasons[1], "finish: the tool touches bone: retract it first");
  EXPECT_EQ(asker.reasons[2], not_done);
  EXPECT_EQ(asker.reasons[3], "");
  EXPECT_EQ(asker.reasons[4], "the session is finished: the run ends");

  EXPECT_TRUE(rig.session->finished());
  EXPECT_EQ(rig.result.end, control::RunEnd::kStopFlag);
  EXPECT_LT(rig.result.statistics.active_ticks, 12'000u) << "it ended before its time";
  const auto session = ReadSession(rig.folder);
  ASSERT_TRUE(session) << session.error();
  EXPECT_TRUE(session->ended);
  ASSERT_EQ(session->PassesLeft(), 1);
  const auto state = simulation::ReadCarvedState(rig.folder / session->LastState(), rig.setup->bone);
  ASSERT_TRUE(state) << state.error().Text();
  EXPECT_EQ(HashText(*state), HashText(rig.result.after)) << "what was cut is in the saved state";
}

TEST(Finish, WithoutARubricTheScoreIsNotKnown) {
  Rig rig("without_rubric", 0.2);
  rig.Run();
  const auto score = nlohmann::json::parse(rig.session->ScoreJson());
  EXPECT_EQ(score.at("type"), "score");
  EXPECT_EQ(score.at("known"), false);
}

}  // namespace
}  // namespace osteon::session
