#include "studies/validate/cell_trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/strict/config_error.h"

// Runs a shipped cell in virtual time with its tissues replaced by foam.

namespace osteon::studies {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(OSTEON_SOURCE_DIR) / "config";

// The demo's cup made of this foam, packed coarsely, reamed without tilt for 4 s.
CellTrialParams FoamCup(const std::string& foam) {
  return {.cell = "demo",
          .set = {"scene.shape.cartilage_mm=0", "scene.shape.subchondral_mm=0", "scene.packing.spacing_mm=3",
                  "scene.packing.surface_gap_mm=0.2", "scene.packing.sample_spacing_mm=1",
                  "scene.mass_points.spacing_mm=1.5", "scene.events.min_wall_mm=0", "script.tilt_deg=0"},
          .tissues = {{.tissue = "cancellous", .material = foam}},
          .seconds = 4.0,
          .as_packed = true};
}

TEST(CellTrial, DenserFoamIsReamedLessAndTheCavityIsAsWideAsTheReamer) {
  const auto light = RunCellTrial(kShipped, FoamCup("foam_10"));
  const auto dense = RunCellTrial(kShipped, FoamCup("foam_20"));
  ASSERT_TRUE(light) << light.error();
  ASSERT_TRUE(dense) << dense.error();
  EXPECT_EQ(light->ended, "completed");
  EXPECT_TRUE(light->faults.empty());
  EXPECT_GT(light->removed_m3, 1.2 * dense->removed_m3);
  EXPECT_GT(light->seated_m, dense->seated_m + 0.1e-3);
  ASSERT_TRUE(dense->fit) << dense->fit_refused;
  EXPECT_NEAR(dense->fit->radius_m, 0.025, 0.02e-3);
  EXPECT_GT(dense->pressed_s, 1.0);
}

TEST(CellTrial, TwoRunsGiveEqualFigures) {
  const auto first = RunCellTrial(kShipped, FoamCup("foam_20"));
  const auto second = RunCellTrial(kShipped, FoamCup("foam_20"));
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->removed_m3, second->removed_m3);
  EXPECT_EQ(first->force_difference, second->force_difference);
  EXPECT_EQ(first->feed_per_turn_m, second->feed_per_turn_m);
}

TEST(CellTrial, RefusesUnknownTissuesMaterialsAndKeys) {
  CellTrialParams params = FoamCup("foam_11");
  EXPECT_THAT(RunCellTrial(kShipped, params).error(), testing::HasSubstr("no material foam_11"));
  params = FoamCup("foam_10");
  params.tissues.push_back({.tissue = "marrow", .material = "foam_10"});
  EXPECT_THAT(RunCellTrial(kShipped, params).error(), testing::HasSubstr("no tissue marrow"));
  params = FoamCup("foam_10");
  params.set.emplace_back("script.no_such_key=1");
  EXPECT_THROW(static_cast<void>(RunCellTrial(kShipped, params)), config::ConfigError);
}

}  // namespace
}  // namespace osteon::studies
