#include "simulation/fidelity/removal_error.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "simulation/fidelity/packing_level.h"
#include "tests/oracles/depth_table.h"

// Compares the closed forms for a packing's removal error with packings that were carved and measured.

namespace osteon::simulation {
namespace {

constexpr AccuracyParams kMeasureParams{.probe_radii_m = {}, .surface_cells = 12'000, .probe_samples = 2000};

/// Predicted and measured errors of one carved packing.
struct Carved {
  RemovalError predicted;
  double leak_m{0.0};    ///< predicted mean depth to which a probe of radius 1 mm sinks
  CutAccuracy measured;  ///< probes: R, R/2, 1 mm
  /// Measured over predicted loss.
  [[nodiscard]] double ratio() const { return measured.depth_error_m / predicted.total_m(); }
};

/// The cut of MakeCupScene: the whole surface of a cup, 3 mm deep.
CutShape CupShape() {
  // no rim, because the cut's depth falls to zero at the shell's rim
  return {
      .tool_radius_m = 25e-3, .along_surface = true, .depth_m = 3e-3, .area_m2 = 2.0 * M_PI * 25e-3 * 25e-3};
}

/// The cut of MakeBlockScene.
CutShape TrenchShape() {
  // a trench 6 mm long between two quarters of a ball, as deep as the ball's radius
  const double R = 5e-3, along = 6e-3;
  const double area = 2.0 * M_PI * R * R + M_PI * R * along;
  return {.tool_radius_m = R, .rim_per_area_1_per_m = (2.0 * M_PI * R + 2.0 * along) / area, .area_m2 = area};
}

/// Packs the scene at this level, carves it along the scene's path and measures it.
Carved Carve(const DepthScene& scene, const CutShape& cut, const PackingLevel& level) {
  DepthMethod method{.name = std::string(KindName(level.kind)),
                     .balls = PackLevel(level, *scene.solid, *scene.zone),
                     .split = CuttingForLevel(level, cut, {}).split};
  const DepthRow row = MeasureDepth(scene, method, 0.2e-3, kMeasureParams);
  EXPECT_EQ(row.refused, 0u) << "the pool has no room";
  const Carved carved{.predicted = PredictRemovalError(level.fine, cut),
                      .leak_m = PredictLeak(level.fine, cut, 1e-3),
                      .measured = row.accuracy};
  std::printf("%s %s a %.2f mm: %zu balls, measured %.4f, predicted %.4f + %.4f mm, leak %.4f of %.4f mm\n",
              scene.name.c_str(), method.name.c_str(), level.fine.spacing_m * 1e3, row.balls,
              carved.measured.depth_error_m * 1e3, carved.predicted.face_m * 1e3,
              carved.predicted.rim_m * 1e3, carved.measured.probes[2].mean_m * 1e3, carved.leak_m * 1e3);
  return carved;
}

// The limits 0.55 and 1.2 are those of PredictRemovalError. A plan uses 0.8 of the permitted error, so a cut
// with 1.2 times the predicted error is still within it.
TEST(RemovalError, PredictionHoldsInACup) {
  const DepthScene scene = MakeCupScene();
  for (const auto& [spacing_mm, ratio] : {std::pair{4.0, 1.25}, {2.5, 1.6}, {1.5, 2.0}}) {
    const Carved carved =
        Carve(scene, CupShape(), MakeLevel(PackingKind::kGraded, 1e-3 * spacing_mm, ratio, CupShape(), 3e-3));
    EXPECT_GT(carved.ratio(), 0.55) << spacing_mm;
    EXPECT_LT(carved.ratio(), 1.2) << spacing_mm;
    EXPECT_GT(carved.measured.probes[2].mean_m, 0.5 * carved.leak_m);
    EXPECT_LT(carved.measured.probes[2].mean_m, 1.2 * carved.leak_m);
  }
}

TEST(RemovalError, PredictionHoldsInATrench) {
  const DepthScene scene = MakeBlockScene();
  for (const double spacing_mm : {1.4, 1.0, 0.7}) {
    const Carved carved = Carve(scene, TrenchShape(),
                                MakeLevel(PackingKind::kGraded, 1e-3 * spacing_mm, 1.2, TrenchShape(), 0.0));
    EXPECT_GT(carved.ratio(), 0.55) << spacing_mm;
    EXPECT_LT(carved.ratio(), 1.2) << spacing_mm;
  }
}

// Large balls that overlap heavily reproduce the cut face well, but the rim badly. Without the rim's term the
// prediction would be less than two thirds of the measured loss.
TEST(RemovalError, PredictionIncludesTheRim) {
  const CutShape cut = TrenchShape();
  PackingLevel level = MakeLevel(PackingKind::kGraded, 0.7e-3, 1.5, cut, 0.0);
  const Carved carved = Carve(MakeBlockScene(), cut, level);
  EXPECT_GT(carved.measured.depth_error_m, 1.5 * carved.predicted.face_m);
  EXPECT_GT(carved.ratio(), 0.55);
  EXPECT_LT(carved.ratio(), 1.25);
}

TEST(RemovalError, PredictionHoldsWhenBallsAreSplit) {
  const DepthScene scene = MakeBlockScene();
  for (const double spacing_mm : {2.5, 1.5}) {
    const Carved carved = Carve(scene, TrenchShape(),
                                MakeLevel(PackingKind::kSplit, 1e-3 * spacing_mm, 1.0, TrenchShape(), 0.0));
    EXPECT_GT(carved.ratio(), 0.55) << spacing_mm;
    EXPECT_LT(carved.ratio(), 1.2) << spacing_mm;
  }
}

// Oracle: root mean square of the exact slopes of a ball that slides over a row of equal balls.
TEST(RemovalError, PredictedCoggingIsTheMeanSlopeOverARowOfBalls) {
  const PackingFineness fine{.radius_m = 2e-3, .surface_gap_m = 0.05e-3};
  const double R = 5e-3, apart = std::sqrt(fine.surface_gap_m * fine.radius_m / 0.25);
  double squares = 0.0;
  constexpr int kSteps = 1000;
  for (int k = 0; k < kSteps; ++k) {
    const double x = ((k + 0.5) / kSteps - 0.5) * apart, slope = x / std::sqrt(std::pow(R + 2e-3, 2) - x * x);
    squares += slope * slope / kSteps;
  }
  EXPECT_NEAR(PredictCogging(fine, R), std::sqrt(squares), 0.01 * std::sqrt(squares));
}

}  // namespace
}  // namespace osteon::simulation
