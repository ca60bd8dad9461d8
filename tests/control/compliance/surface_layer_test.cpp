#include "control/compliance/surface_layer.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

// Tests the soft layer on the bone: indentation by a ball against Winkler's formula, relaxation, and the
// limits of the indentation.

namespace osteon::control {
namespace {

constexpr double kT_s = 1e-3, kRadius_m = 25e-3;  // period of a tick; radius of the ball of a 50 mm reamer
constexpr double kE_m = 0.5e-3;                   // thickness of the engaged layer
const double kTouch_m2 = std::numbers::pi * kRadius_m * kE_m;

// A layer touched by the reamer's ball.
SurfaceLayerParams Layer(double kappa_N_per_m3, double thickness_m = 0.02, double tau_s = 0.2) {
  SurfaceLayerParams params;
  params.kappa_N_per_m3[0] = kappa_N_per_m3;
  params.thickness_m = thickness_m;
  params.tau_s = tau_s;
  params.engaged_layer_m = kE_m;
  params.touch_area_m2 = kTouch_m2;
  params.max_area_m2 = std::numbers::pi * kRadius_m * kRadius_m;
  return params;
}

// The contact of a ball that just touches the bone. @param share  share of the contact that lies in the layer
LayerContact Touch(const SurfaceLayerParams& params, double share = 1.0) {
  return {.kappa_N_per_m3 = params.kappa_N_per_m3[0], .share = share, .area_m2 = kTouch_m2};
}

// Pressure per indentation [N/m³]: soft tissue of 0.3 MPa over 5 mm; cartilage under slow and fast load.
constexpr double kSoft = 0.06e9, kSlow = 17.3e9, kFast = 68.7e9;

TEST(SurfaceLayer, IndentationByABallFollowsWinkler) {
  const SurfaceLayerParams soft = Layer(kSoft);
  for (const double force_N : {5.0, 20.0, 100.0}) {
    const double delta_m = LayerIndentation(soft, Touch(soft), force_N);
    EXPECT_NEAR(std::numbers::pi * kSoft * kRadius_m * delta_m * delta_m, force_N, 1e-9 * force_N);
  }
  EXPECT_NEAR(1e3 * LayerIndentation(soft, Touch(soft), 5.0), 1.030, 0.0103);
  EXPECT_NEAR(1e3 * LayerIndentation(soft, Touch(soft), 20.0), 2.060, 0.0206);
  EXPECT_NEAR(1e3 * LayerIndentation(soft, Touch(soft), 100.0), 4.607, 0.0461);
  const SurfaceLayerParams slow = Layer(kSlow), fast = Layer(kFast);
  EXPECT_NEAR(1e3 * LayerIndentation(slow, Touch(slow), 20.0), 0.1213, 0.0013);
  EXPECT_NEAR(1e3 * LayerIndentation(fast, Touch(fast), 100.0), 0.1361, 0.0014);
}

// The tool is held 3 mm deep in a soft layer, with a coupling of 20 N/mm. The force falls over 2 s as the
// layer yields.
TEST(SurfaceLayer, TheForceOnAHeldToolRelaxes) {
  const SurfaceLayerParams soft = Layer(kSoft);
  Vector3 q = Vector3::Zero();
  for (int i = 0; i <= 2000; ++i) {
    const double force_N = 20e3 * (3e-3 + q.z());
    if (i == 0) {
      EXPECT_NEAR(force_N, 60.0, 1e-9);
    }
    if (i == 50) {
      EXPECT_NEAR(force_N, 45.35, 0.45);
    }
    if (i == 200) {
      EXPECT_NEAR(force_N, 25.61, 0.26);
    }
    if (i == 400) {
      EXPECT_NEAR(force_N, 20.24, 0.20);
    }
    if (i == 2000) {
      EXPECT_NEAR(force_N, 19.41, 0.19);
    }
    q = StepLayer(soft, Touch(soft), {0.0, 0.0, force_N}, kT_s, q);
  }
}

TEST(SurfaceLayer, IsContinuousBetweenItsPieces) {
  const SurfaceLayerParams soft = Layer(kSoft);
  EXPECT_NEAR(LayerIndentation(soft, Touch(soft), 0.999999), LayerIndentation(soft, Touch(soft), 1.000001),
              1e-8);
  // the contact has half of the largest area, and 200 N indent the layer beyond delta_s: from there on the
  // force is linear, with the slope kappa A_max
  LayerContact seated = Touch(soft);
  seated.area_m2 = 0.5 * soft.max_area_m2;
  const double slope = kSoft * soft.max_area_m2;
  const double at = LayerIndentation(soft, seated, 200.0), more = LayerIndentation(soft, seated, 201.0);
  EXPECT_NEAR(1.0 / (more - at), slope, 1e-3 * slope);
}

// The indentation depends on the share of the contact that lies in the layer: full at a share of 1, half at
// 0.75, none at 0.5.
TEST(SurfaceLayer, YieldsAtMostTwoFifthsOfItsThicknessAndFadesWithItsShare) {
  const SurfaceLayerParams thin = Layer(kSoft, 5e-3);
  EXPECT_DOUBLE_EQ(LayerIndentation(thin, Touch(thin), 200.0), 2e-3);
  EXPECT_EQ(LayerIndentation(thin, Touch(thin, 0.5), 20.0), 0.0);
  EXPECT_NEAR(LayerIndentation(thin, Touch(thin, 0.75), 5.0), 0.5 * LayerIndentation(thin, Touch(thin), 5.0),
              1e-12);
  EXPECT_EQ(LayerIndentation(thin, {}, 20.0), 0.0);
}

TEST(SurfaceLayer, ItsContactIsTheWeightedMeanOverTheFramesContacts) {
  SurfaceLayerParams params = Layer(kSlow);
  params.kappa_N_per_m3[2] = 0.0;
  simulation::ContactModel model;
  model.contact_count = 2;
  model.engaged_area_m2 = 80e-6;
  model.contacts[0].weight = 0.6;
  model.contacts[1].weight = 0.2;
  model.contacts[1].material = 2;
  const LayerContact contact = LayerOf(params, model);
  EXPECT_NEAR(contact.share, 0.75, 1e-12);
  EXPECT_DOUBLE_EQ(contact.kappa_N_per_m3, kSlow);
  EXPECT_DOUBLE_EQ(contact.area_m2, 80e-6);
  model.contacts[0].weight = std::nan("");
  model.contacts[1].material = 255;
  EXPECT_EQ(LayerOf(params, model).share, 0.0) << "a damaged frame has no layer";
}

}  // namespace
}  // namespace osteon::control
