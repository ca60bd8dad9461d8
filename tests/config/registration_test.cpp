#include "config/reading/check_registration.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/reading/load.h"

// Tests the checks of a cell's poses (arm's base, bone, tool, workspace, start). A cell whose poses do not
// fit each other is refused, and the error names the pose that the user must change.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";
const fs::path kDemo = kConfig / "cells/demo.yaml";

// The error of the checks after `change` has changed the demo cell in memory; empty if there is none.
template <typename Change>
std::string ErrorOf(void (*check)(const CellConfig&, const Reader&), Change change) {
  CellConfig cell = LoadCell(kDemo);
  change(cell);
  try {
    check(cell, Reader::Load(kDemo));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

class Registration : public testing::Test {
 protected:
  void SetUp() override { fs::copy(kConfig, folder_, fs::copy_options::recursive); }
  void TearDown() override { fs::remove_all(folder_); }
  // The error of loading the demo cell with a text replaced in one of its files, at its first occurrence.
  std::string ErrorWith(const std::string& file, const std::string& before, const std::string& after) const {
    std::stringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    std::string edited = text.str();
    const std::size_t at = edited.find(before);
    if (at == std::string::npos) throw std::logic_error(file + " has changed");
    std::ofstream(folder_ / file) << edited.replace(at, before.size(), after);
    try {
      static_cast<void>(LoadCell(folder_ / "cells/demo.yaml"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  }
  const fs::path folder_ =
      fs::temp_directory_path() / ("osteon_registration_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

// The bone's pose in the demo cell, and the same lines with another position.
constexpr const char* kBone =
    "bone_in_world:  # frame G: origin at the cup's centre, +z out of the opening\n"
    "  position_mm: [620, 0, 210]";
std::string BoneAt(const std::string& position) {
  return std::string("bone_in_world:  # frame G: origin at the cup's centre, +z out of the opening\n") +
         "  position_mm: " + position;
}

TEST_F(Registration, ABonePositionInMetresIsRefused) {
  EXPECT_THAT(ErrorWith("cells/demo.yaml", kBone, BoneAt("[0.62, 0, 0.21]")),
              AllOf(HasSubstr("demo.yaml:15: position_mm: found 0.654599 mm from the arm's base to the site, "
                              "accepted at least 150 mm"),
                    HasSubstr("looks like metres where millimetres are expected")));
}

TEST_F(Registration, AWorkspaceInMetresIsRefused) {
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", "sphere_center_mm: [620, 0, 260]", "sphere_center_mm: [0.62, 0, 0.26]"),
      AllOf(HasSubstr(": sphere_center_mm: found -5"), HasSubstr("looks like metres")));
}

TEST_F(Registration, ABoneInTheArmsFootIsRefused) {
  EXPECT_THAT(ErrorWith("cells/demo.yaml", kBone, BoneAt("[100, 0, 50]")),
              AllOf(HasSubstr(": position_mm: found 111.803 mm"), HasSubstr("the arm's foot")));
}

TEST_F(Registration, ABoneOutOfTheArmsReachIsRefused) {
  // the shoulder is at 360 mm; arm and tool reach 0.42 + 0.4 + 0.126 + 0.18 m
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", kBone, BoneAt("[1200, 0, 360]")),
      HasSubstr("demo.yaml:15: position_mm: found 1200 mm from the arm's shoulder to the site, accepted "
                "at most 1126 mm"));
}

TEST_F(Registration, AWrongBasePoseIsNamedWhenTheBoneIsOutOfReach) {
  EXPECT_THAT(ErrorWith("cells/demo.yaml", "base_in_world:\n  position_mm: [0, 0, 0]",
                        "base_in_world:\n  position_mm: [0, -1000, 0]"),
              HasSubstr("base_in_world says where the arm stands"));
}

// With a wrong bone pose, the workspace's bounds are exceeded. The error must name the bone's pose, not the
// workspace.
TEST_F(Registration, ForABoneOutsideTheWorkspaceTheBonesPoseIsNamed) {
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", kBone, BoneAt("[900, 0, 210]")),
      HasSubstr(
          "demo.yaml:15: position_mm: found -134.429 mm from the site to the workspace's sphere, accepted "
          "at least 48 mm: the site is outside of the workspace"));
  static_cast<void>(ErrorWith("cells/demo.yaml", "sphere_radius_mm: 150", "sphere_radius_mm: 400"));
  EXPECT_THAT(ErrorWith("cells/demo.yaml", BoneAt("[900, 0, 210]"), BoneAt("[620, 0, 130]")),
              HasSubstr("demo.yaml:15: position_mm: found -10 mm from the site to the workspace's plane"));
}

TEST_F(Registration, ForAStartOutOfReachTheBonesPoseIsNamed) {
  static_cast<void>(
      ErrorWith("cells/demo.yaml", "sphere_center_mm: [620, 0, 260]", "sphere_center_mm: [1050, 0, 260]"));
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", kBone, BoneAt("[1050, 0, 210]")),
      AllOf(HasSubstr("demo.yaml:15: position_mm: found 10"),
            HasSubstr("mm from the arm's shoulder to its flange at the start, accepted at most 946 mm")));
}

TEST_F(Registration, ABaseUpsideDownIsRefused) {
  EXPECT_THAT(ErrorWith("cells/demo.yaml", "base_in_world:\n  position_mm: [0, 0, 0]\n  rpy_deg: [0, 0, 0]",
                        "base_in_world:\n  position_mm: [0, 0, 0]\n  rpy_deg: [180, 0, 0]"),
              AllOf(HasSubstr("demo.yaml:13: rpy_deg: found 180 deg from the vertical"),
                    HasSubstr("such as this one turned over: the arm can not be there")));
}

TEST_F(Registration, AStartTooHighAboveTheSiteIsRefusedAtItsHeight) {
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", "height_mm: 40 ", "height_mm: 240 "),
      HasSubstr(
          ": height_mm: the tool's apex is outside the workspace; nearer to the site it would not be so"));
}

TEST(RegistrationRows, ABaseInMetresIsRefused) {
  EXPECT_THAT(
      ErrorOf(CheckFrames,
              [](CellConfig& cell) {
                // bone and workspace are placed for a base at this position [m]; the cell's base gets the
                // same numbers in mm
                const Vector3 base(0.9, 0.0, 0.4);
                cell.X_WG.translation() += base;
                cell.servo.workspace.sphere_center_W_m += base;
                cell.servo.workspace.plane_offset_m += cell.servo.workspace.plane_normal_W.dot(base);
                cell.X_WB.translation() = 1e-3 * base;
              }),
      HasSubstr(
          "demo.yaml:12: position_mm: found (0.9, 0, 0.4) mm, accepted millimetres: looks like metres"));
}

TEST_F(Registration, AToolAsLongAsAnArmIsRefused) {
  EXPECT_THAT(
      ErrorWith("tools/reamer.yaml", "mounting:\n  position_mm: [0, 0, 0]",
                "mounting:\n  position_mm: [0, 0, 1800]"),
      AllOf(HasSubstr("demo.yaml:5: tool: found 1980 mm from the flange to the tool's apex, accepted at "
                      "most 600 mm"),
            HasSubstr("mounting's position_mm")));
}

TEST_F(Registration, TheWholeSiteMustBeInTheWorkspace) {
  // the cup's centre is 70 mm above the plane, and the work there extends by 2 × 24 mm
  EXPECT_THAT(
      ErrorWith("cells/demo.yaml", "plane_offset_mm: 140", "plane_offset_mm: 170"),
      HasSubstr("plane_offset_mm: found 40 mm from the site to the workspace's plane, accepted at least "
                "48 mm"));
  EXPECT_THAT(ErrorWith("cells/demo.yaml", "sphere_radius_mm: 150", "sphere_radius_mm: 90"),
              HasSubstr("sphere_center_mm: found 40 mm"));
}

TEST_F(Registration, AStartTooCloseToAJointLimitIsRefused) {
  // the demo's start keeps a distance of 30° from the joints' limits; with the elbow turned by 100° it does
  // not
  EXPECT_THAT(ErrorWith("cells/demo.yaml", "joint_margin_deg: 1 ", "joint_margin_deg: 30 "), "");
  EXPECT_THAT(ErrorWith("cells/demo.yaml", "arm_angle_deg: 0 ", "arm_angle_deg: 100 "),
              HasSubstr(": arm_angle_deg: found "));
}

TEST(RegistrationRows, AMatrixThatIsNoRotationIsRefused) {
  EXPECT_THAT(ErrorOf(CheckFrames, [](CellConfig& cell) { cell.tool.X_FT.linear() *= 1.01; }),
              HasSubstr("demo.yaml:5: tool: found 0.0"));
  EXPECT_THAT(ErrorOf(CheckFrames, [](CellConfig& cell) { cell.tool.X_FT.linear().col(0) *= -1.0; }),
              HasSubstr("demo.yaml:5: tool: found 2 from the tool's rotation to the nearest rotation"));
}

TEST(RegistrationRows, ATiltedBaseIsNotedAndAccepted) {
  CellConfig cell = LoadCell(kDemo);
  cell.X_WB.linear() = Eigen::AngleAxisd(0.2, Vector3::UnitY()).toRotationMatrix();
  int noted = 0;
  for (const RegistrationRow& row : DescribeRegistration(cell).rows)
    if (row.section == "base_in_world") {
      EXPECT_NEAR(row.value, 11.459, 1e-3);
      EXPECT_EQ(row.verdict(), "note: the arm's own controller must know how it is mounted");
      ++noted;
    }
  EXPECT_EQ(noted, 1);
}

// The checks compute the tool's start pose from the joint angles of the start. Each case changes only these
// angles, or only the values with which they are compared.
TEST(RegistrationRows, TheStartIsCheckedByItsJointAngles) {
  EXPECT_THAT(ErrorOf(CheckStart, [](CellConfig& cell) { cell.start.q[0] += 1.0; }),
              HasSubstr(": height_mm: found -"));
  EXPECT_THAT(ErrorOf(CheckStart, [](CellConfig& cell) { cell.start.q[5] = 2.094; }),
              HasSubstr(": arm_angle_deg: found 0.0"));
  // turns the bone by 1.1 rad, so that the tool's axis does not point into it
  EXPECT_THAT(
      ErrorOf(CheckStart,
              [](CellConfig& cell) {
                cell.X_WG.linear() = Eigen::AngleAxisd(1.1, Vector3::UnitX()) * cell.X_WG.linear();
              }),
      HasSubstr("demo.yaml:16: rpy_deg: found 63.0254 deg from the tool's axis at the start to the way "
                "into the bone, accepted at most 60 deg"));
  EXPECT_THAT(ErrorOf(CheckStart,
                      [](CellConfig& cell) {
                        cell.tool.X_FT.translation().z() = -0.2;  // places the flange ahead of the apex
                        cell.servo.workspace.plane_offset_m = 0.45;
                        cell.servo.workspace.sphere_radius_m = 1.0;
                      }),
              HasSubstr("from the flange at the start to the workspace's plane"));
}

TEST(RegistrationRows, EveryShippedCellPassesAllChecks) {
  int cells = 0;
  for (const fs::directory_entry& file : fs::directory_iterator(kConfig / "cells")) {
    const CellConfig cell = LoadCell(file.path());
    const RegistrationReport report = DescribeRegistration(cell);
    EXPECT_EQ(report.rows.size(), cell.servo.depth.acts ? 14u : 13u);
    for (const RegistrationRow& row : report.rows)
      EXPECT_EQ(row.verdict(), "ok") << file.path() << ": " << row.name << " " << row.value << " "
                                     << row.unit;
    ++cells;
  }
  EXPECT_GE(cells, 6);
}

}  // namespace
}  // namespace osteon::config
