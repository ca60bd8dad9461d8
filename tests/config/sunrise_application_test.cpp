#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "io/fri/fri_link.h"

// Tests that the program for the arm's controller (config/controllers/sunrise) fits the demo cell. The
// program's constants are read as text, because no Sunrise library is part of this repository.

namespace osteon::config {
namespace {

const std::filesystem::path kRoot{OSTEON_SOURCE_DIR};

// Text of the controller's program.
std::string Program() {
  std::ifstream in(kRoot / "config/controllers/sunrise/OsteonHaptics.java");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// VALUE of the line `private static final TYPE NAME = VALUE;`, without quotes.
std::string Constant(const std::string& name) {
  static const std::string program = Program();
  std::smatch found;
  if (!std::regex_search(program, found,
                         std::regex("private static final \\w+ " + name + " = \"?([^;\"]+)\"?;")))
    throw std::runtime_error("no constant " + name);
  return found[1];
}
double Number(const std::string& name) { return std::stod(Constant(name)); }

class SunriseApplication : public testing::Test {
 protected:
  const CellConfig cell_ = LoadCell(kRoot / "config/cells/demo.yaml");
};

TEST_F(SunriseApplication, SendsToTheCellsPortWithItsPeriod) {
  EXPECT_EQ(Number("CLIENT_PORT"), cell_.link.port);
  EXPECT_EQ(Number("CLIENT_PORT"), io::FriLinkParams{}.port);
  EXPECT_DOUBLE_EQ(Number("SEND_PERIOD_MS") * 1e-3, cell_.servo.period_s);
  EXPECT_EQ(Number("RECEIVE_MULTIPLIER"), cell_.simulated.fri.receive_multiplier);
  EXPECT_EQ(Constant("CLIENT_ADDRESS").substr(0, 11), "192.170.10.") << "KONI's network";
}

TEST_F(SunriseApplication, UsesTheCommandModeOfTheSimulatedArm) {
  EXPECT_EQ(Constant("MODE"), "ClientCommandMode.POSITION");
  EXPECT_EQ(cell_.simulated.fri.command_mode, control::CommandMode::kPosition);
}

// The tool load in the program must equal the load on the flange in the cell.
TEST_F(SunriseApplication, ChecksForTheCellsPayload) {
  const RobotModel bare = LoadRobot(kRoot / "config/robots/lbr_iiwa_14_r820.yaml");
  const double payload_kg = cell_.robot.lbr()->chain.joints.back().link.mass_kg -
                            std::get<kinematics::ChainParams<7>>(bare.chain).joints.back().link.mass_kg;
  EXPECT_NEAR(Number("PAYLOAD_KG"), payload_kg, 0.5 * Number("PAYLOAD_TOLERANCE_KG"));
}

TEST_F(SunriseApplication, HasTheStiffnessAndDampingOfTheSimulatedArm) {
  const hil::DynamicArmParams& arm = cell_.simulated.dynamic;
  EXPECT_EQ(Number("STIFFNESS_N_PER_M"), arm.stiffness_N_per_m);
  EXPECT_EQ(Number("STIFFNESS_NM_PER_RAD"), arm.stiffness_Nm_per_rad_turn);
  EXPECT_EQ(kinematics::JointVectorN<7>::Constant(Number("JOINT_STIFFNESS_NM_PER_RAD")),
            arm.stiffness_Nm_per_rad);
  EXPECT_EQ(Number("DAMPING_RATIO"), arm.cartesian_damping_ratio);
  EXPECT_EQ(Number("DAMPING_RATIO"), arm.joint_damping_ratio);
}

}  // namespace
}  // namespace osteon::config
