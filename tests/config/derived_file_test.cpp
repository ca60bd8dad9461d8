#include "config/reading/strict/derived_file.h"

#include <gtest/gtest.h>

#include "tests/config/cell_text.h"
#include "tests/io/temporary_folder.h"

// Tests WriteDerived, which writes a cell with some changed values into a single file.

namespace osteon::config {
namespace {

const std::filesystem::path kCells = OSTEON_SOURCE_DIR "/config/cells";

// The file is written into another folder than the cell's, and must load there.
TEST(DerivedFile, ChangesTheGivenValuesAndNothingElse) {
  const io::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "derived.yaml";
  WriteDerived(
      kCells / "thin_plate.yaml",
      {{"limits.max_force_N", "120"}, {"plc.guard", "true"}, {"guard", "{port: 30209, silence_ms: 80}"}},
      file);
  const CellConfig derived = LoadCell(file), shipped = LoadCell(kCells / "thin_plate.yaml");
  EXPECT_DOUBLE_EQ(derived.servo.wrench.max_force_N, 120.0);
  EXPECT_DOUBLE_EQ(shipped.servo.wrench.max_force_N, 150.0);
  EXPECT_TRUE(derived.simulated_plc->logic.guard);
  ASSERT_TRUE(derived.guard);
  EXPECT_EQ(derived.guard->port, 30209);
  EXPECT_DOUBLE_EQ(derived.guard->silence_s, 0.08);
  EXPECT_EQ(derived.tool.tool.name, shipped.tool.tool.name);
  EXPECT_EQ(derived.servo.period_s, shipped.servo.period_s);
  EXPECT_EQ(derived.servo.wrench.max_torque_Nm, shipped.servo.wrench.max_torque_Nm);
  EXPECT_EQ(derived.link.port, shipped.link.port);
}

TEST(DerivedFile, NamesAFileThatItCannotWrite) {
  const io::test::TemporaryFolder folder;
  try {
    WriteDerived(kCells / "thin_plate.yaml", {}, folder.path() / "nowhere" / "a.yaml");
    FAIL() << "no folder, no file";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/a.yaml"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace osteon::config
