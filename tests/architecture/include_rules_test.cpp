#include "tests/architecture/include_rules.h"
#include "tests/temporary_path.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

// Checks the includes of all files, and which includes the rules of include_rules.txt allow and forbid.

namespace osteon::architecture {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = OSTEON_SOURCE_DIR;
const fs::path kRulesFile = kRoot / "tests/architecture/include_rules.txt";

std::string ReadText(const fs::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Result of CheckText for one line in a file at `path`; empty if the line is allowed.
std::string Verdict(const std::string& path, const std::string& line) {
  const std::vector<Violation> violations = CheckText(ReadRules(kRulesFile), path, line);
  return violations.empty() ? "" : violations.front().text;
}

TEST(IncludeRules, AreKeptByTheWholeTree) {
  const std::vector<Rule> rules = ReadRules(kRulesFile);
  const std::vector<std::string> files = SourceFiles(kRoot);
  // The tree has far more than 20 files. A smaller number means that the search is broken.
  ASSERT_GT(files.size(), 20u);
  for (const std::string& file : files) {
    for (const Violation& violation : CheckText(rules, file, ReadText(kRoot / file))) {
      ADD_FAILURE() << violation.file << ":" << violation.line << ": " << violation.text;
    }
  }
}

// A test that counts allocations without checking the count can never fail. So tests must use
// CheckedNoAllocScope.
TEST(IncludeRules, TestsCountAllocationsInACheckedScopeOnly) {
  const std::string kChecked = "tests/base/checked_no_alloc_scope.h";
  int users = 0;
  for (const std::string& file : SourceFiles(kRoot)) {
    if (!file.starts_with("tests/") || file == kChecked) continue;
    const std::string text = ReadText(kRoot / file);
    EXPECT_EQ(text.find("#include \"base/no_alloc_scope.h\""), std::string::npos)
        << file << " includes base/no_alloc_scope.h, accepted " << kChecked;
    users += text.find("#include \"" + kChecked + "\"") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(users, 40) << "the search is broken";
}

TEST(IncludeRules, NameFoldersAndHeadersThatExist) {
  for (const Rule& rule : ReadRules(kRulesFile)) {
    std::vector<std::string> paths = rule.allowed;
    if (rule.kind == Rule::Kind::kFolder) paths.insert(paths.end(), rule.names.begin(), rule.names.end());
    for (const std::string& path : paths) {
      EXPECT_TRUE(path == "all" || fs::exists(kRoot / path)) << "no such folder or header: " << path;
    }
  }
}

TEST(IncludeRules, ForbidIncludesOfHigherLayers) {
  EXPECT_NE(Verdict("kinematics/x.h", "#include \"control/ports.h\""), "");
  EXPECT_NE(Verdict("safety/x.h", "#include \"control/ports.h\""), "");
  EXPECT_NE(Verdict("io/fri/x.cpp", "#include \"hil/arm.h\""), "");
  EXPECT_NE(Verdict("base/x.h", "#include \"kinematics/spatial.h\""), "");
  EXPECT_NE(Verdict("gpu/x.cpp", "  #  include \"app/main.h\"  // spaced"), "");
}

TEST(IncludeRules, AllowSingleHeadersOfOtherFolders) {
  EXPECT_EQ(Verdict("control/loop/x.h", "#include \"simulation/contact/contact_model.h\""), "");
  EXPECT_NE(Verdict("control/x.h", "#include \"simulation/bone/material.h\""), "");
  EXPECT_EQ(Verdict("io/x.h", "#include \"control/ports.h\""), "");
  EXPECT_NE(Verdict("io/x.h", "#include \"control/ports.hpp\""), "");
}

TEST(IncludeRules, LetTheGuardIncludeParametersOnly) {
  for (const char* file : {"guard_kinematics.cpp", "guard_zone.cpp", "guard_monitor.h", "guard_rules.cpp"}) {
    const std::string path = std::string("safety/") + file;
    EXPECT_EQ(Verdict(path, "#include \"kinematics/chain_params.h\""), "") << file;
    for (const char* header : {"kinematics/serial_chain.h", "kinematics/lbr_arm.h", "kinematics/sin_cos.h",
                               "safety/limits.h", "safety/joint_guard.h"})
      EXPECT_NE(Verdict(path, std::string("#include \"") + header + "\""), "") << file << header;
  }
}

TEST(IncludeRules, LetEveryFolderIncludeTheRealTimeHeaders) {
  for (const char* folder : {"kinematics", "simulation", "gpu", "safety", "control", "io", "hil", "config",
                             "report", "session", "app"}) {
    EXPECT_EQ(Verdict(std::string(folder) + "/x.cpp", "#include \"base/marker.h\""), "") << folder;
  }
}

TEST(IncludeRules, KeepVulkanYamlAndSocketsInTheirFolders) {
  EXPECT_EQ(Verdict("gpu/x.cpp", "#include <vulkan/vulkan.h>"), "");
  EXPECT_NE(Verdict("app/x.cpp", "#include <vulkan/vulkan.h>"), "");
  EXPECT_EQ(Verdict("config/x.cpp", "#include <yaml-cpp/yaml.h>"), "");
  EXPECT_NE(Verdict("app/x.cpp", "#include <yaml-cpp/yaml.h>"), "");
  EXPECT_EQ(Verdict("hil/x.cpp", "#include <sys/socket.h>"), "");
  EXPECT_NE(Verdict("control/x.cpp", "#include <sys/socket.h>"), "");
  EXPECT_NE(Verdict("app/x.cpp", "#include \"netinet/in.h\""), "");
  EXPECT_EQ(Verdict("control/x.cpp", "#include <sys/mman.h>"), "");
  EXPECT_NE(Verdict("kinematics/x.cpp", "#include <fmt/format.h>"), "");
}

TEST(IncludeRules, RefuseFoldersAndLibrariesWithoutARule) {
  EXPECT_NE(Verdict("control/x.cpp", "#include <boost/asio.hpp>"), "");
  EXPECT_NE(Verdict("control/x.cpp", "#include <curl.h>"), "");
  EXPECT_NE(Verdict("utils/x.cpp", ""), "") << "a folder without a rule";
  EXPECT_NE(Verdict("control/x.cpp", "#include \"../safety/fault.h\""), "") << "a way round the paths";
  EXPECT_EQ(Verdict("control/x.cpp", "#include <vector>"), "");
}

TEST(IncludeRules, NameFileLineAndReasonOfAViolation) {
  const std::vector<Violation> violations =
      CheckText(ReadRules(kRulesFile), "safety/x.h", "#pragma once\n\n#include \"control/ports.h\"\n");
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].file, "safety/x.h");
  EXPECT_EQ(violations[0].line, 3);
  EXPECT_NE(violations[0].text.find("never sees what it supervises"), std::string::npos)
      << violations[0].text;
}

TEST(IncludeRules, RejectALineWithoutAReason) {
  const fs::path file = TemporaryPath("osteon_rules_without_reason.txt");
  std::ofstream(file) << "# comment\n\nfolder a : b\n";
  try {
    ReadRules(file);
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(".txt:3: found 'folder a : b'"), std::string::npos)
        << error.what();
  }
  fs::remove(file);
}

}  // namespace
}  // namespace osteon::architecture
