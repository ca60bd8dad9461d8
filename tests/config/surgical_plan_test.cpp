#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "config/reading/check_plan_in_cell.h"
#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "tests/temporary_path.h"

// Tests the plans' files in config/plans: the shipped plans, and the errors of changed plans.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";
const fs::path kPlan = kConfig / "plans" / "acetabulum.yaml";

class SurgicalPlanFiles : public testing::Test {
 protected:
  // Writes the shipped plan with the first occurrence of `from` replaced. @returns the file. The file names
  // the scene by an absolute path, because it lies in another folder.
  fs::path Changed(const std::string& from, const std::string& to) {
    std::ostringstream text;
    text << std::ifstream(kPlan).rdbuf();
    std::string plan = text.str();
    const std::size_t at = plan.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    plan.replace(at, from.size(), to);
    const std::string scene = "scene: acetabulum";
    plan.replace(plan.find(scene), scene.size(),
                 "scene: " + (kConfig / "scenes" / "acetabulum.yaml").string());
    std::ofstream(file_) << plan;
    return file_;
  }
  // The error of loading the plan; empty if it is accepted.
  std::string ErrorOf(const fs::path& file) {
    try {
      static_cast<void>(LoadSurgicalPlan(file));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  const fs::path file_ = TemporaryPath("plan.yaml");
  void TearDown() override { fs::remove(file_); }
};

TEST_F(SurgicalPlanFiles, TheDemosPlanPointsOutOfTheDemosCup) {
  const SurgicalPlanConfig config = LoadSurgicalPlan(kPlan);
  // landmarks are rounded to 1 µm, and the third landmark lies 87 mm from the line through the first two
  EXPECT_LT((config.plan.axis_G - Vector3::UnitZ()).norm(), 2e-5);
  EXPECT_EQ(config.plan.tools.size(), 4u);
  EXPECT_DOUBLE_EQ(config.plan.cavity().radius_m, 0.025);
  EXPECT_DOUBLE_EQ(config.plan.guidance.lateral.stiffness_N_per_m, 5e3);
  EXPECT_NO_THROW(CheckPlanInCell(config, LoadCell(kConfig / "cells" / "demo.yaml"), kPlan, "demo"));
}

TEST_F(SurgicalPlanFiles, APlanWithoutGuidanceHasNone) {
  std::ostringstream text;
  text << std::ifstream(kPlan).rdbuf();
  const std::string whole = text.str();
  const std::size_t at = whole.find("guidance:");
  EXPECT_EQ(LoadSurgicalPlan(Changed(whole.substr(at), "")).plan.guidance.gain, 0.0);
}

TEST_F(SurgicalPlanFiles, APlanForTheOtherSideIsRefusedByLine) {
  const std::string error = ErrorOf(Changed("side: right", "side: left"));
  EXPECT_TRUE(
      std::regex_search(error, std::regex("plan.yaml:\\d+: anteversion_deg: found an axis 76\\.[78]")))
      << error;
}

TEST_F(SurgicalPlanFiles, DiametersThatDoNotRiseAreRefusedByLine) {
  const std::string error = ErrorOf(Changed("diameter_mm: 48", "diameter_mm: 46"));
  EXPECT_TRUE(std::regex_search(error, std::regex("plan.yaml:\\d+: diameter_mm: found 46 after 46")))
      << error;
}

TEST_F(SurgicalPlanFiles, GuidanceGainsBeyondTheStableRangeAreRefused) {
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"stiffness_Nm_per_rad: 200", "stiffness_Nm_per_rad: 401"},
           {"cap_Nm: 6", "cap_Nm: 8.1"},
           {"stiffness_N_per_mm: 5\n", "stiffness_N_per_mm: 5.1\n"},
           {"cap_N: 40", "cap_N: 61"},
           {"stiffness_N_per_mm: 10\n", "stiffness_N_per_mm: 21\n"},
           {"cap_N: 100", "cap_N: 151"},
           {"stop_mm: 3", "stop_mm: 0.9"}})
    EXPECT_NE(ErrorOf(Changed(from, to)).find("accepted"), std::string::npos) << to;
}

TEST_F(SurgicalPlanFiles, ThePelvisFrameMayComeFromLandmarksOrAxes) {
  const SurgicalPlanConfig by_landmarks = LoadSurgicalPlan(kPlan);
  const auto& pelvis = by_landmarks.plan.pelvis;
  const auto axis = [](const Vector3& v) {
    return fmt::format("[{:.12f}, {:.12f}, {:.12f}]", v.x(), v.y(), v.z());
  };
  const std::string landmarks =
      "  asis_right_mm: [78.886, -20.763, -25.591]\n  asis_left_mm: [-85.028, -113.106, -174.603]\n"
      "  pubis_mm: [-61.593, -66.934, -35.722]\n";
  const fs::path file =
      Changed(landmarks, fmt::format("  lateral_axis: {}\n  anterior_axis: {}\n  superior_axis: {}\n",
                                     axis(pelvis.lateral), axis(pelvis.anterior), axis(pelvis.superior)));
  const SurgicalPlanConfig by_axes = LoadSurgicalPlan(file);
  EXPECT_LT((by_axes.plan.axis_G - by_landmarks.plan.axis_G).norm(), 1e-11);
  EXPECT_FALSE(by_axes.plan.landmarks);
  const SurgicalPlanConfig by_words = LoadSurgicalPlan(
      Changed(landmarks, fmt::format("  lateral: {}\n  anterior: {}\n  superior: {}\n", axis(pelvis.lateral),
                                     axis(pelvis.anterior), axis(pelvis.superior))));
  EXPECT_EQ(by_words.plan.axis_G, by_axes.plan.axis_G);
  EXPECT_NE(ErrorOf(Changed(landmarks, fmt::format("  lateral: {}\n  lateral_axis: {}\n  anterior: {}\n"
                                                   "  superior: {}\n",
                                                   axis(pelvis.lateral), axis(pelvis.lateral),
                                                   axis(pelvis.anterior), axis(pelvis.superior))))
                .find("lateral_axis"),
            std::string::npos)
      << "one place, two keys";
}

TEST_F(SurgicalPlanFiles, APelvicTiltTurnsThePlannedAxis) {
  const Vector3 flat = LoadSurgicalPlan(kPlan).plan.axis_G;
  const auto tilted = LoadSurgicalPlan(Changed("tilt_deg: 0", "tilt_deg: 13"));
  EXPECT_GT((tilted.plan.axis_G - flat).norm(), 0.1);
}

TEST_F(SurgicalPlanFiles, ACellWhoseDepthLimitBeginsAboveThePlanIsRefused) {
  const SurgicalPlanConfig config = LoadSurgicalPlan(kPlan);
  CellConfig cell = LoadCell(kConfig / "cells" / "demo.yaml");
  // the deepest planned apex is 27 mm below the face at 210 mm, thus 11 mm before the bound at 172 mm
  cell.servo.depth.soft_m = 0.0105;
  EXPECT_NO_THROW(CheckPlanInCell(config, cell, kPlan, "cell.yaml"));
  cell.servo.depth.soft_m = 0.0115;
  EXPECT_THROW(CheckPlanInCell(config, cell, kPlan, "cell.yaml"), ConfigError);
}

TEST_F(SurgicalPlanFiles, APlanForAnotherBoneThanTheCellsIsRefused) {
  const SurgicalPlanConfig config = LoadSurgicalPlan(kPlan);
  EXPECT_THROW(
      CheckPlanInCell(config, LoadCell(kConfig / "cells" / "sawbone_block.yaml"), kPlan, "cell.yaml"),
      ConfigError);
}

// A plan for a mesh describes the cup but no bone. The user names the mesh in the command, and this mesh
// replaces the bone of the cell.
TEST(SurgicalPlanFile, APlanForAMeshHasACupAndNoBone) {
  const SurgicalPlanConfig config = LoadSurgicalPlan(kConfig / "plans" / "hip_bone_left.yaml");
  ASSERT_TRUE(config.mesh_cup);
  EXPECT_FALSE(config.bone);
  EXPECT_NEAR((config.plan.axis_G - Vector3(-0.983, -0.175, 0.052).normalized()).norm(), 0.0, 1e-5)
      << "45 and 20 degrees are the native axis";
  EXPECT_EQ(config.plan.tools.size(), 3u);
  EXPECT_NO_THROW(CheckPlanInCell(config, LoadCell(kConfig / "cells" / "demo.yaml"), kPlan, "demo"));
}

TEST(SurgicalPlanFile, TheMolarsPlanLeadsToItsPulp) {
  const fs::path file = kConfig / "plans" / "molar.yaml";
  const SurgicalPlanConfig config = LoadSurgicalPlan(file);
  const procedure::SurgicalPlan& plan = config.plan;
  EXPECT_EQ(plan.kind, procedure::PlanKind::kOpening);
  EXPECT_EQ(plan.target, "pulp");
  ASSERT_EQ(plan.tools.size(), 2u);
  EXPECT_EQ(plan.tools[0].around_m, 0.0);
  EXPECT_NEAR(plan.tools[1].around_m, 0.85e-3, 1e-12);
  EXPECT_NEAR(plan.cavity().opening_radius_m(), 1.75e-3, 1e-12);
  EXPECT_LT((plan.pelvis.superior - plan.axis_G).norm(), 1e-12);
  EXPECT_TRUE(procedure::WarningsOf(plan).empty());
  EXPECT_NO_THROW(CheckPlanInCell(config, LoadCell(kConfig / "cells" / "molar.yaml"), file, "molar"));
}

TEST(SurgicalPlanFile, ErrorsOfAnOpeningsPlanNameWhatIsAccepted) {
  std::ostringstream text;
  text << std::ifstream(kConfig / "plans" / "molar.yaml").rdbuf();
  const auto error = [&](const std::string& from, const std::string& to) -> std::string {
    std::string plan = text.str();
    plan.replace(plan.find(from), from.size(), to);
    const std::string scene = "scene: molar";
    plan.replace(plan.find(scene), scene.size(), "scene: " + (kConfig / "scenes" / "molar.yaml").string());
    const fs::path file = TemporaryPath("opening.yaml");
    std::ofstream(file) << plan;
    std::string what;
    try {
      static_cast<void>(LoadSurgicalPlan(file));
    } catch (const ConfigError& refused) {
      what = refused.what();
    }
    fs::remove(file);
    return what;
  };
  EXPECT_EQ(error("target: pulp", "target: pulp"), "");
  EXPECT_NE(error("target: pulp", "target: nerve")
                .find("found nerve, accepted a region of the scene's events: pulp"),
            std::string::npos);
  EXPECT_NE(error("width_mm: 3.5", "width_mm: 1.7").find("accepted the burr's diameter (1.8) and more"),
            std::string::npos);
  EXPECT_NE(error("axis: [0, 0, 1]", "axis: [1, 0, 0]").find("90.0° off the scene's opening"),
            std::string::npos);
  EXPECT_NE(error("kind: opening", "kind: cup").find("unknown key \"opening\""), std::string::npos);
  EXPECT_NE(error("width_mm: 1.4", "width_mm: 4").find("accepted widths that do not fall"),
            std::string::npos);
  EXPECT_NE(error("diameter_mm: 1.8", "diameter_mm: 1.4").find("accepted diameters that rise"),
            std::string::npos);
}

}  // namespace
}  // namespace osteon::config
