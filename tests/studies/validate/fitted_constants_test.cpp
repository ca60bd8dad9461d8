#include "studies/validate/fitted_constants.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "studies/validate/constant_feed.h"
#include "studies/validate/measurements.h"
#include "studies/validate/validation_rows.h"

// The list of constants that were fitted to measurements: it must agree with the shipped materials, and no
// measurement may judge a constant that was fitted to it.

namespace osteon::studies {
namespace {

const std::filesystem::path kMaterials = std::filesystem::path(OSTEON_SOURCE_DIR) / "config" / "materials";

bool IsAssumed(const simulation::Material& material, CutConstant constant) {
  if (constant == CutConstant::kCuttingEnergy) return material.cutting_energy_source.assumed;
  if (constant == CutConstant::kCuttingForceRatio) return material.cutting_force_source.assumed;
  return material.edge_force_source.assumed;
}

TEST(FittedConstants, AreExactlyTheShippedConstantsThatAreNotAssumed) {
  std::set<std::string> measured;
  for (const char* file : {"bone.yaml", "sawbone.yaml", "tooth.yaml"})
    for (const simulation::Material& material : config::LoadMaterials(kMaterials / file))
      for (const CutConstant constant :
           {CutConstant::kCuttingEnergy, CutConstant::kCuttingForceRatio, CutConstant::kEdgeForce}) {
        if (IsAssumed(material, constant)) continue;
        const auto listed = std::ranges::find_if(FittedConstants(), [&](const FittedConstant& fitted) {
          return fitted.file == file && fitted.material == material.name && fitted.constant == constant;
        });
        ASSERT_NE(listed, FittedConstants().end())
            << file << " " << material.name << " " << NameOf(constant) << " has a source, and is not listed";
        EXPECT_DOUBLE_EQ(listed->value, ValueOf(material, constant)) << listed->name();
        measured.insert(listed->name());
      }
  EXPECT_EQ(measured.size(), FittedConstants().size()) << "a listed constant is assumed in its file";
}

TEST(FittedConstants, EachNamesAtLeastOneExistingMeasurement) {
  for (const FittedConstant& fitted : FittedConstants()) {
    EXPECT_FALSE(fitted.fitted_to.empty()) << fitted.name();
    for (const auto& ids : {fitted.fitted_to, fitted.minor})
      for (const std::string_view id : ids)
        EXPECT_NE(FindMeasurement(id), nullptr) << fitted.name() << " " << id;
  }
}

TEST(FittedConstants, ARowToWhichAConstantWasFittedOnlyCalibrates) {
  for (const FittedConstant& fitted : FittedConstants())
    for (const std::string_view id : fitted.fitted_to)
      EXPECT_EQ(FindMeasurement(id)->use, RowUse::kCalibrates) << fitted.name() << " was fitted to " << id;
}

TEST(FittedConstants, ARowIsFittedIfOneOfItsConstantsWasFittedToIt) {
  ValidationRow row{.measurement = FindMeasurement("8-level"), .simulated = {.value = 198.4, .how = ""}};
  EXPECT_FALSE(row.fitted());
  EXPECT_EQ(row.verdict(), "calibrates") << "its use says so";
  row.simulated.constants = {"cortical.cutting_force_ratio"};
  EXPECT_TRUE(row.fitted());
  row.measurement = FindMeasurement("9-1000");
  row.simulated.value = 87.2;
  EXPECT_FALSE(row.fitted())
      << "the ratio of torque and thrust of human cortex was not fitted to Sawbones' thrust";
  EXPECT_EQ(row.verdict(), "within");
  row.simulated.value = 100.0;
  EXPECT_EQ(row.verdict(), "misses");
}

// The ratio of the thrusts at two spindle speeds must not change if cutting energy and edge force are scaled
// together, nor if the force ratio changes. It depends only on the edge's share of the energy.
TEST(FittedConstants, TheThrustRatioOverSpeedDependsOnlyOnTheEdgesShare) {
  const auto ratio = [](double energy_factor, double ratio_factor) {
    simulation::Material material = config::LoadMaterials(kMaterials / "bone.yaml")[1];
    material.specific_cutting_energy_J_per_m3 *= energy_factor;
    material.edge_force_N_per_m *= energy_factor;
    material.cutting_force_ratio *= ratio_factor;
    const auto thrust = [&](double spindle_rad_per_s) {
      return DrillAtConstantFeed({.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config",
                                  .material = material,
                                  .spindle_rad_per_s = spindle_rad_per_s,
                                  .steps = {{.feed_m_per_s = 0.002, .depth_m = 0.003}},
                                  .packing_scale = 2.0})
          .thrust_N;
    };
    return thrust(157.0) / thrust(104.7);
  };
  EXPECT_NEAR(ratio(1.0, 1.0), ratio(0.5, 1.2), 0.01);
}

}  // namespace
}  // namespace osteon::studies
