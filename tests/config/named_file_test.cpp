#include "config/reading/named_file.h"

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"

// Tests how a file is found by its path, or by its bare name in a folder ("demo" means
// config/cells/demo.yaml).

namespace osteon::config {
namespace {

using io::test::TemporaryFolder;
using io::test::WriteAll;

TEST(NamedFile, IsFoundByItsPathAndByItsNameInTheFolder) {
  const TemporaryFolder folder;
  WriteAll(folder.path() / "b.yaml", "");
  WriteAll(folder.path() / "a.yaml", "");
  WriteAll(folder.path() / "notes.txt", "");
  const auto b = folder.path() / "b.yaml";
  EXPECT_EQ(FindNamedFile(folder.path(), "b").value(), b);
  EXPECT_EQ(FindNamedFile(folder.path(), "b.yaml").value(), b);
  EXPECT_EQ(FindNamedFile("elsewhere", b.string()).value(), b);
  EXPECT_EQ(YamlNamesIn(folder.path()), "a, b");
  EXPECT_NE(YamlNamesIn("elsewhere").find("OSTEON_ROOT"), std::string::npos) << "a program that was moved";
}

// If a bare name is not found, the error names its path in the folder, with ".yaml". If a name with an ending
// is not found, the error names it unchanged.
TEST(NamedFile, ErrorIsThePathThatWasTried) {
  const TemporaryFolder folder;
  EXPECT_EQ(FindNamedFile(folder.path(), "c").error(), folder.path() / "c.yaml");
  EXPECT_EQ(FindNamedFile(folder.path(), "c.yaml").error(), "c.yaml");
  EXPECT_EQ(FindNamedFile(folder.path(), "").error(), folder.path() / ".yaml");
  // a bare name must not contain a folder
  std::filesystem::create_directory(folder.path() / "inner");
  WriteAll(folder.path() / "inner" / "d.yaml", "");
  EXPECT_FALSE(FindNamedFile(folder.path(), "inner/d"));
  EXPECT_FALSE(FindNamedFile(folder.path() / "inner", "../inner/d"));
  EXPECT_FALSE(FindNamedFile(folder.path(), "inner")) << "a folder is no file";
}

}  // namespace
}  // namespace osteon::config
