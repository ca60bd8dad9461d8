#include "simulation/tools/tool_compliance.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/tools/tool_kinds.h"

// Compliance of tools as beams, against analytic cantilevers and against the stiffnesses in
// docs/theory/compliance.md.

namespace osteon::simulation {
namespace {

constexpr double kSteel_Pa = 193e9;  // Young's modulus

// Second moment of area of a round section in m⁴.
double SecondMoment(double d_m) { return std::numbers::pi / 64.0 * std::pow(d_m, 4); }

ToolCompliance Drill(double diameter_mm, double flute_mm, double length_mm) {
  const BuiltTool built = MakeTwistDrill({.diameter_m = 1e-3 * diameter_mm,
                                          .flute_length_m = 1e-3 * flute_mm,
                                          .length_m = 1e-3 * length_mm,
                                          .flute_gap_m = 0.12e-3 * diameter_mm,
                                          .balls = {.max_count = 64,
                                                    .cutting_gap_m = 0.04e-3 * diameter_mm,
                                                    .touching_gap_m = 0.25e-3 * diameter_mm}});
  return CantileverCompliance(built.beam, {.load_point_m = built.load_point_m});
}

// The first clamped_mm of the burr's shaft, from the back, are held in the chuck.
ToolCompliance RoundBurr(double diameter_mm, double neck_mm, double clamped_mm = 0.0) {
  const BuiltTool built = MakeBurr(
      {.diameter_m = 1e-3 * diameter_mm,
       .neck_diameter_m = 1e-3 * neck_mm,
       .balls = {.max_count = 64, .cutting_gap_m = 0.01e-3 * diameter_mm, .touching_gap_m = 0.15e-3}});
  return CantileverCompliance(built.beam, {.clamped_m = 1e-3 * clamped_mm,
                                           .load_point_m = built.load_point_m,
                                           .head_mass_kg = built.head_mass_kg});
}

TEST(ToolCompliance, AUniformShaftHasTheTextbooksCompliance) {
  constexpr double d = 4e-3, L = 0.1, kPoisson = 0.29;
  const std::vector<BeamPiece> shaft{
      {.from_m = 0.0, .to_m = L, .from_radius_m = 0.5 * d, .to_radius_m = 0.5 * d}};
  const ToolCompliance c = CantileverCompliance(shaft, {});
  const double EI = kSteel_Pa * SecondMoment(d), EA = kSteel_Pa * std::numbers::pi / 4.0 * d * d;
  const double GJ = kSteel_Pa / (2.0 * (1.0 + kPoisson)) * 2.0 * SecondMoment(d);
  EXPECT_NEAR(c.C_T(0, 0) / (L * L * L / (3.0 * EI)), 1.0, 1e-9);
  EXPECT_NEAR(c.C_T(0, 4) / (L * L / (2.0 * EI)), 1.0, 1e-9);
  EXPECT_NEAR(c.C_T(1, 3) / (-L * L / (2.0 * EI)), 1.0, 1e-9);
  EXPECT_NEAR(c.C_T(3, 3) / (L / EI), 1.0, 1e-9);
  EXPECT_NEAR(c.C_T(2, 2) / (L / EA), 1.0, 1e-9);
  EXPECT_NEAR(c.C_T(5, 5) / (L / GJ), 1.0, 1e-9);
  EXPECT_NEAR(c.buckling_N / (std::numbers::pi * std::numbers::pi * EI / (4.0 * L * L)), 1.0, 1e-6);
  EXPECT_TRUE(c.C_T.isApprox(c.C_T.transpose()));
  // For a force at the distance s behind the apex, LateralCompliance exceeds that of the clamped beam of
  // length L - s by the share (s / (L - s))^3: 3.7 % at s = L / 4.
  EXPECT_NEAR(LateralCompliance(c.C_T, 0.25 * L) / (std::pow(0.75 * L, 3) / (3.0 * EI)), 1.0 + 1.0 / 27.0,
              1e-9);
}

TEST(ToolCompliance, AConeHasTheComplianceOfItsIntegral) {
  // a fine sum of int s^2 / (E I(s)) ds, with I = pi/4 r(s)^4 and a radius that is linear in s
  constexpr double kFront = 1e-3, kBack = 3e-3, L = 0.05;
  const std::vector<BeamPiece> cone{
      {.from_m = 0.0, .to_m = L, .from_radius_m = kFront, .to_radius_m = kBack}};
  double exact = 0.0;
  constexpr int kSteps = 2'000'000;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) * L / kSteps, r = kFront + (kBack - kFront) * s / L;
    exact += s * s / (kSteel_Pa * std::numbers::pi / 4.0 * r * r * r * r) * L / kSteps;
  }
  EXPECT_NEAR(CantileverCompliance(cone, {}).C_T(0, 0) / exact, 1.0, 1e-4);
}

// Stiffnesses as in the tables of docs/theory/compliance.md, within 1 %.
TEST(ToolCompliance, TheShippedToolsHaveTheDesignsStiffness) {
  const ToolCompliance drill = Drill(3.2, 36, 65);
  EXPECT_NEAR(drill.lateral_N_per_m, 8720.0, 87.2);
  EXPECT_NEAR(drill.C_T(0, 4), 3.065e-3, 3.1e-5) << "slope at the apex by a newton";
  EXPECT_NEAR(Drill(2, 24, 49).lateral_N_per_m, 3306.0, 33.1);
  EXPECT_NEAR(Drill(4, 43, 75).lateral_N_per_m, 13570.0, 135.7);
  EXPECT_NEAR(1.0 / RoundBurr(2.3, 1.26).C_T(0, 0), 9552.0, 95.5);
  EXPECT_NEAR(RoundBurr(1.8, 0.99).lateral_N_per_m, 10020.0, 100.2);
  const BuiltTool canal = MakeReamer({.diameter_m = 0.014,
                                      .shell_m = 0.003,
                                      .shaft_radius_m = 0.004,
                                      .shaft_length_m = 0.15,
                                      .touching_length_m = 0.15});
  const ToolCompliance canal_c = CantileverCompliance(
      canal.beam, {.load_point_m = canal.load_point_m, .head_mass_kg = canal.head_mass_kg});
  EXPECT_NEAR(canal_c.lateral_N_per_m, 34490.0, 344.9);
  EXPECT_NEAR(canal_c.first_mode_hz, 215.0, 2.15);
  const BuiltTool cup = MakeReamer({});
  EXPECT_NEAR(CantileverCompliance(cup.beam, {.load_point_m = cup.load_point_m}).lateral_N_per_m, 847.8e3,
              8.5e3);
}

TEST(ToolCompliance, DrillsBuckleWhereTheDesignSays) {
  EXPECT_NEAR(Drill(2, 24, 49).buckling_N, 122.8, 1.3);
  EXPECT_NEAR(Drill(3.2, 36, 65).buckling_N, 422.6, 4.2);
  EXPECT_NEAR(Drill(4, 43, 75).buckling_N, 755.8, 7.6);
}

TEST(ToolCompliance, ADeeperChuckStiffensAndAThrustSoftens) {
  const double free = RoundBurr(2.3, 1.26).lateral_N_per_m, held = RoundBurr(2.3, 1.26, 25.0).lateral_N_per_m;
  EXPECT_GT(held, 8.0 * free);
  EXPECT_NEAR(ThrustFactor(60.0, 422.6), 1.0 / (1.0 - 60.0 / 422.6), 1e-15);
  EXPECT_THROW(static_cast<void>(ThrustFactor(500.0, 422.6)), std::invalid_argument);
}

TEST(ToolCompliance, RefusesToolsThatCannotBend) {
  const std::vector<BeamPiece> head{{.from_m = 0.0, .to_m = 0.01, .rigid = true}};
  EXPECT_THROW(static_cast<void>(CantileverCompliance(head, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(CantileverCompliance({}, {})), std::invalid_argument);
  const std::vector<BeamPiece> shaft{
      {.from_m = 0.0, .to_m = 0.1, .from_radius_m = 2e-3, .to_radius_m = 2e-3}};
  EXPECT_THROW(static_cast<void>(CantileverCompliance(shaft, {.clamped_m = 0.1})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(CantileverCompliance(shaft, {.youngs_Pa = 1.0})), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
