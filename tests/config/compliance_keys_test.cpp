#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/sections/compliance_params.h"
#include "config/reading/sections/read_compliance.h"
#include "tests/config/cell_text.h"

// Tests a cell's section `compliance`: which parts yield, when the setting `auto` switches a part on, and
// which values are refused.

namespace osteon::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A bone on an elastic mount, for the section `compliance` of the demo cell.
constexpr const char* kMount =
    "\n  mount: on\n  bone_mount:\n    source: assumed\n    at_mm: [620, 0, 130]\n    mass_kg: 12\n"
    "    inertia_kg_m2: [0.12, 0.12, 0.12]\n    stiffness_N_per_mm: [47.4, 47.4, 47.4]\n"
    "    stiffness_Nm_per_rad: [2000, 2000, 2000]\n    damping_ratio: 0.05\n";

// A shipped cell with a section `compliance`.
std::string WithCompliance(const std::string& cell, const std::string& section) {
  return CellText(cell) + "\ncompliance:" + section + "\n";
}

// The tool's compliance in a shipped cell, for which `auto` decides whether it is on.
CompliancePart ToolOf(const std::string& cell) {
  return CompliancePartsOf(LoadText(WithCompliance(cell, " {tool: auto}")))[0];
}

TEST(ComplianceKeys, WithoutTheSectionNothingGivesWay) {
  for (const char* cell : {"demo", "molar", "femoral_canal", "sawbone_block", "thin_plate_impedance"})
    EXPECT_FALSE(LoadText(CellText(cell)).servo.compliance.any()) << cell;
}

// The decision of `auto` about the tool in each shipped cell, and the figures on which it is based (from the
// design's table).
TEST(ComplianceKeys, AutoTurnsTheToolOnWhereItsBendingIsNoticed) {
  struct Row {
    const char* cell;
    double k_N_per_mm, bends_mm;  // stiffness at the apex; displacement under the push force
    // coupling stiffness × compliance; change of the felt stiffness; push force / buckling load
    double product, felt, thrust;
    bool on;
  };
  for (const Row& row : {Row{"demo", 847.8, 0.041, 0.0236, -0.023, 0.002, false},
                         Row{"femoral_canal", 34.49, 0.580, 1.740, -0.635, 0.026, true},
                         Row{"molar", 10.02, 0.599, 3.991, -0.800, 0.019, true},
                         Row{"sawbone_block", 13.57, 1.106, 4.422, -0.816, 0.119, true},
                         Row{"thin_plate", 13.57, 1.106, 5.897, -0.855, 0.119, true}}) {
    SCOPED_TRACE(row.cell);
    const CompliancePart part = ToolOf(row.cell);
    ASSERT_TRUE(part.known);
    EXPECT_EQ(part.effect.matters(), row.on);
    EXPECT_NEAR(1e-3 * part.stiffness_N_per_m, row.k_N_per_mm, 0.01 * row.k_N_per_mm);
    EXPECT_NEAR(1e3 * part.effect.gives_m, row.bends_mm, 0.012 * row.bends_mm);
    EXPECT_NEAR(part.effect.product, row.product, 0.01 * row.product);
    EXPECT_NEAR(part.effect.felt_share, row.felt, 0.005);
    EXPECT_NEAR(part.thrust_ratio, row.thrust, 0.0011);
  }
}

// The surface layer's compliance in a shipped cell, for which `auto` decides whether it is on.
CompliancePart LayerOf(const std::string& cell) {
  return CompliancePartsOf(LoadText(WithCompliance(cell, " {layer: auto}")))[1];
}

// `auto` leaves the demo's cartilage off: a hand does not feel it through the reamer, and it yields less than
// the error that the scene accepts.
TEST(ComplianceKeys, AutoLeavesTheDemosCartilageOff) {
  const CompliancePart part = LayerOf("demo");
  ASSERT_TRUE(part.known);
  EXPECT_FALSE(part.on);
  EXPECT_EQ(part.felt_at_N, 20.0);
  EXPECT_NEAR(1e-3 * part.stiffness_N_per_m, 329.7, 3.3) << "the tangent, not the secant of 165";
  EXPECT_NEAR(part.effect.product, 0.0607, 0.0006);
  EXPECT_NEAR(part.effect.felt_share, -0.057, 0.001);
  EXPECT_NEAR(1e6 * part.seated_m2, 1963.0, 1.0) << "a head of 25 mm fills a cup of 24";
  EXPECT_NEAR(1e3 * part.effect.gives_m, 0.0424, 0.0005);
  EXPECT_EQ(part.force_N, 120.0);
  EXPECT_FALSE(LoadText(WithCompliance("demo", " {layer: auto}")).servo.compliance.layer);
  EXPECT_TRUE(LoadText(CellText("cartilage_cup")).servo.compliance.layer) << "on is on";
  EXPECT_FALSE(LayerOf("femoral_head").known) << "worn off";
}

// Cells in which `auto` turns a part on because it is felt.
TEST(ComplianceKeys, AutoTurnsOnPartsThatAreFelt) {
  const CellConfig cup = LoadText(CellText("soft_cup"));
  ASSERT_TRUE(cup.servo.compliance.layer) << "auto";
  EXPECT_NEAR(cup.servo.compliance.layer->kappa_N_per_m3[0], 0.5e9, 1.0);
  const CompliancePart layer = CompliancePartsOf(cup)[1];
  EXPECT_TRUE(layer.effect.is_felt && layer.effect.is_displaced);
  EXPECT_NEAR(1e-3 * layer.stiffness_N_per_m, 56.0, 0.6);
  EXPECT_NEAR(1e3 * layer.effect.gives_m, 0.247, 0.003);
  EXPECT_TRUE(cup.scene.materials.at(0).layer_source.assumed);
  const CellConfig drill = LoadText(CellText("femoral_long_drill"));
  ASSERT_TRUE(drill.servo.compliance.tool) << "auto";
  EXPECT_TRUE(CompliancePartsOf(drill)[0].effect.is_felt);
}

// A reamer of 44 mm touches only a part of the cup of 48 mm, so the layer yields more than under the demo's
// reamer.
TEST(ComplianceKeys, ALayerYieldsByTheAreaThatTheToolEngages) {
  const std::string cup = WithCompliance("demo", " {layer: auto}");
  const CompliancePart narrow =
      CompliancePartsOf(LoadText(With(cup, "tool_diameter_mm: 50", "tool_diameter_mm: 44")))[1];
  EXPECT_NEAR(1e6 * narrow.seated_m2, 1e6 * std::numbers::pi * 0.5e-3 / (1.0 / 0.022 - 1.0 / 0.024), 1.0);
  EXPECT_LT(narrow.seated_m2, LayerOf("demo").seated_m2);
  EXPECT_GT(narrow.effect.gives_m, LayerOf("demo").effect.gives_m);
}

// A ball with a radius of 25 mm on a flat layer, felt through a coupling of 20 N/mm. The figures are those of
// the design's table.
TEST(ComplianceKeys, TheLayersLawGivesTheFiguresOfTheDesign) {
  struct Row {
    double kappa_N_per_mm3, thickness_mm, delta_mm[3], k_N_per_mm, felt_N_per_mm;
  };
  for (const Row& row : {Row{0.06, 5.0, {1.030, 2.060, 4.607}, 19.42, 9.85},
                         Row{17.3, 2.0, {0.0607, 0.1213, 0.2713}, 329.7, 18.86},
                         Row{68.7, 2.0, {0.0304, 0.0609, 0.1361}, 657.0, 19.41}}) {
    SCOPED_TRACE(row.kappa_N_per_mm3);
    control::SurfaceLayerParams layer{.thickness_m = 1e-3 * row.thickness_mm};
    layer.kappa_N_per_m3[0] = 1e9 * row.kappa_N_per_mm3;
    layer.touch_area_m2 = std::numbers::pi * 0.025 * layer.engaged_layer_m;
    layer.max_area_m2 = std::numbers::pi * 0.025 * 0.025;
    const double bound_mm = 0.4 * row.thickness_mm;  // the loop's law limits the indentation to this value
    const double forces_N[3] = {5.0, 20.0, 100.0};
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(1e3 * LayerDeflection_m(layer, forces_N[i], 0.0), std::min(row.delta_mm[i], bound_mm),
                  0.015 * row.delta_mm[i]);
    const double k = 1e-3 * LayerTangent_N_per_m(layer, 20.0);
    EXPECT_NEAR(k, row.k_N_per_mm, 0.015 * row.k_N_per_mm);
    EXPECT_NEAR(20.0 * k / (20.0 + k), row.felt_N_per_mm, 0.01 * row.felt_N_per_mm);
  }
}

TEST(ComplianceKeys, ValuesOfTheSectionReachTheLoop) {
  const CellConfig drill = LoadText(CellText("long_drill"));
  ASSERT_TRUE(drill.servo.compliance.tool);
  const control::ToolLinkParams& tool = *drill.servo.compliance.tool;
  // a thrust of 60 N, with a buckling load of 422.6 N, reduces the stiffness of 8720 N/m at the apex
  const double factor = 1.0 / (1.0 - 60.0 / 422.6);
  EXPECT_NEAR(1.0 / tool.compliance_T(0, 0), 8720.0 / factor, 87.2);
  EXPECT_EQ(tool.tau_s, 0.020);
  EXPECT_NEAR(tool.max_bend_m, 6.5e-3, 1e-9);
  EXPECT_NEAR(tool.max_thrust_N, 0.5 * 422.6, 2.2);
  EXPECT_NEAR(drill.servo.compliance.noticed_m, 0.05e-3, 1e-12) << "the scene's error";

  const CellConfig pelvis = LoadText(CellText("pelvis_mount"));
  ASSERT_TRUE(pelvis.servo.compliance.mount);
  EXPECT_EQ(pelvis.servo.compliance.mount->mass_kg, 12.0);
  EXPECT_NEAR(pelvis.servo.compliance.mount->stiffness_N_per_m.x(), 47.4e3, 1e-6);
  EXPECT_EQ(pelvis.servo.compliance.mount->creep_N_per_m, 0.0);
  EXPECT_TRUE(pelvis.servo.depth.rides_on_bone);

  const CellConfig cup = LoadText(CellText("cartilage_cup"));
  ASSERT_TRUE(cup.servo.compliance.layer);
  EXPECT_NEAR(cup.servo.compliance.layer->kappa_N_per_m3[0], 17.3e9, 1.0);
  EXPECT_EQ(cup.servo.compliance.layer->kappa_N_per_m3[1], 0.0) << "cortical bone is hard";
}

TEST(ComplianceKeys, AMountInTheBonesFrameMovesWithTheBone) {
  std::string text = WithCompliance("demo", kMount);
  text = With(text, "at_mm: [620, 0, 130]", "frame: bone\n    at_mm: [0, 0, -80]");
  const CellConfig cell = LoadText(text);
  EXPECT_LT((cell.servo.compliance.mount->p_WMo_m - Vector3(0.62, 0.0, 0.13)).norm(), 1e-9);
}

TEST(ComplianceKeys, AnUnstablePartIsRefusedWithTheNeededValue) {
  EXPECT_EQ(Refusal(WithCompliance("demo", kMount)), "");
  const auto refusal = [](const std::string& from, const std::string& to) {
    return Refusal(With(WithCompliance("demo", kMount), from, to));
  };
  EXPECT_THAT(refusal("\n    damping_ratio: 0.05\n", "\n    damping_ratio: 0.02\n"),
              AllOf(HasSubstr(".yaml:"), HasSubstr("damping_ratio"), HasSubstr("found 0.02"),
                    HasSubstr("at least 0.05")));
  EXPECT_THAT(refusal("mass_kg: 12\n", "mass_kg: 0.2\n"),
              AllOf(HasSubstr("mass_kg"), HasSubstr("found 0.2, accepted at least 0.42")));
  // With a coupling of 100 N/mm and a bone mass of 2 kg, a wall of nearly twice the stiffness acts on the
  // virtual tool.
  const std::string stiff_coupling =
      With(WithCompliance("demo", kMount), "coupling:\n  stiffness_N_per_mm: 20\n",
           "coupling:\n  stiffness_N_per_mm: 100\n");
  EXPECT_EQ(Refusal(stiff_coupling), "");
  EXPECT_THAT(Refusal(With(stiff_coupling, "mass_kg: 12\n", "mass_kg: 2\n")),
              AllOf(HasSubstr("mass_kg"), HasSubstr("found 2, accepted at least 2."),
                    HasSubstr("a wall of 1"), HasSubstr("unstable from 1")));
  EXPECT_THAT(Refusal(WithCompliance("demo", " {mount: on}")),
              HasSubstr("accepted with `bone_mount` beside it"));
  EXPECT_THAT(Refusal(WithCompliance("sawbone_block", " {layer: on}")), HasSubstr("layer_N_per_mm3"));
  // a coupling of 80 N/mm and a drill of 3.2 mm need a relaxation time of more than 20 ms
  std::string stiff = CellText("long_drill");
  stiff = With(stiff, "stiffness_N_per_mm: 60", "stiffness_N_per_mm: 80");
  EXPECT_THAT(Refusal(stiff),
              AllOf(HasSubstr("relaxation_ms"), HasSubstr("found a"), HasSubstr("accepted at least")));
}

// The rules for a mount's translation along an axis also hold for its rotation about the axis, with the lever
// from the mount to the site.
TEST(ComplianceKeys, AMountThatSwingsTooFastOrTooFreelyIsRefused) {
  const auto mounted = [](const std::string& cell, const std::string& inertia, const std::string& stiffness,
                          const std::string& at) {
    std::string text = With(WithCompliance(cell, kMount), "[0.12, 0.12, 0.12]", inertia);
    text = With(text, "[2000, 2000, 2000]", stiffness);
    return With(text, "at_mm: [620, 0, 130]", at);
  };
  const std::string pelvis = "at_mm: [620, 0, 130]";
  // the least inertia is (20 N/mm · L² + k_r) T² / 0.16, with the lever L = 80 mm from the pivot to the cup's
  // centre, the rotational stiffness k_r and the period T = 1 ms
  EXPECT_THAT(Refusal(mounted("demo", "[0.12, 0.005, 0.12]", "[2000, 2000, 2000]", pelvis)),
              AllOf(HasSubstr("inertia_kg_m2"), HasSubstr("found 0.005 about y, accepted at least 0.0133"),
                    HasSubstr("lever of 80 mm")));
  EXPECT_EQ(Refusal(mounted("demo", "[0.12, 0.0134, 0.12]", "[2000, 2000, 2000]", pelvis)), "");
  EXPECT_THAT(Refusal(mounted("demo", "[0.12, 0.12, 0.012]", "[2000, 2000, 2000]", pelvis)),
              AllOf(HasSubstr("found 0.012 about z, accepted at least 0.0125"), HasSubstr("lever of 0 mm")));
  EXPECT_THAT(
      Refusal(mounted("thin_plate_impedance", "[1e-4, 1e-4, 1e-4]", "[100000, 100000, 100000]", pelvis)),
      AllOf(HasSubstr("inertia_kg_m2"), HasSubstr("found 0.0001 about x, accepted at least 0.6")));
}

TEST(ComplianceKeys, AStiffHandNeedsDampingOfTheSwingAtItsLever) {
  std::string text = With(WithCompliance("demo", kMount), "[2000, 2000, 2000]", "[400, 400, 400]");
  text = With(text, "stiffness_N_per_m: 2000\n  damping_Ns_per_m: 60\n",
              "stiffness_N_per_m: 3000\n  damping_Ns_per_m: 10\n");
  EXPECT_EQ(Refusal(text), "") << "80 mm: 108 N s/m of the swing";
  text = With(text, "at_mm: [620, 0, 130]", "at_mm: [620, 0, 30]");
  EXPECT_THAT(Refusal(text),
              AllOf(HasSubstr("damping_ratio"), HasSubstr("found 0.05, accepted at least 0.08"),
                    HasSubstr("about x at its lever of 180 mm")));
}

TEST(ComplianceKeys, WordsAndNumbersOutsideTheirRangesAreRefused) {
  EXPECT_THAT(Refusal(WithCompliance("demo", " {tool: maybe}")),
              AllOf(HasSubstr("tool"), HasSubstr("maybe")));
  EXPECT_THAT(Refusal(WithCompliance("demo", " {tool: auto, error_mm: 50}")), HasSubstr("error_mm"));
  EXPECT_THAT(Refusal(WithCompliance("demo", " {tools: auto}")), HasSubstr("tools"));
}

}  // namespace
}  // namespace osteon::config
