#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "studies/failures/failure.h"
#include "tests/app/command.h"
#include "tests/app/doc_pages.h"
#include "tests/app/docs_commands.h"

// Checks the documentation: each link has a target, each command and option exists, the commands run, and the
// blocks marked `diff` can be applied to the tree.

namespace osteon::app {
namespace {

using io::test::ReadAll;
using io::test::WriteAll;

const std::filesystem::path kRoot = OSTEON_SOURCE_DIR;

// "PAGE:LINE", as text in a test's message.
std::string Where(const DocPage& page, std::size_t line) { return page.path + ":" + std::to_string(line); }

TEST(Docs, EveryLinkHasATarget) {
  std::map<std::string, std::set<std::string>> headings;
  const std::vector<DocPage> pages = DocPages(kRoot);
  ASSERT_GT(pages.size(), 20u);
  for (const DocPage& page : pages) headings[page.path] = Headings(page);
  int links = 0;
  for (const DocPage& page : pages) {
    for (const DocLink& link : Links(page)) {
      ++links;
      const std::filesystem::path from = std::filesystem::path(page.path).parent_path();
      const std::string to =
          link.file.empty() ? page.path : (from / link.file).lexically_normal().generic_string();
      EXPECT_TRUE(std::filesystem::exists(kRoot / to))
          << Where(page, link.line) << ": found a link to " << link.file << ", and nothing there";
      if (link.heading.empty() || !to.ends_with(".md")) continue;
      EXPECT_TRUE(headings[to].contains(link.heading)) << Where(page, link.line) << ": found a link to #"
                                                       << link.heading << ", and no such heading in " << to;
    }
  }
  EXPECT_GT(links, 100);
}

// The outputs of `osteon … --help`. Each subcommand is run once.
class Helps {
 public:
  // The help of a subcommand; empty if there is no such subcommand.
  const std::string& Of(const std::vector<std::string>& subcommand) {
    auto [at, is_new] = texts_.try_emplace(subcommand);
    if (!is_new) return at->second;
    std::vector<std::string> words = subcommand;
    words.emplace_back("--help");
    const CommandResult help = RunCommand(folder_.path(), words);
    if (help.exit_code == 0) at->second = help.out;
    return at->second;
  }

 private:
  TemporaryFolder folder_;
  std::map<std::vector<std::string>, std::string> texts_;
};

TEST(Docs, EveryCommandAndOptionExists) {
  Helps helps;
  int commands = 0;
  std::vector<DocPage> pages = DocPages(kRoot);
  pages.push_back(ReadPage(kRoot, "docs/ci/regress.yml"));
  for (const DocPage& page : pages) {
    for (const DocCommand& command : Commands(page)) {
      if (command.words[0] == "test") continue;  // a command of the launcher itself
      SCOPED_TRACE(Where(page, command.line) + ": " + command.text);
      std::vector<std::string> subcommand{command.words[0]};
      const bool in_two_words = subcommand[0] == "bench" || subcommand[0] == "chart";
      if (in_two_words && command.words.size() > 1 && std::isalpha(command.words[1][0]) != 0)
        subcommand.push_back(command.words[1]);
      const std::string& help = helps.Of(subcommand);
      EXPECT_FALSE(help.empty()) << "no such subcommand";
      for (const std::string& word : command.words) {
        if (word.size() < 2 || word[0] != '-') continue;
        EXPECT_TRUE(std::regex_search(help, std::regex("(^|[ ,])" + word + "([ ,=:\n]|$)")))
            << "no option " << word;
      }
      ++commands;
    }
  }
  EXPECT_GT(commands, 60);
}

// Runs the commands of a page in one folder, in their order on the page.
class DocsRun : public testing::TestWithParam<std::string> {};

TEST_P(DocsRun, CommandsOfAPageSucceedAndLeaveTheirFiles) {
  const TemporaryFolder folder;
  PutInputs(kRoot, folder.path());
  const DocPage page = ReadPage(kRoot, GetParam());
  for (const DocCommand& command : Commands(page)) {
    if (!command.own_line || command.words[0] == "test") continue;
    SCOPED_TRACE(Where(page, command.line) + ": " + command.text);
    const std::optional<DocRun> how = HowToRun(command.text);
    ASSERT_TRUE(how) << "say in tests/app/docs_commands.cpp how it is run";
    if (!how->elsewhere.empty()) {
      EXPECT_TRUE(IsTest(kRoot, how->elsewhere)) << how->elsewhere << " is no test";
      continue;
    }
    if (how->before) how->before(folder.path());
    const CommandResult run = RunCommand(folder.path(), how->arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    for (const std::string& left : how->leaves)
      EXPECT_TRUE(std::filesystem::exists(folder.path() / left)) << left << " is not there";
  }
}

INSTANTIATE_TEST_SUITE_P(, DocsRun, testing::ValuesIn(PagesWithCommands(kRoot)), [](const auto& page) {
  std::string name = page.param;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

// This test checks the sections; the pictures are checked by Docs.EveryLinkHasATarget.
TEST(Docs, EveryFailureScenarioHasItsSection) {
  const std::string page = ReadAll(kRoot / "docs/failures.md");
  const auto scenarios = studies::FailureScenarios();
  for (const studies::FailureScenario& scenario : scenarios)
    EXPECT_NE(page.find("\n## " + std::to_string(scenario.id) + " " + scenario.name + "\n"),
              std::string::npos)
        << scenario.name;
  const std::string all = std::to_string(scenarios.size());
  EXPECT_NE(page.find(all + " of " + all + " kept"), std::string::npos);
}

TEST(Docs, EveryKnownCommandIsOnAPage) {
  std::set<std::string> shown;
  for (const DocPage& page : DocPages(kRoot))
    for (const DocCommand& command : Commands(page)) shown.insert(command.text);
  for (const std::string& command : KnownCommands()) EXPECT_TRUE(shown.contains(command)) << command;
}

TEST(Docs, DiffBlocksApplyToTheTreeAndTheChangedCellsRun) {
  const TemporaryFolder folder;
  std::filesystem::copy(kRoot / "config", folder.path() / "config", std::filesystem::copy_options::recursive);
  int changed = 0;
  for (const DocDifference& difference : Differences(ReadPage(kRoot, "docs/extending.md"))) {
    SCOPED_TRACE("docs/extending.md:" + std::to_string(difference.line) + ": " + difference.file);
    std::string text = ReadAll(kRoot / difference.file);
    for (const DocDifference::Part& part : difference.parts) {
      const std::size_t at = text.find(part.before);
      ASSERT_NE(at, std::string::npos) << "found nowhere:\n" << part.before;
      ASSERT_EQ(text.find(part.before, at + 1), std::string::npos) << "found twice:\n" << part.before;
      text.replace(at, part.before.size(), part.after);
    }
    if (!difference.file.ends_with(".yaml")) continue;
    WriteAll(folder.path() / difference.file, text);
    ++changed;
  }
  ASSERT_EQ(changed, 3) << "a tool, a bone, an arm";

  const std::vector<std::string> short_run{"--virtual-time", "--seconds", "0.5"};
  const std::string cells = (folder.path() / "config/cells").string();
  const std::string burr = (folder.path() / "config/tools/round_burr.yaml:1.6").string();
  for (std::vector<std::string> words :
       {std::vector<std::string>{"demo", "--cell", cells + "/molar.yaml", "--tool", burr, "--out", "tool"},
        std::vector<std::string>{"demo", "--cell", cells + "/sawbone_block.yaml", "--out", "arm"}}) {
    words.insert(words.end(), short_run.begin(), short_run.end());
    const CommandResult run = RunCommand(folder.path(), words);
    EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  }
  EXPECT_EQ(ReadJson(folder.path() / "tool/summary.json").at("tool"), "round burr 1.6 mm");
  const std::string config = ReadComplete(folder.path() / "arm/recording.mcap").session.config_text;
  EXPECT_NE(config.find("lbr_iiwa_7_r800"), std::string::npos);
  EXPECT_NE(config.find("core: foam_15"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
