#include "config/reading/config_file_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "config/reading/load.h"
#include "tests/io/temporary_folder.h"

// Tests the list of the files from which a configuration is read, and the restriction of these files to one
// folder.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// The files in the tracker's list, relative to config/ and sorted.
std::vector<std::string> NamesOf(const ConfigFileTracker& scope) {
  std::vector<std::string> names;
  for (const ConfigFileTracker::File& file : scope.files())
    names.push_back(file.path.lexically_relative(kConfig.lexically_normal()).generic_string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(ShippedFolder, IsThatOfTheVariableOrBelowTheCurrentFolderOrAboveTheProgram) {
  const io::test::TemporaryFolder folder;
  const fs::path checkout = folder.path() / "checkout", program = checkout / "build/release/app/osteon",
                 elsewhere = folder.path() / "elsewhere";
  fs::create_directories(checkout / "config/cells");
  fs::create_directories(elsewhere);
  EXPECT_EQ(FindShippedFolder("/opt/osteon", checkout, program), "/opt/osteon/config");
  EXPECT_EQ(FindShippedFolder(nullptr, elsewhere, program), checkout / "config");
  EXPECT_EQ(FindShippedFolder(nullptr, checkout, folder.path() / "other/osteon"), checkout / "config");
  EXPECT_EQ(FindShippedFolder(nullptr, elsewhere, "/usr/bin/osteon"), elsewhere / "config")
      << "named in the message that the file is not there";
  EXPECT_EQ(FindShippedFolder(nullptr, elsewhere, ""), elsewhere / "config");
  const fs::path installed = folder.path() / "usr";
  fs::create_directories(installed / "share/osteon/config/cells");
  EXPECT_EQ(FindShippedFolder(nullptr, elsewhere, installed / "bin/osteon"),
            installed / "share/osteon/config");
}

TEST(ConfigFileTracker, RecordsEveryFileOnce) {
  const ConfigFileTracker scope;
  static_cast<void>(LoadCell(kConfig / "cells/demo.yaml"));
  EXPECT_EQ(NamesOf(scope), (std::vector<std::string>{"cells/demo.yaml", "materials/bone.yaml",
                                                      "robots/lbr_iiwa_14_r820.yaml",
                                                      "scenes/acetabulum.yaml", "tools/reamer.yaml"}));
  for (const ConfigFileTracker::File& file : scope.files()) EXPECT_FALSE(file.by_whole_path);
}

TEST(ConfigFileTracker, RecordsMeshesAndImages) {
  const ConfigFileTracker scope;
  static_cast<void>(LoadTool(kConfig / "tools/broach.yaml"));
  static_cast<void>(LoadScene(kConfig / "scenes/acetabulum_density.yaml"));
  EXPECT_EQ(NamesOf(scope),
            (std::vector<std::string>{"images/hip_density.png", "scenes/acetabulum_density.yaml",
                                      "tools/broach.obj", "tools/broach.yaml"}));
}

TEST(ConfigFileTracker, RecordsNothingOutsideItsLifetime) {
  { const ConfigFileTracker scope; }
  static_cast<void>(LoadTool(kConfig / "tools/reamer.yaml"));
  const ConfigFileTracker scope;
  EXPECT_TRUE(scope.files().empty());
}

// A copy of config/. Cells are loaded from it with a tracker that may accept only files below one folder.
class RestrictedToAFolder : public testing::Test {
 protected:
  RestrictedToAFolder() {
    fs::copy(kConfig, folder_.path() / "in", fs::copy_options::recursive);
    text_ = io::test::ReadAll(kConfig / "cells/demo.yaml");
  }
  // Loads the demo cell with this robot file from the folder. Returns the error; empty if there is none.
  std::string Load(const std::string& robot, ConfigFileTracker::Params params) {
    std::string text = text_;
    const std::string name = "lbr_iiwa_14_r820";
    text.replace(text.find(name), name.size(), robot);
    const fs::path cell = folder_.path() / "in/cells/demo.yaml";
    io::test::WriteAll(cell, text);
    const ConfigFileTracker scope(std::move(params));
    try {
      static_cast<void>(LoadCell(cell));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  io::test::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(RestrictedToAFolder, FilesOutsideAreRefused) {
  const std::string outside = (kConfig / "robots/lbr_iiwa_14_r820.yaml").lexically_normal().string();
  EXPECT_EQ(Load(outside, {}), "") << "without a root, anywhere";
  const ConfigFileTracker::Params held{.root = folder_.path() / "in"};
  EXPECT_EQ(Load("../robots/lbr_iiwa_14_r820.yaml", held), "");
  EXPECT_NE(Load(outside, held).find("robot: found " + outside.substr(0, 20)), std::string::npos)
      << Load(outside, held);
  fs::copy_file(outside, folder_.path() / "beside.yaml");
  EXPECT_NE(Load("../../beside.yaml", held).find("accepted a file beside it"), std::string::npos);
}

TEST_F(RestrictedToAFolder, ANameIsFoundBesideTheCellsThenAmongTheShippedFiles) {
  EXPECT_EQ(Load("lbr_iiwa_14_r820", {}), "");
  const ConfigFileTracker::Params held{.root = folder_.path() / "in"};
  EXPECT_EQ(Load("lbr_iiwa_14_r820", held), "");
  fs::rename(folder_.path() / "in/robots", folder_.path() / "robots");
  EXPECT_NE(
      Load("lbr_iiwa_14_r820", held).find("robot: found lbr_iiwa_14_r820, accepted a file's path, or one of"),
      std::string::npos)
      << Load("lbr_iiwa_14_r820", held);
  SetShippedFolder(kConfig);
  EXPECT_EQ(Load("lbr_iiwa_14_r820", {}), "");
  // a recording keeps a copy of the shipped file in a folder of the same kind (robots), which may be anywhere
  // below the recording's folder
  fs::create_directories(folder_.path() / "in/far/away");
  fs::rename(folder_.path() / "robots", folder_.path() / "in/far/away/robots");
  EXPECT_EQ(Load("lbr_iiwa_14_r820", held), "");
}

TEST_F(RestrictedToAFolder, AnAbsolutePathIsFoundInTheFolderThatReplacesIts) {
  const ConfigFileTracker::Params held{.root = folder_.path() / "in", .once_at = "/once/was/here"};
  EXPECT_EQ(Load("/once/was/here/robots/lbr_iiwa_14_r820.yaml", held), "");
  EXPECT_NE(Load("/once/was/../robots/lbr_iiwa_14_r820.yaml", held), "");
}

}  // namespace
}  // namespace osteon::config
