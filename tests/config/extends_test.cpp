#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/config_file_tracker.h"
#include "config/reading/load.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/reader.h"
#include "tests/io/temporary_folder.h"

// Tests `extends`: a file names another file as its base, and contains only the values that differ from the
// base.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Extends : public testing::Test {
 protected:
  Extends() { SetShippedFolder(fs::path(OSTEON_SOURCE_DIR) / "config"); }
  fs::path Write(const std::string& name, const std::string& text) const {
    io::test::WriteAll(folder_.path() / name, text);
    return folder_.path() / name;
  }
  // The error of loading a cell of this text; empty if it is accepted.
  std::string Refusal(const std::string& text, const std::string& name = "my.yaml") const {
    try {
      static_cast<void>(LoadCell(Write(name, text)));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  io::test::TemporaryFolder folder_;
};

TEST_F(Extends, AShortCellHasItsOwnValuesAndThoseOfItsBase) {
  const fs::path mine =
      Write("my.yaml",
            "extends: demo\ntool_diameter_mm: 54\nlimits: {max_force_N: 80, max_stored_J: 0.5}\n"
            "zones: [{point: apex, keep: in, shape: sphere, at_mm: [620, 0, 260], radius_mm: "
            "150}]\nbase_in_world: {position_mm: [10, 0, 0]}\n");
  const CellConfig cell = LoadCell(mine), demo = LoadCell(ShippedFolder() / "cells/demo.yaml");
  EXPECT_EQ(cell.tool.tool.name, "hemispherical reamer 54 mm");
  EXPECT_DOUBLE_EQ(cell.servo.wrench.max_force_N, 80.0);
  EXPECT_EQ(cell.servo.wrench.max_torque_Nm, demo.servo.wrench.max_torque_Nm);
  EXPECT_DOUBLE_EQ(cell.X_WB.translation().x(), 0.01);
  EXPECT_EQ(cell.X_WB.linear(), demo.X_WB.linear());
  EXPECT_EQ(demo.servo.workspace.zones.size(), 2u);
  EXPECT_EQ(cell.servo.workspace.zones.size(), 1u) << "a list is replaced as a whole";
  EXPECT_EQ(cell.robot.name, demo.robot.name);
}

TEST_F(Extends, APathStartsAtTheFileAndANameMeansACellBesideIt) {
  Write("base.yaml", io::test::ReadAll(ShippedFolder() / "cells/demo.yaml"));
  EXPECT_EQ(Refusal("extends: base.yaml\n"), "");
  EXPECT_EQ(Refusal("extends: base\n"), "");
  EXPECT_EQ(Refusal("extends: demo\n", "demo.yaml"), "") << "its own name means the shipped cell";
}

TEST_F(Extends, KeysOfTheBaseCanBeRemoved) {
  const std::string script =
      "script: {kind: drilling, duration_s: 5, push_force_N: 50, approach_force_N: 10, full_force_depth_mm: "
      "2, peck_count: 1, peck_height_mm: 1, retract_height_mm: 10, max_target_mm_per_s: 50}\n";
  EXPECT_THAT(Refusal("extends: demo\n" + script), HasSubstr("unknown key"));
  EXPECT_EQ(Refusal("extends: demo\nremove: [script, vibration, simulated_arm.dynamic.mount]\n" + script),
            "");
  EXPECT_THAT(Refusal("extends: demo\nremove: [script, start.arm_angel_deg]\n"),
              AllOf(HasSubstr("my.yaml:2: remove: found start.arm_angel_deg, accepted a key that "),
                    HasSubstr("cells/demo.yaml has")));
  EXPECT_THAT(Refusal("extends: demo\nremove: script\n"),
              HasSubstr("my.yaml:2: remove: found script, accepted a list"));
  EXPECT_THAT(Refusal("remove: [script]\n"), HasSubstr("my.yaml:1: remove: found without extends"));
}

TEST_F(Extends, ABaseThatExtendsAnotherFileIsRefused) {
  EXPECT_THAT(Refusal("extends: molar\n"),
              AllOf(HasSubstr("my.yaml:1: extends: found "),
                    HasSubstr("cells/molar.yaml, which extends demo itself ("),
                    HasSubstr("cells/molar.yaml:3), accepted a file that extends none: one level")));
}

TEST_F(Extends, CyclesAreRefusedWithTheNamesOfBothFiles) {
  EXPECT_THAT(Refusal("extends: my.yaml\n"),
              AllOf(HasSubstr("my.yaml:1: extends: found "), HasSubstr("which is this file")));
  Write("other.yaml", "extends: my\n");
  EXPECT_THAT(Refusal("extends: other\n"),
              AllOf(HasSubstr("my.yaml:1: extends: found "), HasSubstr("other.yaml:1")));
}

TEST_F(Extends, AMissingBaseIsRefusedWithTheExistingOnes) {
  EXPECT_THAT(Refusal("extends: dmeo\n"),
              AllOf(HasSubstr("my.yaml:1: extends: found dmeo, accepted a file's path, or "
                              "one of "),
                    HasSubstr("demo, femoral_canal")));
}

TEST_F(Extends, ErrorsNameTheFileOfTheValueAndTheOneThatExtendsIt) {
  EXPECT_THAT(Refusal("extends: demo\n\nlimits:\n  max_force_N: 2000\n"),
              HasSubstr("my.yaml:4: max_force_N: found 2000, accepted"));
  EXPECT_THAT(Refusal("extends: demo\nlimits:\n  max_fore_N: 80\n"),
              HasSubstr("my.yaml:3: unknown key \"max_fore_N\"; did you mean \"max_force_N\"?"));
  EXPECT_THAT(
      Refusal("extends: demo\ncutting: {normal_enlargement_um: 100}\n"),
      AllOf(HasSubstr("cells/demo.yaml:"), HasSubstr("model_sight_mm: found 0.5, accepted at most 0.4"),
            HasSubstr("my.yaml extends it: set the value there)")));
}

TEST_F(Extends, AScenariosOverridesWinOverBothFiles) {
  const fs::path mine = Write("my.yaml", "extends: demo\nlimits: {max_force_N: 80, max_stored_J: 0.5}\n");
  Overlay overlay(mine);
  overlay.Set("limits.max_force_N=90", "--set");
  overlay.Set("limits.max_torque_Nm=9", "--set");
  overlay.Set("scene.packing.spacing_mm=3", "--set");
  const CellConfig cell = LoadCell(mine);
  overlay.Finish();
  EXPECT_DOUBLE_EQ(cell.servo.wrench.max_force_N, 90.0);
  EXPECT_DOUBLE_EQ(cell.servo.wrench.max_torque_Nm, 9.0);
  EXPECT_DOUBLE_EQ(cell.scene.packing.lattice.finest_m, 0.003);
}

TEST_F(Extends, TheBaseIsAmongTheRecordedFiles) {
  const fs::path mine = Write("my.yaml", "extends: demo\n");
  const ConfigFileTracker scope;
  static_cast<void>(LoadCell(mine));
  ASSERT_EQ(scope.files().size(), 6u) << "cell, base, robot, tool, scene, materials";
  EXPECT_EQ(scope.files()[1].path, fs::absolute(ShippedFolder() / "cells/demo.yaml").lexically_normal());
}

}  // namespace
}  // namespace osteon::config
