#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "app/cli/help/help_text.h"
#include "base/text.h"
#include "tests/app/command.h"

// The manual, the completion and the help of the built command.

namespace osteon::app {
namespace {

using io::test::ReadAll;
using io::test::WriteAll;

// Runs a shell command. @returns its standard output and standard error together.
std::string Shell(const std::string& command) {
  std::string out;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return "popen failed";
  std::array<char, 4096> bytes{};
  for (std::size_t size; (size = fread(bytes.data(), 1, bytes.size(), pipe)) > 0;)
    out.append(bytes.data(), size);
  pclose(pipe);
  return out;
}

bool IsProgram(const std::string& name) { return !Shell("command -v " + name).empty(); }

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Manual : public testing::Test {
 protected:
  // Runs `osteon …`, which must succeed. @returns its standard output.
  std::string Output(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& environment = {}) {
    const CommandResult run = RunCommand(folder_.path(), arguments, environment);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out;
  }
  // The table of all subcommands, read from the command's JSON.
  nlohmann::json Table() {
    Output({"manual", "--json", "manual.json"});
    return ReadJson(folder_.path() / "manual.json");
  }
  // Calls `each` for a command and for all its subcommands, recursively.
  static void ForEachCommand(const nlohmann::json& command,
                             const std::function<void(const nlohmann::json&)>& each) {
    each(command);
    for (const nlohmann::json& sub : command.at("commands")) ForEachCommand(sub, each);
  }

  TemporaryFolder folder_;
};

TEST_F(Manual, DocsCommandsPageIsWhatTheCommandWrites) {
  Output({"manual", "--markdown", "commands.md"});
  EXPECT_TRUE(ReadAll(folder_.path() / "commands.md") ==
              ReadAll(std::filesystem::path(OSTEON_SOURCE_DIR) / "docs/commands.md"))
      << "write it anew: osteon manual --markdown docs/commands.md";
}

TEST_F(Manual, TheManPageGivesNoRoffWarnings) {
  const bool mandoc = IsProgram("mandoc"), groff = IsProgram("groff");
  if (!mandoc && !groff) GTEST_SKIP() << "neither mandoc nor groff is here (packages.txt: groff-base)";
  const std::string page = (folder_.path() / "osteon.1").string();
  Output({"manual", "--man", "osteon.1"});
  EXPECT_EQ(ReadAll(page), Output({"manual"}));
  if (groff) {
    EXPECT_EQ(Shell("groff -man -ww -Tascii -z '" + page + "'"), "");
    const std::string shown = Shell("groff -man -ww -Tascii -P-cbou '" + page + "'");
    EXPECT_NE(shown.find("osteon bench frame"), std::string::npos);
  }
  if (mandoc) {
    // the manual page contains no date, so the same sources always give the same page
    for (const std::string& line : Lines(Shell("mandoc -Tlint -W warning '" + page + "'")))
      EXPECT_NE(line.find("missing date"), std::string::npos) << line;
  }
}

TEST_F(Manual, EveryOptionHasHelpAndAKindOfValue) {
  const nlohmann::json table = Table();
  EXPECT_EQ(table.at("schema"), "osteon.manual/1");
  int options = 0;
  ForEachCommand(table, [&](const nlohmann::json& command) {
    for (const nlohmann::json& option : command.at("options")) {
      SCOPED_TRACE(command.at("name").get<std::string>() + " " +
                   option.at("names").back().get<std::string>());
      EXPECT_NE(option.at("help"), "");
      // every option's help must describe its value, by Option::type_name or by the accepted words; only
      // --reason accepts any text
      if (option.at("names").back() != "--reason") {
        EXPECT_NE(option.at("value"), "TEXT");
      }
      ++options;
    }
  });
  EXPECT_GT(options, 150);
}

TEST_F(Manual, HelpFitsTheTerminal) {
  ForEachCommand(Table(), [&](const nlohmann::json& command) {
    std::istringstream name(command.at("name").get<std::string>());
    std::vector<std::string> words;
    for (std::string word; name >> word;) words.push_back(word);
    words.erase(words.begin());  // removes "osteon"
    words.emplace_back("--help");
    for (const std::size_t width : {80u, 120u}) {
      const std::string help = Output(words, {"COLUMNS=" + std::to_string(width)});
      for (const std::string& line : Lines(help))
        EXPECT_LE(base::ColumnsOf(line), width) << command.at("name") << line;
      EXPECT_NE(help.find("Examples:"), std::string::npos) << command.at("name");
    }
  });
}

// Asks bash, with the completion script loaded, how it completes the last word of a command line.
class BashCompletionTest : public Manual {
 protected:
  BashCompletionTest() { WriteAll(script_, Output({"completion", "bash"})); }

  std::vector<std::string> Offers(const std::string& words) {
    const std::string ask =
        "source '" + script_.string() + "'; COMP_WORDS=(" + words +
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _osteon; printf '%s\\n' \"${COMPREPLY[@]}\"";
    WriteAll(folder_.path() / "ask.sh", ask);
    return Lines(Shell("cd '" + folder_.path().string() +
                       "' && OSTEON_ROOT='" OSTEON_SOURCE_DIR "' bash --norc ask.sh"));
  }
  bool IsOffered(const std::string& words, const std::string& offer) {
    const std::vector<std::string> all = Offers(words);
    return std::find(all.begin(), all.end(), offer) != all.end();
  }

  std::filesystem::path script_ = folder_.path() / "osteon.bash";
};

TEST_F(BashCompletionTest, CompletesSubcommandsOfTheCommandAndOfTheLauncher) {
  EXPECT_EQ(Offers("osteon de"), std::vector<std::string>{"demo"});
  EXPECT_EQ(Offers("./osteon bench ki"), std::vector<std::string>{"kinematics"});
  EXPECT_EQ(Offers("./osteon tes"), std::vector<std::string>{"test"});
  EXPECT_EQ(Offers("osteon --config-root demo dem"), std::vector<std::string>{"demo"})
      << "the first is a value";
}

TEST_F(BashCompletionTest, CompletesOptionsAndTheirWords) {
  EXPECT_EQ(Offers("osteon demo --en"), std::vector<std::string>{"--engine"});
  EXPECT_EQ(Offers("osteon demo --engine ''"),
            (std::vector<std::string>{"auto", "vulkan", "cpu", "reference"}));
  EXPECT_EQ(Offers("osteon demo --engine = r"), std::vector<std::string>{"reference"});
  EXPECT_TRUE(IsOffered("osteon bench frame --method ''", "voxel"));
  EXPECT_TRUE(IsOffered("osteon faults ''", "--markdown")) << "nothing but options can stand here";
  EXPECT_FALSE(IsOffered("osteon doctor --s", "--engine"));
  EXPECT_EQ(Offers("osteon completion ''"), (std::vector<std::string>{"bash", "zsh", "fish"}));
}

TEST_F(BashCompletionTest, CompletesNamesBelowConfigAndFiles) {
  WriteAll(folder_.path() / "mine.yaml", "");
  EXPECT_EQ(Offers("osteon demo --cell mo"), std::vector<std::string>{"molar"});
  EXPECT_EQ(Offers("osteon run mo"), std::vector<std::string>{"molar"});
  EXPECT_EQ(Offers("osteon doctor mo"), std::vector<std::string>{"molar"});
  EXPECT_EQ(Offers("osteon run min"), std::vector<std::string>{"mine.yaml"});
  EXPECT_EQ(Offers("osteon run demo --tool pear"), std::vector<std::string>{"pear_burr"});
  EXPECT_EQ(Offers("osteon plan thin"), std::vector<std::string>{"thin_plate"});
  EXPECT_EQ(Offers("osteon regress reaming_l"), std::vector<std::string>{"reaming_lbr"});
  EXPECT_TRUE(Offers("osteon demo --seconds min").size() <= 1) << "a number is not a file";
  std::filesystem::create_directories(folder_.path() / "own/cells");
  WriteAll(folder_.path() / "own/cells/elbow.yaml", "");
  EXPECT_EQ(Offers("osteon --config-root own run el"), std::vector<std::string>{"elbow"});
}

TEST_F(BashCompletionTest, CompletesNamesOfAnInstallation) {
  for (const char* below : {"usr/bin", "usr/share/osteon/config/cells"})
    std::filesystem::create_directories(folder_.path() / below);
  WriteAll(folder_.path() / "usr/bin/osteon", "");
  WriteAll(folder_.path() / "usr/share/osteon/config/cells/elbow.yaml", "");
  EXPECT_EQ(Offers("usr/bin/osteon run el"), std::vector<std::string>{"elbow"});
}

TEST_F(Manual, CompletionScriptsHaveNoSyntaxErrors) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    WriteAll(folder_.path() / shell, Output({"completion", shell}));
    if (IsProgram(shell)) {
      EXPECT_EQ(Shell(shell + " -n '" + (folder_.path() / shell).string() + "'"), "") << shell;
    }
  }
  if (IsProgram("shellcheck")) {
    EXPECT_EQ(Shell("shellcheck -s bash '" + (folder_.path() / "bash").string() + "'"), "");
  }
}

TEST_F(Manual, CompletionForAnUnknownShellIsRefused) {
  const CommandResult run = RunCommand(folder_.path(), {"completion", "tcsh"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("found tcsh, accepted bash, zsh, fish"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace osteon::app
