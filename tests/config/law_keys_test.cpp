#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "tests/config/cell_text.h"

// Tests the choice of the control law. A cell names one law, admittance or impedance, and its simulated arm
// is set up for that law.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const fs::path kCells = fs::path(OSTEON_SOURCE_DIR) / "config/cells";

TEST(LawKeys, ImpedanceReachesLoopAndSimulatedArm) {
  const CellConfig cell = LoadCell(kCells / "thin_plate_impedance.yaml");
  EXPECT_EQ(cell.servo.law, control::Law::kImpedance);
  EXPECT_EQ(cell.servo.impedance.damping_Ns_per_m, Vector3(40.0, 40.0, 40.0));
  EXPECT_EQ(cell.servo.impedance.follow_s, 0.005);
  EXPECT_EQ(cell.simulated.fri.command_mode, control::CommandMode::kWrench);
  EXPECT_EQ(cell.simulated.fri.control_mode, control::ControlMode::kCartesianImpedance);
  const CellConfig torque =
      LoadText(With(CellText("thin_plate_impedance"), "\n  overlay: wrench", "\n  overlay: torque"));
  EXPECT_EQ(torque.simulated.fri.command_mode, control::CommandMode::kTorque);
  EXPECT_EQ(torque.simulated.fri.control_mode, control::ControlMode::kJointImpedance);
  EXPECT_EQ(LoadCell(kCells / "demo.yaml").servo.law, control::Law::kAdmittance);
}

// A cell is refused if it has a second law, an arm level without impedance control, an overlay of positions,
// or an impedance law over RSI.
TEST(LawKeys, ACellHasOneLawThatItsArmSupports) {
  const std::string cell = CellText("thin_plate_impedance"), admittance = CellText("thin_plate");
  // position of the line break at the end of the section that begins at `section`
  const auto end_of = [](const std::string& text, std::size_t section) {
    std::size_t at = section;
    do at = text.find('\n', at + 1);
    while (text[at + 1] == ' ');
    return at;
  };
  const std::size_t from = admittance.find("\nadmittance:"), to = end_of(admittance, from);
  EXPECT_THAT(Refusal(cell + admittance.substr(from, to - from) + "\n"), HasSubstr("admittance"));
  EXPECT_THAT(Refusal(With(cell, "level: dynamic", "level: servo")),
              AllOf(HasSubstr("level"), HasSubstr("dynamic")));
  EXPECT_THAT(Refusal(With(cell, "\n  overlay: wrench", "\n  overlay: position")), HasSubstr("wrench"));
  // an arm over RSI accepts only positions, so the impedance law is refused
  const std::size_t law = cell.find("\nimpedance:"), law_end = end_of(cell, law);
  std::string kr = CellText("kr_16_thin_plate");
  const std::size_t old = kr.find("\nadmittance:"), old_end = end_of(kr, old);
  kr.replace(old, old_end - old, cell.substr(law, law_end - law));
  EXPECT_THAT(Refusal(kr), AllOf(HasSubstr("impedance"), HasSubstr("rsi")));
}

}  // namespace
}  // namespace osteon::config
