#include "session/procedure/session_file.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/session/procedure/session_samples.h"
#include "tests/temporary_path.h"

namespace osteon::session {
namespace {

TEST(SessionFile, ASessionIsReadBackAsItWasWritten) {
  SessionFile session = test::SomeSession();
  Pose X = Pose::Identity();
  X.translation() = Vector3(0.1, -0.2, 1.0 / 3.0);
  X.linear() = Eigen::AngleAxisd(0.3, Vector3::UnitX()).toRotationMatrix();
  session.cup_X_GT = X;
  const auto again = ParseSession(ToJson(session));
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(ToJson(*again), ToJson(session));
  EXPECT_EQ(again->passes[0].cutting_s, 0.1 + 0.2);
  EXPECT_EQ(again->segments[1].guidance_gain, 0.75);
  EXPECT_TRUE(again->passes[1].undone);
  EXPECT_EQ(Pose(*again->cup_X_GT).matrix(), X.matrix());
}

TEST(SessionFile, TheBeginningIsATimeInUtcOrNotKnown) {
  SessionFile session = test::SomeSession();
  EXPECT_EQ(ParseSession(ToJson(session))->began, "") << "an older session";
  session.began = "2026-11-29T09:30:00Z";
  EXPECT_EQ(ParseSession(ToJson(session))->began, session.began);
  session.began = "yesterday";
  const auto again = ParseSession(ToJson(session));
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error(),
            "began: found \"yesterday\", accepted a time in UTC, such as 2026-11-29T09:30:00Z, or null");
}

TEST(SessionFile, AnUndonePassDoesNotCount) {
  SessionFile session = test::SomeSession();
  EXPECT_EQ(session.PassesLeft(), 1);
  EXPECT_EQ(session.LastState(), "state_1.carved");
  session.passes[0].undone = true;
  EXPECT_EQ(session.PassesLeft(), 0);
  EXPECT_EQ(session.LastState(), "") << "the uncut bone";
}

TEST(SessionFile, AStateOutsideTheFolderIsRefused) {
  SessionFile session = test::SomeSession();
  session.segments[1].begin_state = "../other/state_1.carved";
  const auto again = ParseSession(ToJson(session));
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().find("begin_state"), std::string::npos) << again.error();
}

TEST(SessionFile, AToolThatThePlanDoesNotHaveIsRefused) {
  SessionFile session = test::SomeSession();
  std::string text = ToJson(session);
  const std::string index = "\"tool_index\": 2";
  text.replace(text.find(index), index.size(), "\"tool_index\": 3");
  const auto again = ParseSession(text);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error(), "passes[1]: tool_index: found 3, accepted a whole number, 0 … 2");
}

TEST(SessionFile, AWrongValueIsNamedWithItsPlace) {
  const auto error = [](const std::string& from, const std::string& to) {
    std::string text = ToJson(test::SomeSession());
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    const auto session = ParseSession(text.replace(at, from.size(), to));
    return session ? "" : session.error();
  };
  const std::string end = "\"end_ns\": 7", stamps = "a whole number, 0 … 4611686018427387904";
  EXPECT_EQ(error(end, "\"end_ns\": 1.5"), "passes[0]: end_ns: found 1.5, accepted " + stamps);
  EXPECT_EQ(error(end, "\"end_ns\": \"7\""), "passes[0]: end_ns: found \"7\", accepted " + stamps);
  EXPECT_EQ(error(end, "\"end_ns\": 18446744073709551615"),
            "passes[0]: end_ns: found 18446744073709551615, accepted " + stamps);
  EXPECT_EQ(error(end, "\"end_ns\": -1"), "passes[0]: end_ns: found -1, accepted " + stamps);
  EXPECT_EQ(error(end, "\"end_ns\": 4"), "passes[0]: end_ns: found 4, accepted no less than begin_ns");
  EXPECT_EQ(error(end, "\"end\": 7"), "passes[0]: end_ns: found none, accepted " + stamps);
  EXPECT_EQ(error("\"number\": 2", "\"number\": 1"),
            "passes[1]: number: found 1, accepted a whole number, 2 … 2");
  EXPECT_EQ(error("\"guidance_gain\": 0.75", "\"guidance_gain\": -7"),
            "segments[1]: guidance_gain: found -7, accepted 0 … 1");
  EXPECT_EQ(error("\"recording\": \"run_1.mcap\"", "\"recording\": \"\""),
            "segments[0]: recording: found none, accepted the name of a recording");
  EXPECT_EQ(error("\"state\": \"state_1.carved\"", "\"state\": \"state_1\\u0000.carved\"").substr(0, 18),
            "passes[0]: state: ");
}

TEST(SessionFile, TheLastNumberIsTheLargestAmongTheFilesInTheFolder) {
  const std::filesystem::path folder = TemporaryPath("numbers");
  EXPECT_EQ(LastNumber(folder, kRecordingPrefix, kRecordingEnding), 0) << "no folder";
  std::filesystem::create_directories(folder);
  for (const char* name : {"run_2.mcap", "run_11.mcap", "run_12.mcap.part", "run_.mcap", "run_x.mcap",
                           "run_13", "state_3.carved", "run_1e3.mcap"})
    std::ofstream(folder / name) << "";
  EXPECT_EQ(LastNumber(folder, kRecordingPrefix, kRecordingEnding), 11);
  EXPECT_EQ(LastNumber(folder, kStatePrefix, kStateEnding), 3);
}

TEST(SessionFile, MissedChangesAreReadBackAndMayBeAbsent) {
  SessionFile session = test::SomeSession();
  session.missed_changes = {{.tool_index = 2, .reason = "retract 1 mm first"}};
  std::string text = ToJson(session);
  auto again = ParseSession(text);
  ASSERT_TRUE(again) << again.error();
  ASSERT_EQ(again->missed_changes.size(), 1u);
  EXPECT_EQ(again->missed_changes[0].tool_index, 2);
  EXPECT_EQ(again->missed_changes[0].reason, "retract 1 mm first");
  text.replace(text.find("missed_changes"), 14, "of_later_times");
  again = ParseSession(text);
  ASSERT_TRUE(again) << again.error();
  EXPECT_TRUE(again->missed_changes.empty());
}

TEST(SessionFile, AnotherSchemaIsRefused) {
  std::string text = ToJson(test::SomeSession());
  text.replace(text.find("session/1"), 9, "session/9");
  ASSERT_FALSE(ParseSession(text));
  EXPECT_EQ(ParseSession(text).error(), "schema: found \"osteon.session/9\", accepted \"osteon.session/1\"");
}

TEST(SessionFile, TheErrorNamesAFolderWithoutASessionAndSuggestsTheRightOne) {
  const std::filesystem::path folder = TemporaryPath("no_session");
  const auto session = ReadSession(folder);
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().find("session.json"), std::string::npos) << session.error();
  // the folder of a demo has the session in a subfolder
  std::filesystem::create_directories(folder / "session");
  std::ofstream(folder / "session/session.json") << "{}";
  EXPECT_NE(ReadSession(folder).error().find("did you mean " + (folder / "session").string() + "?"),
            std::string::npos)
      << ReadSession(folder).error();
  // the path of a recording instead of its session's folder
  std::ofstream(folder / "session/run_1.mcap") << "x";
  EXPECT_NE(ReadSession(folder / "session/run_1.mcap")
                .error()
                .find("run_1.mcap: found a file, accepted the folder of a session; did you mean " +
                      (folder / "session").string() + "?"),
            std::string::npos)
      << ReadSession(folder / "session/run_1.mcap").error();
}

}  // namespace
}  // namespace osteon::session
