#include "simulation/bone/material.h"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>

// Tests of lists of materials: their limits, their assumptions, and the split of their cutting energy.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

TEST(Materials, EachFigureWithoutASourceIsListedWithItsValue) {
  const std::vector<Material> materials{{.name = "foam",
                                         .density_kg_per_m3 = 320.0,
                                         .specific_cutting_energy_J_per_m3 = 0.05e9,
                                         .cutting_force_ratio = 0.7,
                                         .friction = 0.25,
                                         .density_source = {.text = "ASTM F1839", .assumed = false},
                                         .cutting_energy_source = {.text = "a guess", .assumed = true},
                                         .cutting_force_source = {.text = "measured", .assumed = false},
                                         .friction_source = {}}};
  EXPECT_THAT(Assumptions(materials),
              testing::ElementsAre("foam: cutting energy 0.05 J/mm³ (a guess)", "foam: friction 0.25"));
}

TEST(Materials, DefaultBoneMaterialsAreValidAndListTheirAssumptions) {
  const std::vector<Material> bone = DefaultBoneMaterials();
  EXPECT_NO_THROW(CheckMaterials(bone));
  const std::vector<std::string> assumed = Assumptions(bone);
  EXPECT_THAT(assumed, testing::Contains(HasSubstr("cancellous: cutting energy 0.06 J/mm³")));
  EXPECT_THAT(assumed, testing::Not(testing::Contains(HasSubstr("cortical: density"))));
}

TEST(Materials, ListsMustHaveOneToEightNamedMaterialsWithFiguresInRange) {
  const auto refusal = [](const std::function<void(std::vector<Material>&)>& change) -> std::string {
    std::vector<Material> materials = DefaultBoneMaterials();
    change(materials);
    try {
      CheckMaterials(materials);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  using List = std::vector<Material>&;
  EXPECT_EQ(refusal([](List m) { m.clear(); }), "bone: materials: found 0, accepted 1 … 8");
  EXPECT_EQ(refusal([](List m) { m.resize(9); }), "bone: materials: found 9, accepted 1 … 8");
  EXPECT_EQ(refusal([](List m) { m[1].name = "cartilage"; }),
            "bone: material 1: found name 'cartilage' of material 0, accepted different names");
  EXPECT_EQ(refusal([](List m) { m[3].name = ""; }), "bone: material 3: found no name, accepted one");
  EXPECT_EQ(refusal([](List m) { m[0].cutting_force_ratio = 0; }),
            "bone: cartilage: cutting_force_ratio: found 0, accepted > 0");
  EXPECT_THAT(refusal([](List m) { m[2].specific_cutting_energy_J_per_m3 = -1; }),
              HasSubstr("found -1, accepted > 0"));
  EXPECT_THAT(refusal([](List m) { m[2].friction = 2.5; }), HasSubstr("friction: found 2.5, accepted 0 … 2"));
  EXPECT_THAT(refusal([](List m) { m[1].measured_chip_m = 0.0; }),
              HasSubstr("cortical: measured_chip_m: found 0, accepted > 0"));
  EXPECT_THAT(refusal([](List m) { m[1].edge_force_N_per_m = 1.3e9 * 48e-6; }),
              HasSubstr("cortical: edge_force_N_per_m: found 62400, accepted 0 and more, below 62400"));
  EXPECT_THAT(refusal([](List m) { m[1].edge_force_N_per_m = std::nan(""); }), HasSubstr("found nan"));
}

// The measured cutting energy is split into that of the chip and that of the edge's force. At the chip
// thickness of the measurement their sum must be the measured value, for any number of edges.
TEST(Materials, SplitCuttingEnergyAddsUpToTheMeasuredAtTheMeasuredChip) {
  const Material measured = DefaultBoneMaterials()[1];
  for (const int edges : {1, 2, 6}) {
    const Material split = SplitCuttingEnergy({measured}, edges)[0];
    const double at_measured_chip =
        split.specific_cutting_energy_J_per_m3 + split.edge_force_N_per_m / edges / measured.measured_chip_m;
    EXPECT_NEAR(at_measured_chip, measured.specific_cutting_energy_J_per_m3, 1.0) << edges;
    EXPECT_LT(split.specific_cutting_energy_J_per_m3, measured.specific_cutting_energy_J_per_m3);
  }
}

}  // namespace
}  // namespace osteon::simulation
