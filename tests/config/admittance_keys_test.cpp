#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/sections/read_gains.h"
#include "tests/config/cell_text.h"

// Tests a cell's keys for the virtual tool's centre and locked axes, and for the compensation of the tool's
// inertia. Also tests gains that are read again during a run.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class AdmittanceKeys : public testing::Test {
 protected:
  void TearDown() override {
    fs::remove(cell_);
    fs::remove(gains_);
  }
  // Loads a cell from its text. If `gains` is not empty, it is the text of the cell's gains file.
  CellConfig LoadText(const std::string& yaml, const std::string& gains = "") const {
    std::ofstream(cell_) << yaml;
    if (gains.empty()) return LoadCell(cell_);
    std::ofstream(gains_) << gains;
    return LoadCell(cell_, {}, gains_);
  }
  // The error of loading such a cell; "nothing" if it is accepted.
  std::string Refusal(const std::string& yaml, const std::string& gains = "") const {
    try {
      static_cast<void>(LoadText(yaml, gains));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "nothing";
  }
  // Replaces the text of the gains file and reads it again, as a running cell does.
  control::Gains ReadGains(const CellConfig& cell, const std::string& text) const {
    std::ofstream(gains_) << text;
    return ReadGainsAgain(gains_, cell.servo.law, cell.own_gains, cell.servo.coupling.max_stiffness_N_per_m);
  }
  std::string ReadGainsRefusal(const CellConfig& cell, const std::string& text) const {
    try {
      static_cast<void>(ReadGains(cell, text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "nothing";
  }
  // The text of a shipped cell, with a line added to one section.
  static std::string With(const std::string& section, const std::string& line,
                          const char* name = "thin_plate") {
    std::string yaml = CellText(name);
    const std::size_t at = yaml.find("\n" + section + ":\n");
    if (at == std::string::npos) throw std::logic_error("the cell has changed: " + section);
    return yaml.insert(at + section.size() + 3, "  " + line + "\n");
  }
  // The name of a temporary file that no other test or process uses.
  static std::string UniqueName(const char* what) {
    return std::string("osteon_") + what + "_" + std::to_string(::getpid()) + "_" +
           testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml";
  }
  const fs::path cell_ = fs::temp_directory_path() / UniqueName("keys");
  const fs::path gains_ = fs::temp_directory_path() / UniqueName("laid");
};

TEST_F(AdmittanceKeys, CentreAndLockedAxesReachTheLaw) {
  const CellConfig cell = LoadText(With("admittance", "centre_m: [0, 0.01, -0.2]\n  locked: [x, y, rx, rz]"));
  EXPECT_EQ(cell.servo.admittance.centre_T_m, Vector3(0.0, 0.01, -0.2));
  EXPECT_EQ(cell.servo.admittance.locked, (std::array<bool, 6>{true, true, false, true, false, true}));
  const CellConfig plain = LoadText(CellText("thin_plate"));
  EXPECT_EQ(plain.servo.admittance.centre_T_m, Vector3::Zero());
  EXPECT_EQ(plain.servo.admittance.locked, (std::array<bool, 6>{}));
}

TEST_F(AdmittanceKeys, AnUnknownAxisIsRefusedWithTheKnownOnes) {
  EXPECT_THAT(
      Refusal(With("admittance", "locked: [x, yaw]")),
      AllOf(HasSubstr("locked: found yaw"), HasSubstr("accepted a list of any of x, y, z, rx, ry, rz")));
  EXPECT_THAT(Refusal(With("admittance", "locked: [x, y, x]")), HasSubstr("none twice"));
  EXPECT_THAT(Refusal(With("admittance", "locked: x")), HasSubstr("accepted a list of any of"));
  EXPECT_THAT(Refusal(With("admittance", "centre_m: [0, 3, 0]")), HasSubstr("centre_m: found 3"));
}

TEST_F(AdmittanceKeys, LockedAxesAreRefusedForTheImpedanceLaw) {
  EXPECT_THAT(Refusal(With("impedance", "locked: [x]", "thin_plate_impedance")),
              AllOf(HasSubstr("locked: found with the impedance law"), HasSubstr("accepted in admittance")));
}

TEST_F(AdmittanceKeys, AdmittanceGainsAreRefusedForTheImpedanceLaw) {
  const std::string cell = CellText("thin_plate_impedance");
  EXPECT_THAT(Refusal(cell, "admittance:\n  mass_kg: [2, 2, 2]\n"),
              AllOf(HasSubstr(gains_.string() + ":1: admittance"), HasSubstr("impedance law"),
                    HasSubstr("accepted coupling alone")));
  EXPECT_EQ(LoadText(cell, "coupling: {damping_share_ratio: 0.1}\n").servo.coupling.damping_share, 0.1);
}

TEST_F(AdmittanceKeys, CentreAndLockedAxesAreNoGains) {
  const std::string cell = CellText("thin_plate");
  EXPECT_THAT(Refusal(cell, "admittance:\n  locked: [x]\n"), HasSubstr("unknown key \"locked\""));
  EXPECT_THAT(Refusal(cell, "admittance:\n  centre_m: [0, 0, 0]\n"), HasSubstr("unknown key \"centre_m\""));
}

TEST_F(AdmittanceKeys, TheToolsInertiaIsCompensatedOnlyOnRequest) {
  const CellConfig cell = LoadText(With("force_sensor", "inertia_share_ratio: 0.6\n  acceleration_hz: 20"));
  EXPECT_EQ(cell.servo.sensor.inertia_share, 0.6);
  EXPECT_EQ(cell.servo.sensor.acceleration_hz, 20.0);
  EXPECT_GT(Matrix3(cell.servo.sensor.tool_inertia_F).trace(), 0.0) << "the tool's own";
  EXPECT_EQ(LoadText(CellText("thin_plate")).servo.sensor.inertia_share, 0.0);
  EXPECT_THAT(Refusal(With("force_sensor", "inertia_share_ratio: 1.2")),
              HasSubstr("inertia_share_ratio: found 1.2, accepted 0 … 1"));
  EXPECT_TRUE(LoadText(With("simulated_arm", "sensor_feels_inertia: true")).simulated.sensor_feels_inertia);
  std::string kinematic = With("simulated_arm", "sensor_feels_inertia: true");
  kinematic.replace(kinematic.find("level: dynamic"), 14, "level: kinematic");
  EXPECT_THAT(Refusal(kinematic), AllOf(HasSubstr("sensor_feels_inertia"), HasSubstr("servo or dynamic")));
}

TEST_F(AdmittanceKeys, GainsReadAgainStartFromTheCellsOwn) {
  const CellConfig cell = LoadText(CellText("thin_plate"),
                                   "admittance:\n  mass_kg: [2, 2, 2]\ncoupling:\n"
                                   "  stiffness_N_per_mm: 40\n");
  EXPECT_EQ(cell.own_gains.max_stiffness_N_per_m, 80e3);
  const control::Gains softer = ReadGains(cell, "coupling:\n  stiffness_N_per_mm: 10\n");
  EXPECT_EQ(softer.max_stiffness_N_per_m, 10e3);
  EXPECT_EQ(softer.mass_kg.x, 3.0) << "the file does not say it any more";
  EXPECT_EQ(ReadGains(cell, "admittance: {dead_zone_N: 1}\n").max_stiffness_N_per_m, 40e3)
      << "as far as it goes";
  EXPECT_THAT(ReadGainsRefusal(cell, "coupling:\n  stiffness_N_per_mm: 41\n"),
              HasSubstr(":2: stiffness_N_per_mm: found 41, accepted at most 40 while it runs"));
  EXPECT_THAT(ReadGainsRefusal(cell, "admittance:\n  mass_kg: [2, 2]\n"),
              HasSubstr("accepted a list of 3 numbers"));
}

}  // namespace
}  // namespace osteon::config
