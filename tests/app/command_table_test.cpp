#include "app/cli/help/command_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "app/cli/help/completion.h"
#include "app/cli/help/help_text.h"
#include "app/cli/help/manual.h"
#include "app/cli/usage/usage.h"
#include "base/text.h"

// Tests help, manual and synopsis on a small application. All three are generated from a CLI::App.

namespace osteon::app {
namespace {

class CommandTable : public testing::Test {
 protected:
  CommandTable() {
    app_.set_help_flag("-h,--help", "print this text");
    CLI::App* cut = app_.add_subcommand("cut", "cuts bone");
    auto* file = cut->add_option("-o,--out", text_, "where it goes")->type_name("FILE")->required();
    auto* mode = cut->add_option("--mode", text_, "how")->check(OneOf({"fast", "exact"}));
    mode->default_str("fast");
    cut->add_flag("--dry", flag_, "show only")->excludes(file)->excludes(mode);
    cut->add_option("--depth-mm", number_, "how deep")->check(NumberWithin(1, 20))->needs(mode);
    cut->add_option("cell", text_, "which cell")->type_name("CELL")->required();
    cut->footer(
        "One paragraph\nof two lines.\n\nExit code 1: it broke\noff\n\nExamples:\n  osteon cut demo -o a\n"
        "  osteon cut demo --dry");
    CLI::App* bench = app_.add_subcommand("bench", "measures");
    bench->require_subcommand(1);
    bench->add_subcommand("tick", "times a tick");
  }

  CLI::App app_{"works on bone", "osteon"};
  std::string text_;
  bool flag_{false};
  double number_{0.0};
};

// The option with this long name. It must exist.
const OptionText& Named(const CommandText& command, const std::string& name) {
  const auto at =
      std::ranges::find(command.options, name, [](const OptionText& o) { return o.names.back(); });
  EXPECT_NE(at, command.options.end()) << name;
  return *at;
}

TEST_F(CommandTable, DescribesNamesKindsWordsRangesAndDefaults) {
  const CommandText cut = DescribeCommand(app_).commands.at(0);
  EXPECT_EQ(cut.name, "osteon cut");
  EXPECT_EQ(cut.word(), "cut");
  const OptionText& out = Named(cut, "--out");
  EXPECT_EQ(out.names, (std::vector<std::string>{"-o", "--out"}));
  EXPECT_EQ(out.value, "FILE");
  EXPECT_TRUE(out.required);
  const OptionText& mode = Named(cut, "--mode");
  EXPECT_EQ(mode.words, (std::vector<std::string>{"fast", "exact"}));
  EXPECT_EQ(mode.default_value, "fast");
  const OptionText& depth = Named(cut, "--depth-mm");
  EXPECT_EQ(depth.value, "NUMBER");
  EXPECT_EQ(depth.range, "1 … 20");
  EXPECT_EQ(depth.needs, std::vector<std::string>{"--mode"});
  const OptionText& dry = Named(cut, "--dry");
  EXPECT_EQ(dry.value, "");
  EXPECT_EQ(dry.excludes, (std::vector<std::string>{"--out", "--mode"}))
      << "in the order of their definition";
  EXPECT_TRUE(Named(cut, "cell").is_argument);
}

TEST_F(CommandTable, SplitsAFooterIntoParagraphsExitCodesAndLists) {
  const CommandText cut = DescribeCommand(app_).commands.at(0);
  EXPECT_EQ(cut.paragraphs, std::vector<std::string>{"One paragraph of two lines."});
  EXPECT_EQ(cut.exit_codes.at(1), "it broke off");
  ASSERT_EQ(cut.lists.size(), 1u);
  EXPECT_EQ(cut.lists[0].title, "Examples");
  EXPECT_EQ(cut.lists[0].lines, (std::vector<std::string>{"osteon cut demo -o a", "osteon cut demo --dry"}));
}

TEST_F(CommandTable, SeveralExecutablesMakeOneCommand) {
  CLI::App studies{"studies", "osteon-studies"};
  studies.add_subcommand("tune", "finds gains");
  CLI::App* tick = studies.add_subcommand("bench", "measures")->add_subcommand("tick", "times a tick");
  tick->add_option("--ticks", number_, "how many");
  studies.add_subcommand("cut", "announced only");
  const CLI::App* const apps[] = {&app_, &studies};
  const CommandText all = DescribeCommands(apps);
  EXPECT_EQ(all.name, "osteon");
  ASSERT_EQ(all.commands.size(), 3u);
  EXPECT_EQ(all.commands[0].purpose, "cuts bone") << "the one with options counts";
  EXPECT_EQ(all.commands[2].name, "osteon tune");
}

TEST_F(CommandTable, SynopsisNamesWhatIsRequired) {
  const CommandText all = DescribeCommand(app_);
  EXPECT_EQ(Synopsis(all), "osteon [options] [subcommand]");
  EXPECT_EQ(Synopsis(all.commands[0]), "osteon cut --out FILE [options] cell");
  EXPECT_EQ(Synopsis(all.commands[1]), "osteon bench [options] subcommand");
}

TEST(WrapText, KeepsWordsWholeAndCountsCharactersNotBytes) {
  EXPECT_EQ(base::WrapText("one two three", 0, 7), "one two\nthree");
  EXPECT_EQ(base::WrapText("one two three", 4, 11), "one two\n    three");
  EXPECT_EQ(base::WrapText("ä ä ä ä", 0, 7), "ä ä ä ä");
  EXPECT_EQ(base::WrapText("at 1 … 4", 0, 6), "at\n1 … 4") << "a range stays whole";
  EXPECT_EQ(base::WrapText("incomprehensibilities a", 0, 5), "incomprehensibilities\na");
}

TEST_F(CommandTable, HelpListsTheAcceptedWordsAtTheOption) {
  const std::string help = HelpText(DescribeCommand(app_).commands[0], 80);
  EXPECT_NE(help.find("--mode fast|exact"), std::string::npos) << help;
  EXPECT_NE(help.find("how [default fast; not with --dry]"), std::string::npos) << help;
  EXPECT_NE(help.find("how deep [1 … 20; needs --mode]"), std::string::npos) << help;
}

TEST(ManPage, EscapesWhatRoffWouldTakeForARequestOrAnotherCharacter) {
  const CommandText command{.name = "osteon",
                            .purpose = ".it's a - b\\c … ä",
                            .group = "",
                            .options = {},
                            .paragraphs = {},
                            .lists = {},
                            .exit_codes = {},
                            .commands = {}};
  const std::string page = ManPage(command, "1");
  EXPECT_NE(page.find("\\&.it\\(aqs a \\- b\\ec ... \\[u00E4]"), std::string::npos) << page;
  EXPECT_TRUE(std::ranges::all_of(page, [](char c) { return static_cast<unsigned char>(c) < 0x80u; }));
}

TEST_F(CommandTable, TheManualHasASectionForEachSubcommandThatDoesSomething) {
  const std::string page = CommandsPage(DescribeCommand(app_));
  EXPECT_NE(page.find("\n## osteon cut\n"), std::string::npos);
  EXPECT_NE(page.find("\n## osteon bench tick\n"), std::string::npos);
  EXPECT_EQ(page.find("\n## osteon bench\n"), std::string::npos);
  EXPECT_NE(page.find("| `--mode WORD` | how; not with `--dry` | `fast`, `exact` | `fast` |"),
            std::string::npos)
      << page;
}

}  // namespace
}  // namespace osteon::app
