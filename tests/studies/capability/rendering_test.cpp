#include "studies/capability/rendering.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/load.h"
#include "config/reading/tool_mobility.h"
#include "control/excitation/multisine.h"
#include "studies/capability/capability_result.h"
#include "studies/identify/servo_response.h"

namespace osteon::studies {
namespace {

config::CellConfig CellNamed(const std::string& name) {
  return config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells" / (name + ".yaml"));
}

/// An identified arm's response along an axis ("x", "y" or "z"), critically damped.
config::IdentifiedArm ArmAlong(const char* axis, double bandwidth_hz, double dead_time_s) {
  return {.axis = axis,
          .speed_m_per_s = 0.02,
          .bandwidth_hz = bandwidth_hz,
          .damping_ratio = 1.0,
          .dead_time_s = dead_time_s,
          .lag_s = dead_time_s + 1.0 / (std::numbers::pi * bandwidth_hz),
          .chi2 = 1.0};
}

TEST(Rendering, UsesAssumptionsWhereNothingWasMeasured) {
  const Rendering rendering = RenderingOf(CellNamed("demo"));
  EXPECT_EQ(rendering.force_floor_N(), 0.0) << "the demonstration's sensor has no errors";
  EXPECT_FALSE(rendering.floor_measured());
  EXPECT_FALSE(rendering.sensor_delay_s.measured);
  ASSERT_EQ(rendering.axes.size(), 3u);
  for (const RenderedAxis& axis : rendering.axes) {
    EXPECT_NEAR(axis.lag_s.value, 24.221e-3, 1e-6);
    EXPECT_FALSE(axis.lag_s.measured);
    ASSERT_TRUE(axis.felt_mass_kg);
    EXPECT_FALSE(axis.felt_mass_kg->measured);
    EXPECT_GT(axis.least_drag_Ns_per_m.value(), 1.0);
    EXPECT_GT(axis.greatest_wall_N_per_m.value(), axis.asked_wall_N_per_m);
    EXPECT_TRUE(axis.stands);
  }
  // the tool points down, along the base's z axis
  EXPECT_NEAR(rendering.axes[2].felt_mass_kg->value, 1.0 / (*config::ToolMobility(CellNamed("demo")))(2, 2),
              1e-9);
  session::Verdict verdict;
  JudgeRendering(rendering, verdict);
  EXPECT_TRUE(verdict.reasons.empty());
  EXPECT_TRUE(RenderingRows(rendering, 384.0).front().value.starts_with("below 0.001 N, from dead zone 0 N"));
  EXPECT_TRUE(RenderingJson(rendering, 384.0).at("force_range_ratio").is_null());
}

// Measured values equal to the assumed ones give the same results, marked as measured.
TEST(Rendering, AMeasuredArmGivesTheResultsOfTheSameArmAssumed) {
  config::CellConfig cell = CellNamed("demo");
  const Rendering assumed = RenderingOf(cell);
  cell.identified.emplace();
  cell.identified->arm = {ArmAlong("z", 15.0, 3e-3)};
  cell.identified->arm[0].felt_mass_kg = 5.4;
  cell.identified->sensor = config::IdentifiedSensor{.delay_s = 1e-3, .noise_N = 0.08, .drift_N = 0.06};
  const Rendering measured = RenderingOf(cell);
  const RenderedAxis& z = measured.axes[2];
  EXPECT_TRUE(z.lag_s.measured);
  EXPECT_NEAR(z.lag_s.value, 24.221e-3, 1e-6);
  EXPECT_EQ(z.felt_mass_kg->value, 5.4);
  EXPECT_TRUE(z.felt_mass_kg->measured);
  EXPECT_FALSE(measured.axes[0].lag_s.measured) << "along x nothing was measured";
  EXPECT_FALSE(measured.axes[0].felt_mass_kg->measured);
  EXPECT_NEAR(measured.force_floor_N(), 3.0 * 0.1, 1e-12);
  EXPECT_TRUE(measured.floor_measured());
  EXPECT_NEAR(RenderingJson(measured, 384.0).at("force_range_ratio").get<double>(), 1280.0, 1e-6);
  // only the measured mass changes the loop along z: if it is removed, the results are those of the assumed
  // arm
  cell.identified->arm[0].felt_mass_kg.reset();
  EXPECT_EQ(RenderingOf(cell).axes[2].least_drag_Ns_per_m, assumed.axes[2].least_drag_Ns_per_m);
  EXPECT_EQ(RenderingOf(cell).axes[2].greatest_wall_N_per_m, assumed.axes[2].greatest_wall_N_per_m);
}

TEST(Rendering, ADeadZoneAboveTheSensorsErrorsIsTheSmallestForce) {
  config::CellConfig cell = CellNamed("demo");
  cell.servo.admittance.dead_zone_N = 2.0;
  cell.identified.emplace();
  cell.identified->sensor = config::IdentifiedSensor{.noise_N = 0.08, .drift_N = 0.06};
  EXPECT_EQ(RenderingOf(cell).force_floor_N(), 2.0);
}

TEST(Rendering, ASlowerArmRendersLessAndIsWarnedAboutAlongItsAxisOnly) {
  config::CellConfig cell = CellNamed("demo");
  cell.identified.emplace();
  cell.identified->arm = {ArmAlong("x", 15.0, 3e-3), ArmAlong("z", 6.0, 12e-3)};
  const Rendering rendering = RenderingOf(cell);
  const RenderedAxis &x = rendering.axes[0], &z = rendering.axes[2];
  EXPECT_GT(*z.least_drag_Ns_per_m, 1.5 * *x.least_drag_Ns_per_m);
  EXPECT_LT(*z.greatest_wall_N_per_m, *x.greatest_wall_N_per_m);
  EXPECT_TRUE(x.stands);
  EXPECT_FALSE(z.stands);
  session::Verdict verdict;
  JudgeRendering(rendering, verdict);
  ASSERT_EQ(verdict.reasons.size(), 1u);
  EXPECT_EQ(verdict.level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(verdict.reasons[0].starts_with("along z, by the measured arm: lag ")) << verdict.reasons[0];

  CapabilityResult result;
  result.best_angle = result.own_angle = {.force = {.axial_N = 384.0, .factor = 1.5}, .poses = 1};
  result.rendering = rendering;
  EXPECT_EQ(Judge(result).level, session::VerdictLevel::kWarning) << "never greener than the loop";
  const auto json = nlohmann::json::parse(ToJson(result, "osteon capability")).at("rendering");
  EXPECT_EQ(json.at("axes").at(0).at("lag_ms").at("source"), "measured");
  EXPECT_EQ(json.at("axes").at(1).at("lag_ms").at("source"), "assumed");
  EXPECT_EQ(json.at("axes").at(2).at("stands"), false);
  EXPECT_EQ(json.at("smallest_force_source"), "assumed");
  const std::vector<report::SummaryRow> rows = Rows(result);
  EXPECT_TRUE(std::ranges::any_of(rows, [](const report::SummaryRow& row) {
    return row.key == "Rendered along z" && row.value.find("lag 65.1 ms (measured)") != std::string::npos &&
           row.value.find("it does not stand") != std::string::npos;
  }));
}

// If no model fits the arm, the verdict comes from the arm's measured frequency response.
TEST(Rendering, AMeasuredResponseWithoutAModelIsJudgedToo) {
  config::CellConfig cell = CellNamed("demo");
  cell.identified.emplace();
  config::IdentifiedResponse& response = cell.identified->response.emplace_back();
  response.axis = "z";
  const ServoModel slow{.bandwidth_hz = 6.0, .damping_ratio = 1.0, .dead_time_s = 12e-3};
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic);
    const std::complex<double> value = SampledResponse(slow, cell.servo.period_s, hz);
    response.lines.push_back({.hz = hz, .re = value.real(), .im = value.imag(), .sd = 1e-4});
  }
  const Rendering rendering = RenderingOf(cell);
  EXPECT_TRUE(rendering.axes[2].loop_measured);
  EXPECT_FALSE(rendering.axes[2].stands);
  EXPECT_FALSE(rendering.axes[2].greatest_wall_N_per_m) << "a model would be needed for it";
  EXPECT_FALSE(rendering.axes[0].loop_measured);
  session::Verdict verdict;
  JudgeRendering(rendering, verdict);
  ASSERT_EQ(verdict.reasons.size(), 1u);
  EXPECT_TRUE(verdict.reasons[0].starts_with("along z"));
}

TEST(Rendering, UnderTheImpedanceLawGivesNoLeastDrag) {
  const Rendering rendering = RenderingOf(CellNamed("thin_plate_impedance"));
  EXPECT_FALSE(rendering.admittance);
  for (const RenderedAxis& axis : rendering.axes) {
    EXPECT_FALSE(axis.least_drag_Ns_per_m);
    EXPECT_NEAR(axis.lag_s.value, 3e-3, 1e-9) << "the force's dead time";
  }
  EXPECT_NEAR(rendering.axes[0].felt_mass_kg->value, 0.33, 0.01) << "as docs/identify.md finds it";
}

}  // namespace
}  // namespace osteon::studies
