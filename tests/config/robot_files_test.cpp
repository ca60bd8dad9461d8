#include <fstream>
#include <numbers>
#include <sstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "kinematics/payload.h"
#include "kinematics/serial_chain.h"
#include "tests/kinematics/chain_samples.h"

// Tests the robots' files in config/robots: their kinematics against published descriptions and catalogues,
// and the errors of wrong files.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using kinematics::ChainParams;
using kinematics::SerialChain;

constexpr double kDegree = std::numbers::pi / 180.0;

fs::path RobotFile(const std::string& name) {
  return fs::path(OSTEON_SOURCE_DIR) / "config" / "robots" / (name + ".yaml");
}

// The kinematic chain that a shipped robot's file describes.
template <int N>
ChainParams<N> ChainOf(const std::string& name) {
  return std::get<ChainParams<N>>(LoadRobot(RobotFile(name)).chain);
}

// The file (mm and degrees) must equal the published chain (m and rad) up to rounding.
TEST(RobotFiles, Iiwa14EqualsItsPublishedDescription) {
  const ChainParams<7> chain = ChainOf<7>("lbr_iiwa_14_r820"), expected = kinematics::Iiwa14Chain();
  EXPECT_TRUE(chain.has_masses);
  for (std::size_t i = 0; i < 7; ++i) {
    const kinematics::RevoluteJoint &joint = chain.joints[i], &other = expected.joints[i];
    EXPECT_LT((joint.X_PJ.matrix() - other.X_PJ.matrix()).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_EQ(joint.axis_J, other.axis_J);
    EXPECT_DOUBLE_EQ(joint.limits.lower_rad, other.limits.lower_rad);
    EXPECT_DOUBLE_EQ(joint.limits.upper_rad, other.limits.upper_rad);
    EXPECT_DOUBLE_EQ(joint.limits.velocity_rad_per_s, other.limits.velocity_rad_per_s);
    EXPECT_DOUBLE_EQ(joint.limits.acceleration_rad_per_s2, other.limits.acceleration_rad_per_s2);
    EXPECT_DOUBLE_EQ(joint.limits.torque_Nm, other.limits.torque_Nm);
    EXPECT_DOUBLE_EQ(joint.link.mass_kg, other.link.mass_kg);
    EXPECT_LT((joint.link.p_LLcm_m - other.link.p_LLcm_m).norm(), 1e-15);
    EXPECT_EQ(joint.link.I_LLcm_kg_m2, other.link.I_LLcm_kg_m2);
    EXPECT_EQ(joint.friction.viscous_Nms_per_rad, 0.0) << "no source gives one";
    EXPECT_EQ(joint.rotor_inertia_kg_m2, 0.0);
  }
  EXPECT_LT((chain.X_LF.matrix() - expected.X_LF.matrix()).cwiseAbs().maxCoeff(), 1e-16);
}

// The lengths must be equal bit for bit, because the demo's expected hash depends on them.
TEST(RobotFiles, SummedOriginsGiveTheLengthsOfTheCatalogueExactly) {
  const kinematics::LbrParams lbr = kinematics::LbrParamsFrom(ChainOf<7>("lbr_iiwa_14_r820"));
  EXPECT_EQ(lbr.base_to_shoulder_m, 0.360);
  EXPECT_EQ(lbr.shoulder_to_elbow_m, 0.420);
  EXPECT_EQ(lbr.elbow_to_wrist_m, 0.400);
  EXPECT_EQ(lbr.wrist_to_flange_m, 0.126);
}

// The catalogue states the flange's height with the arm upright, and masses of 29.9 and 23.9 kg. The masses
// include the base of 7.05 and 4.86 kg.
TEST(RobotFiles, LbrsHaveTheHeightAndMassOfTheCatalogue) {
  struct Arm {
    const char* name;
    double height_m, total_kg, base_kg;
  };
  for (const Arm& arm :
       {Arm{"lbr_iiwa_14_r820", 1.306, 29.9, 7.050378}, Arm{"lbr_iiwa_7_r800", 1.266, 23.9, 4.855658}}) {
    const ChainParams<7> chain = ChainOf<7>(arm.name);
    const Pose X_BF = SerialChain<7>(chain).FlangePose(kinematics::JointVectorN<7>::Zero());
    EXPECT_NEAR(X_BF.translation().z(), arm.height_m, 1e-12);
    EXPECT_TRUE(X_BF.linear().isIdentity(1e-12));
    double sum_kg = arm.base_kg;
    for (const kinematics::RevoluteJoint& joint : chain.joints) sum_kg += joint.link.mass_kg;
    EXPECT_NEAR(sum_kg, arm.total_kg, 0.1) << arm.name;
    const kinematics::LbrParams lbr = kinematics::LbrParamsFrom(chain);
    EXPECT_NEAR(
        lbr.base_to_shoulder_m + lbr.shoulder_to_elbow_m + lbr.elbow_to_wrist_m + lbr.wrist_to_flange_m,
        arm.height_m, 1e-12);
  }
}

// The file has seven lengths, offsets and signs; kuka_experimental has the joints' origins. Both must give
// the same flange pose in 1000 random postures.
TEST(RobotFiles, Kr6EqualsItsPublishedDescription) {
  const SerialChain<6> arm(ChainOf<6>("kr_6_r900_2")), described(kinematics::Kr6R900());
  std::mt19937_64 random{61};
  for (int n = 0; n < 1000; ++n) {
    const kinematics::JointVectorN<6> q = kinematics::RandomJoints<6>(random, 3.0);
    EXPECT_LT((arm.FlangePose(q).matrix() - described.FlangePose(q).matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// At KUKA's zero position, upper arm, forearm and flange point along x. With A2 at -90° and A3 at 90° the
// upper arm is upright. The reach is the distance of the wrist from A1's axis with the arm straight. The
// lengths a1 … c4 [m] are those of the ortho-parallel model.
TEST(RobotFiles, KrsHaveKukasZeroAndPublishedReach) {
  struct Arm {
    const char* name;
    double a1, a2, c1, c2, c3, c4, reach_m;
  };
  for (const Arm& arm : {Arm{"kr_6_r900_2", .025, -.025, .400, .455, .420, .090, .901},
                         Arm{"kr_16_2", .260, -.035, .675, .680, .670, .158, 1.611}}) {
    const RobotModel model = LoadRobot(RobotFile(arm.name));
    ASSERT_TRUE(model.ortho_parallel);
    EXPECT_EQ(model.joint_count(), 6);
    const SerialChain<6> chain(std::get<ChainParams<6>>(model.chain));
    kinematics::JointVectorN<6> q = kinematics::JointVectorN<6>::Zero();
    Pose X_BF = chain.FlangePose(q);
    EXPECT_LT((X_BF.translation() - Vector3(arm.a1 + arm.c2 + arm.c3 + arm.c4, 0, arm.c1 - arm.a2)).norm(),
              1e-12);
    EXPECT_LT((X_BF.linear().col(2) - Vector3::UnitX()).norm(), 1e-12);
    q << 0, -90 * kDegree, 90 * kDegree, 0, 0, 0;
    X_BF = chain.FlangePose(q);
    EXPECT_LT((X_BF.translation() - Vector3(arm.a1 + arm.c3 + arm.c4, 0, arm.c1 + arm.c2 - arm.a2)).norm(),
              1e-12);
    q[0] = 90 * kDegree;
    EXPECT_LT((chain.FlangePose(q).linear().col(2) + Vector3::UnitY()).norm(), 1e-12) << "A1 turns clockwise";
    // angle of A3 that brings the wrist onto the line through A2 and A3
    const double straight = std::atan2(-arm.a2, arm.c3);
    q << 0, 0, straight, 0, 0, 0;
    const Vector3 wrist = chain.FlangePose(q) * Vector3(0, 0, -arm.c4);
    EXPECT_NEAR(wrist.x(), arm.reach_m, 0.001);
    EXPECT_NEAR(wrist.z(), arm.c1, 1e-12);
    EXPECT_FALSE(std::get<ChainParams<6>>(model.chain).has_masses);
  }
}

TEST(RobotFiles, ACellsLastLinkIncludesItsToolAndSensor) {
  const fs::path root = fs::path(OSTEON_SOURCE_DIR) / "config";
  const CellConfig cell = LoadCell(root / "cells" / "demo.yaml");
  const kinematics::LinkInertia bare = kinematics::Iiwa14Chain().joints.back().link,
                                loaded = cell.robot.lbr()->chain.joints.back().link;
  EXPECT_NEAR(loaded.mass_kg, bare.mass_kg + 0.5 + cell.tool.tool.mass_kg, 1e-12);
  // first moments (mass × centre) add up: the link, the sensor 35 + 15 mm ahead of A7, and the tool at its
  // centre in the flange's frame
  const Vector3 p_FTcm = cell.tool.X_FT * Vector3(cell.tool.tool.center_of_mass_m);
  const Vector3 moment = bare.mass_kg * bare.p_LLcm_m + 0.5 * Vector3(0, 0, 0.05) +
                         cell.tool.tool.mass_kg * (p_FTcm + Vector3(0, 0, 0.035));
  EXPECT_LT((loaded.mass_kg * loaded.p_LLcm_m - moment).norm(), 1e-12);
}

// Each case changes one text of a good file. The error must be the expected one and must name the changed
// line.
TEST(RobotFiles, MalformedFilesAreRefusedWithTheirReason) {
  struct Case {
    const char *robot, *from, *to, *expected;
  };
  const fs::path folder = fs::path(::testing::TempDir()) / ("osteon_robots_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const fs::path file = folder / "arm.yaml";
  for (const Case& c : {
           Case{"lbr_iiwa_14_r820", "name: A3", "name: A4",
                ":20: name: found A4, accepted A3: the joints from the base on"},
           Case{"lbr_iiwa_14_r820", "axis: [0, -1, 0]", "axis: [0, -1, 1]",
                ":27: axis: found a length of 1.41421, accepted 1"},
           Case{"lbr_iiwa_14_r820", "lower_deg: -175, upper_deg: 175", "lower_deg: 175, upper_deg: 175",
                ":43: upper_deg: found 175, accepted more than lower_deg (175)"},
           Case{"lbr_iiwa_14_r820", "velocity_deg_per_s: 75", "velocity_deg_per_s: 0",
                ":28: velocity_deg_per_s: found 0, accepted 1 … 1000"},
           Case{"lbr_iiwa_14_r820", "mass_kg: 5.289529", "mass_kg: -5.289529",
                ":14: mass_kg: found -5.289529, accepted 0 … 1000"},
           Case{"lbr_iiwa_14_r820", "[0.000175, 0.000175, 0.000306", "[0.000175, 0.000175, 0.000406",
                ":44: inertia_kg_m2: A7: principal moments of inertia [kg m^2]: found 0.000175"},
           Case{"lbr_iiwa_14_r820", "  masses: ", "# masses: ",
                ":10: name: found A1 with a link, accepted one without: sources names no masses"},
           Case{"lbr_iiwa_14_r820", "    link: {mass_kg: 0.265331", "   #link: {mass_kg: 0.265331",
                ":40: name: found A7 without a link, accepted one with: sources names masses"},
           Case{"lbr_iiwa_14_r820", "flange:", "flansch:", ":45: unknown key \"flansch\""},
           Case{"lbr_iiwa_14_r820", "joints:\n", "joints: []\nrest:\n",
                "joints: found a list of 0, accepted a list of 6 … 7 mappings"},
           Case{"kr_6_r900_2", "c2_mm: 455", "c2_mm: -455", ": c2_mm: found -455, accepted 1 … 5000"},
           Case{"kr_6_r900_2", "  c3_mm: 420\n", "", "missing key \"c3_mm\""},
           Case{"kr_6_r900_2", "reversed: true", "reversed: yes",
                "reversed: found yes, accepted false, true"},
           Case{"kr_6_r900_2", "offset_deg: -90", "offset_deg: -190",
                "offset_deg: found -190, accepted -180 … 180"},
           Case{"kr_6_r900_2", "ortho_parallel:", "orthoparallel:",
                "unknown key \"orthoparallel\"; did you mean \"ortho_parallel\"?"},
           Case{"kr_6_r900_2", "name: A6", "name: A7", "name: found A7, accepted A6"},
       }) {
    std::ostringstream text;
    text << std::ifstream(RobotFile(c.robot)).rdbuf();
    std::string changed = text.str();
    const std::size_t at = changed.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    changed.replace(at, std::string(c.from).size(), c.to);
    std::ofstream(file) << changed;
    try {
      static_cast<void>(LoadRobot(file));
      ADD_FAILURE() << c.expected;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(c.expected), std::string::npos) << error.what();
      EXPECT_GT(error.line(), 0);
    }
  }
  fs::remove_all(folder);
}

// A cell over FRI refuses a KR, and a 7-joint arm whose axes do not intersect in the way of an LBR's.
TEST(RobotFiles, ACellOverFriRefusesAnArmThatIsNoLbr) {
  const fs::path root = fs::path(OSTEON_SOURCE_DIR) / "config",
                 copy = fs::path(::testing::TempDir()) / ("osteon_arms_" + std::to_string(::getpid()));
  fs::copy(root, copy, fs::copy_options::recursive);
  const auto refusal = [&](const std::string& robot) {
    std::ostringstream text;
    text << std::ifstream(root / "cells" / "demo.yaml").rdbuf();
    std::string cell = text.str();
    cell.replace(cell.find("lbr_iiwa_14_r820"), 16, robot);
    std::ofstream(copy / "cells" / "demo.yaml") << cell;
    try {
      static_cast<void>(LoadCell(copy / "cells" / "demo.yaml"));
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(
      refusal("kr_16_2").find("demo.yaml:4: robot: found KR 16-2 with 6 joints, accepted an LBR, which fri"),
      std::string::npos);
  std::ostringstream text;
  text << std::ifstream(root / "robots" / "lbr_iiwa_14_r820.yaml").rdbuf();
  std::string bent = text.str();
  bent.replace(bent.find("[0, 10, 228]"), 12, "[5, 10, 228]");
  std::ofstream(copy / "robots" / "bent.yaml") << bent;
  EXPECT_NE(
      refusal("bent").find("demo.yaml:4: robot: LBR iiwa 14 R820: arm is not spherical-revolute-spherical"),
      std::string::npos);
  fs::remove_all(copy);
}

}  // namespace
}  // namespace osteon::config
