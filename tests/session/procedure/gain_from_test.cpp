// The guidance's gain as computed from a trainee's earlier sessions: each passed session lowers it.

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "session/procedure/prepare_session.h"
#include "tests/temporary_path.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

// Writes a session's assessment: the plan's checksum, and whether it was passed (true, false or null).
void WriteAssessment(const fs::path& session, const char* plan, const char* passed) {
  fs::create_directories(session);
  std::ofstream(session / "assess.json")
      << fmt::format(R"({{"plan": {{"checksum": "{}"}}, "passed": {}}})", plan, passed);
}

TEST(GainFrom, EachPassedSessionOfThePlanReducesTheGainByAQuarter) {
  const fs::path folder = TemporaryPath("trainee");
  fs::create_directories(folder);
  EXPECT_EQ(GainFrom(folder, "a").value_or(-1.0), 1.0) << "the first session";
  WriteAssessment(folder / "1", "a", "true");
  WriteAssessment(folder / "2", "a", "false");
  WriteAssessment(folder / "3", "a", "null");
  WriteAssessment(folder / "4", "b", "true");
  EXPECT_EQ(GainFrom(folder, "a").value_or(-1.0), 0.75);
  WriteAssessment(folder / "5" / "session", "a", "true");
  std::ofstream(folder / "1" / "other.json") << "[";
  fs::create_directories(folder / "6");
  std::ofstream(folder / "6" / "assess.json") << "[1, 2";
  EXPECT_EQ(GainFrom(folder, "a").value_or(-1.0), 0.5);
  for (const char* more : {"7", "8", "9"}) WriteAssessment(folder / more, "a", "true");
  EXPECT_EQ(GainFrom(folder, "a").value_or(-1.0), 0.0) << "never below 0";
  const auto none = GainFrom(folder / "nobody", "a");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().find("found no folder"), std::string::npos) << none.error();
}

}  // namespace
}  // namespace osteon::session
