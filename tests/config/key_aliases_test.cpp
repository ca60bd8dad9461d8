#include "config/reading/strict/key_aliases.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/config_file_tracker.h"
#include "config/reading/load.h"
#include "config/reading/strict/derived_file.h"
#include "config/reading/strict/overlay.h"
#include "tests/io/temporary_folder.h"

// Tests renamed keys. Files and overrides may still use the old name.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class KeyAliases : public testing::Test {
 protected:
  KeyAliases() { SetShippedFolder(fs::path(OSTEON_SOURCE_DIR) / "config"); }
  // Writes my.yaml with this text, and returns its path.
  fs::path Write(const std::string& text) const {
    io::test::WriteAll(folder_.path() / "my.yaml", text);
    return folder_.path() / "my.yaml";
  }
  io::test::TemporaryFolder folder_;
};

TEST_F(KeyAliases, AnOldNameInAFileSetsTheSameValue) {
  const CellConfig cell = LoadCell(Write("extends: demo\npassivity: {least_speed_mm_per_s: 7}\n"));
  EXPECT_DOUBLE_EQ(cell.servo.stabilisers.passivity.min_speed_m_per_s, 7e-3);
}

TEST_F(KeyAliases, AnOverrideMayUseEitherName) {
  for (const std::string name : {"least_wall_mm", "min_wall_mm"}) {
    const fs::path mine = Write("extends: demo\n");
    Overlay overlay(mine);
    overlay.Set("scene.events." + name + "=3.5", "--set");
    EXPECT_DOUBLE_EQ(LoadCell(mine).scene.events.min_wall_m, 3.5e-3) << name;
    EXPECT_NO_THROW(overlay.Finish());
  }
}

TEST_F(KeyAliases, BothNamesInOneMappingAreRefused) {
  try {
    static_cast<void>(
        LoadCell(Write("extends: demo\npassivity:\n  min_speed_mm_per_s: 5\n  least_speed_mm_per_s: 7\n")));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("my.yaml:4: key \"min_speed_mm_per_s\" again"),
                                    HasSubstr("\"least_speed_mm_per_s\""), HasSubstr("first in line 3")));
  }
}

TEST_F(KeyAliases, AFileDerivedWithBothNamesHasTheKeyOnce) {
  const fs::path written = folder_.path() / "written.yaml";
  WriteDerived(Write("extends: demo\nsensor_bias: {most_N: 8}\n"), {{"sensor_bias.most_Nm", "1.5"}}, written);
  const CellConfig cell = LoadCell(written);
  EXPECT_DOUBLE_EQ(cell.servo.sensor_bias.max_bias_N, 8.0);
  EXPECT_DOUBLE_EQ(cell.servo.sensor_bias.max_bias_Nm, 1.5);
}

TEST(KeyAlias, AnOldNameMapsToItsNewOneAndANewNameToItself) {
  for (const KeyAlias& alias : config::KeyAliases()) {
    EXPECT_EQ(CurrentKey(std::string(alias.old_name)), alias.name);
    EXPECT_EQ(CurrentKey(std::string(alias.name)), alias.name);
  }
}

}  // namespace
}  // namespace osteon::config
