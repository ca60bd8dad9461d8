#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/usage/study_commands.h"

// Tests which of two executables a command line belongs to: osteon itself, or the executable with the
// studies.

namespace osteon::app {
namespace {

// AsksForStudy for a command line with these words.
bool Asks(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  return AsksForStudy(static_cast<int>(argv.size()), argv.data());
}

TEST(StudyCommands, AreKnownByTheFirstWordThatIsNoOption) {
  for (const StudyCommand& study : StudyCommands()) EXPECT_TRUE(Asks({"osteon", std::string(study.name)}));
  EXPECT_TRUE(Asks({"osteon", "--config-root", "demo", "tune", "demo"})) << "the first is a value";
  EXPECT_TRUE(Asks({"osteon", "--config-root=demo", "--help", "bench"}));
}

TEST(StudyCommands, AreNotAskedForByOtherCommandLines) {
  EXPECT_FALSE(Asks({"osteon"}));
  EXPECT_FALSE(Asks({"osteon", "--help"}));
  EXPECT_FALSE(Asks({"osteon", "demo", "tune"}));
  EXPECT_FALSE(Asks({"osteon", "--config-root", "tune"})) << "a value";
  EXPECT_FALSE(Asks({"osteon", "tun"})) << "the command explains the wrong word";
}

TEST(StudyCommands, HaveOneDescriptionForBothExecutables) {
  CLI::App app;
  EXPECT_EQ(AddStudy(app, "tune")->get_description(), "maps where the loop is stable, and recommends gains");
  EXPECT_THROW(AddStudy(app, "demo"), std::out_of_range);
}

}  // namespace
}  // namespace osteon::app
