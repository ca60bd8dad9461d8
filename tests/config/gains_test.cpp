#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/reading/load.h"

// Tests gains files. The values of a gains file replace the gains of the cell that is loaded with it.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Gains : public testing::Test {
 protected:
  void TearDown() override { fs::remove(file_); }
  // Loads the demo cell together with a gains file of this text.
  CellConfig LoadWith(const std::string& text) const {
    std::ofstream(file_) << text;
    return LoadCell(kDemo, {}, file_);
  }
  // The error of LoadWith for this text. It must name the gains file. "nothing" if the file is accepted.
  std::string ErrorOf(const std::string& text) const {
    try {
      static_cast<void>(LoadWith(text));
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.file(), file_.string());
      return error.what();
    }
    return "nothing";
  }
  const fs::path kDemo = fs::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml";
  const fs::path file_ =
      fs::temp_directory_path() / ("osteon_gains_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml");
};

TEST_F(Gains, ReplaceOnlyTheValuesThatTheFileNames) {
  const CellConfig own = LoadCell(kDemo);
  const CellConfig cell = LoadWith(
      "admittance:\n  mass_kg: [2, 2, 2.5]\n  damping_Ns_per_m: [34, 34, 35]\ncoupling:\n"
      "  stiffness_N_per_mm: 12\n");
  EXPECT_EQ(cell.servo.admittance.mass_kg, Vector3(2, 2, 2.5));
  EXPECT_EQ(cell.servo.admittance.damping_Ns_per_m, Vector3(34, 34, 35));
  EXPECT_DOUBLE_EQ(cell.servo.coupling.max_stiffness_N_per_m, 12e3);
  EXPECT_DOUBLE_EQ(cell.cutting.stiffness_N_per_m, 12e3) << "the simulation is told as well";
  EXPECT_EQ(cell.servo.admittance.inertia_kg_m2, own.servo.admittance.inertia_kg_m2);
  EXPECT_EQ(cell.servo.admittance.damping_Nms_per_rad, own.servo.admittance.damping_Nms_per_rad);
  EXPECT_EQ(cell.servo.coupling.damping_Ns_per_m, own.servo.coupling.damping_Ns_per_m);
  EXPECT_EQ(cell.servo.coupling.fresh_s, own.servo.coupling.fresh_s);
}

TEST_F(Gains, FileMayHoldOneSectionAlone) {
  EXPECT_DOUBLE_EQ(LoadWith("coupling: {damping_share_ratio: 0.1}\n").servo.coupling.damping_share, 0.1);
  EXPECT_DOUBLE_EQ(LoadWith("admittance: {dead_zone_N: 1}\n").servo.admittance.dead_zone_N, 1.0);
}

TEST_F(Gains, ErrorsNameFileLineValueAndWhatIsAccepted) {
  EXPECT_THAT(ErrorOf("admittance:\n  mass_kg: [2, 2, 0.05]\n"),
              HasSubstr(file_.string() + ":2: mass_kg: found 0.05, accepted 0.1 … 50"));
  EXPECT_THAT(ErrorOf("admittance:\n  mass_kg: 2\n"),
              HasSubstr(":2: mass_kg: found 2, accepted a list of 3 numbers 0.1 … 50"));
  EXPECT_THAT(ErrorOf("\nadmittance:\n  mas_kg: [2, 2, 2]\n"),
              HasSubstr(":3: unknown key \"mas_kg\"; did you mean \"mass_kg\"?"));
  EXPECT_THAT(ErrorOf("admitance: {}\n"), HasSubstr(":1: unknown key \"admitance\""));
  EXPECT_THAT(ErrorOf("coupling:\n  fresh_ms: 30\n"), HasSubstr("unknown key \"fresh_ms\""))
      << "how old a model may be is no gain";
  EXPECT_THAT(ErrorOf("coupling: 3\n"), HasSubstr("found 3, accepted a mapping"));
  EXPECT_THROW(static_cast<void>(LoadCell(kDemo, {}, "missing.yaml")), ConfigError);
}

}  // namespace
}  // namespace osteon::config
