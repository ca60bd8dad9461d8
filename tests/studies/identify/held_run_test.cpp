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
#include "session/setup/cell_setup.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_margins.h"
#include "studies/identify/identify_page.h"
#include "studies/identify/identify_table.h"
#include "tests/temporary_path.h"

// Runs with a hand at the handle: estimates of the hand and of the mass that it moves, and the verdict on the
// cell's present gains.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;
using Complex = std::complex<double>;
constexpr double kTwoPi = 2.0 * std::numbers::pi, kPeriod_s = 1e-3;

session::CellSetup ShippedCell(const std::string& name) {
  auto setup =
      session::PrepareCell(fs::path(OSTEON_SOURCE_DIR) / "config/cells" / (name + ".yaml"), std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

// Runs an excitation of two draws with two periods each, and adds its estimates to the result.
void AddRun(const session::CellSetup& setup, char axis, bool held, IdentifyResult& result) {
  const ExcitationRequest request{
      .axis = axis, .peak_speed_m_per_s = 0.05, .seed = 1, .draws = 2, .periods = 2, .held = held};
  const fs::path file = TemporaryPath(held ? "held.mcap" : "free.mcap");
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  ASSERT_TRUE(run) << run.error();
  const auto added = AddRecording(file, setup.config, result);
  ASSERT_TRUE(added) << added.error();
}

// Uses the free runs to evaluate the held runs, judges every axis and fills in the felt masses.
void JudgeAll(IdentifyResult& result) {
  UseFreeRuns(result);
  for (AxisResult& axis : result.axes) JudgeAxis(axis, result);
  FillFeltMasses(result);
}

// The exact result of an arm of 15 Hz along an axis, free or held by a hand of 2000 N/m.
AxisResult ArmAxis(bool held) {
  AxisResult axis{.request = {.peak_speed_m_per_s = 0.05, .held = held},
                  .recording = {.file = "z.mcap", .hash = "0000000000000000"},
                  .rms_speed_m_per_s = 0.02,
                  .by_encoders = {},
                  .fit = {}};
  const ServoModel model{.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_time_s = 4e-3};
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic);
    axis.by_encoders.lines.push_back(
        {.hz = hz, .value = SampledResponse(model, kPeriod_s, hz), .noise_sd = 1e-4, .sd = 1e-4});
  }
  axis.by_encoders.draws = 4;
  axis.by_encoders.periods = 12;
  axis.fit = *FitServo(axis.by_encoders.lines, kPeriod_s);
  axis.fit.chi2 = 1.0;
  axis.tool = ToolForceFit{.mass_kg = {1.2, 0.002}, .delay_s = {1.7e-3, 0.03e-3}, .resonance = {}, .chi2 = 1};
  axis.samples.messages = 64000;
  if (held) axis.hand = HandFit{.stiffness_N_per_m = {2000.0, 20.0}, .chi2 = 1.0};
  return axis;
}

IdentifyResult ResultOf(std::vector<AxisResult> axes) {
  return {.cell = "demo",
          .valid_for = {.robot = "lbr", .tool = "reamer", .period_s = kPeriod_s},
          .tool_mass_kg = 1.2,
          .axes = std::move(axes)};
}

// Response from position to sensor force of a hand behind the tool: 2000 N/m, 60 N s/m, and 1.5 kg that
// follows through a grip with this time constant (5 ms, or 0).
std::vector<ResponseLine> HandLines(double grip_time_s, double sd) {
  std::vector<ResponseLine> lines;
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic), w = kTwoPi * hz;
    const Complex hand = Complex(2000.0, 60.0 * w) - w * w * 1.5 / Complex(1.0, w * grip_time_s);
    lines.push_back(
        {.hz = hz, .value = (1.2 * w * w - hand) * std::polar(1.0, -w * 0.5e-3), .noise_sd = sd, .sd = sd});
  }
  return lines;
}

// Expects the truth within the estimate's interval.
void ExpectInside(const Estimate& estimate, double truth, const std::string& what) {
  EXPECT_NEAR(estimate.value, truth, estimate.half_width) << what;
}

TEST(Hand, IsEstimatedWithItsGripsTimeConstant) {
  const auto fit = FitHand(HandLines(5e-3, 1.0), 1.2, {.delay_s = 0.5e-3});
  ASSERT_TRUE(fit) << fit.error();
  ExpectInside(fit->stiffness_N_per_m, 2000.0, "stiffness");
  ExpectInside(fit->damping_Ns_per_m, 60.0, "damping");
  ExpectInside(fit->mass_kg, 1.5, "mass");
  ExpectInside(fit->grip_time_s, 5e-3, "grip");
  EXPECT_NEAR(fit->damping_Ns_per_m.value, 60.0, 1.0);
  EXPECT_LT(fit->chi2, 1.0);
  // a hand that follows at once has a time constant of 0
  const auto stiff = FitHand(HandLines(0.0, 1.0), 1.2, {.delay_s = 0.5e-3});
  ASSERT_TRUE(stiff) << stiff.error();
  EXPECT_EQ(stiff->grip_time_s.value, 0.0);
  EXPECT_NEAR(stiff->damping_Ns_per_m.value, 60.0, 0.1);
}

TEST(Hand, ThatFitsNoSpringDamperAndMassIsWarnedAbout) {
  AxisResult axis = ArmAxis(true);
  axis.hand->chi2 = 14.0;
  axis.hand->residual = 0.03;
  IdentifyResult result = ResultOf({axis});
  JudgeAxis(result.axes[0], result);
  EXPECT_TRUE(result.refused.empty());
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].what.find("found chi² 14.0, 3.0 % off"), std::string::npos)
      << result.warnings[0].what;
}

// An arm of 5 kg and 15 Hz has a stiffness of 47 kN/m. A hand of 2 kN/m lowers the arm's gain to 0.96. In a
// free run, that would mean a sticking joint.
TEST(HeldRun, IsNotRefusedForGainOrDamping) {
  AxisResult axis = ArmAxis(true);
  axis.by_encoders.lines.front().value = 0.96;
  axis.fit.damping_ratio.value = 3.5;
  axis.fit.chi2 = 20.0;
  IdentifyResult result = ResultOf({axis});
  JudgeAxis(result.axes[0], result);
  EXPECT_TRUE(result.refused.empty()) << result.refused.front().what;
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front().what;
  result.axes[0].request.held = false;
  JudgeAxis(result.axes[0], result);
  EXPECT_FALSE(result.refused.empty()) << "in a free run the joint sticks";
}

TEST(HeldRun, GivesTheMassThatTheHandMovesOnADynamicArm) {
  session::CellSetup setup = ShippedCell("demo");
  setup.config.simulated.level = hil::ArmLevel::kDynamic;
  setup.config.simulated.dynamic.mount.reset();
  IdentifyResult result = EmptyResult("demo", setup.config);
  AddRun(setup, 'z', false, result);
  AddRun(setup, 'z', true, result);
  ASSERT_EQ(result.axes.size(), 2u);
  JudgeAll(result);
  EXPECT_TRUE(result.refused.empty()) << result.refused.front().what;
  const auto mobility = config::ToolMobility(setup.config);
  ASSERT_TRUE(mobility);
  const Vector3 axis_W = setup.config.start.X_WT.linear().col(2);
  const double truth_kg = 1.0 / axis_W.dot(*mobility * axis_W);
  ASSERT_TRUE(result.axes[1].felt_mass_kg);
  EXPECT_NEAR(result.axes[1].felt_mass_kg->value, truth_kg, 0.05 * truth_kg);
  ExpectInside(*result.axes[1].felt_mass_kg, truth_kg, "felt mass");
}

// The true values are in the cells' files. Each estimate's interval must contain its true value. The cells
// that are not listed have the same arm, tool and hand in free air as a listed cell.
TEST(HeldRun, FindsTheHandsOfTheShippedCells) {
  for (const char* name :
       {"demo", "femoral_canal", "kr_16_thin_plate", "long_drill", "molar", "sawbone_block", "thin_plate"}) {
    SCOPED_TRACE(name);
    const session::CellSetup setup = ShippedCell(name);
    IdentifyResult result = EmptyResult(name, setup.config);
    AddRun(setup, 'z', false, result);
    AddRun(setup, 'z', true, result);
    ASSERT_EQ(result.axes.size(), 2u) << (result.refused.empty() ? "" : result.refused.front().what);
    JudgeAll(result);
    EXPECT_TRUE(result.refused.empty()) << result.refused.front().what;
    ASSERT_TRUE(result.axes[1].hand);
    const HandFit& hand = *result.axes[1].hand;
    const hil::OperatorHandParams& truth = setup.config.simulated.hand;
    ExpectInside(hand.stiffness_N_per_m, truth.stiffness_N_per_m, "stiffness");
    ExpectInside(hand.damping_Ns_per_m, truth.damping_Ns_per_m, "damping");
    ExpectInside(hand.mass_kg, truth.mass_kg, "mass");
    // thin_plate's arm is on a mount whose motion the encoders don't measure, so its intervals are wide
    if (std::string(name) != "thin_plate") {
      // the simulated mass is integrated by backward Euler, which delays it by half a period
      EXPECT_NEAR(hand.grip_time_s.value, truth.grip_time_s + 0.5 * setup.config.servo.period_s,
                  0.2 * truth.grip_time_s);
      EXPECT_LT(hand.damping_Ns_per_m.half_width, 0.1 * truth.damping_Ns_per_m) << "and these say something";
      EXPECT_LT(hand.mass_kg.half_width, 0.1 * truth.mass_kg);
    }
    EXPECT_EQ(result.axes[1].hand_windows.size(), 4u);
    for (const HandWindow& window : result.axes[1].hand_windows)
      EXPECT_NEAR(window.stiffness_N_per_m.value, truth.stiffness_N_per_m, 0.2 * truth.stiffness_N_per_m);
  }
}

// --- stability limits predicted from an identified arm, for three further arms ---

struct TableArm {
  const char* name;
  hil::ServoArmParams arm;
  double period_s;
};

class IdentifyTableArms : public testing::TestWithParam<TableArm> {};

TEST_P(IdentifyTableArms, PredictsTheStabilityLimitsOfTheTrueArm) {
  const TableArm& one = GetParam();
  const TableRow row =
      IdentifyRow({.name = one.name}, {.arm = one.arm, .period_s = one.period_s, .seeds = 2});
  EXPECT_EQ(row.failed, 0);
  EXPECT_NEAR(row.hz.mean, one.arm.bandwidth_hz, 0.005 * one.arm.bandwidth_hz);
  EXPECT_NEAR(row.damping_ratio.mean, one.arm.damping_ratio, 0.005);
  EXPECT_NEAR(row.dead_time_ms.mean, 1e3 * one.arm.dead_cycles * one.period_s, 0.05);
  EXPECT_NEAR(row.lag_ms.mean, row.lag_ms.truth, 0.05);
  EXPECT_NEAR(row.greatest_wall_N_per_m.mean, row.greatest_wall_N_per_m.truth,
              0.05 * row.greatest_wall_N_per_m.truth);
  if (std::isfinite(row.least_drag_Ns_per_m.truth))
    EXPECT_NEAR(row.least_drag_Ns_per_m.mean, row.least_drag_Ns_per_m.truth,
                0.05 * row.least_drag_Ns_per_m.truth);
  else
    EXPECT_FALSE(std::isfinite(row.least_drag_Ns_per_m.mean)) << "no drag is enough, for neither";
}

INSTANTIATE_TEST_SUITE_P(
    Design, IdentifyTableArms,
    testing::Values(TableArm{"slow", {.bandwidth_hz = 8.0, .damping_ratio = 0.7, .dead_cycles = 9.4}, 1e-3},
                    TableArm{"fast", {.bandwidth_hz = 25.0, .damping_ratio = 0.6, .dead_cycles = 3.3}, 1e-3},
                    TableArm{"kr", {.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_cycles = 3.2}, 4e-3}),
    [](const auto& one) { return std::string(one.param.name); });

// --- forces at rest ---

TEST(IdentifiedForces, ANegligibleDriftNeedsNoDeadZone) {
  IdentifyResult result = ResultOf({});
  result.noise = ForceNoise{.white_N = 1e-9, .drift_N = 6e-15, .seconds = 60.0};
  EXPECT_FALSE(ToIdentified(result).dead_zone_N);
  const auto says = [&](const std::string& text) {
    for (const report::SummaryRow& row : Rows(result))
      if (row.value.find(text) != std::string::npos) return true;
    return false;
  };
  EXPECT_TRUE(says("the drift asks for no dead zone (below 0.005 N)"));
  result.noise->drift_N = 0.07;
  EXPECT_DOUBLE_EQ(ToIdentified(result).dead_zone_N.value(), 0.21);
  EXPECT_TRUE(says("a dead zone of 0.21 N"));
}

TEST(IdentifiedForces, NameTheRecordingsThatTheyComeFrom) {
  session::CellSetup setup = ShippedCell("demo");
  ExcitationRequest rest{.axis = 'z', .rest_s = 11.0};
  const fs::path file = TemporaryPath("noise.mcap");
  ASSERT_TRUE(RunExcited(setup, {.request = rest, .recording = file}));
  IdentifyResult result = EmptyResult("demo", setup.config);
  ASSERT_TRUE(AddRecording(file, setup.config, result));
  ASSERT_TRUE(result.noise);
  PassiveLag passive{.recording = {.file = "ordinary.mcap", .hash = "1111111111111111"}, .lag_s = {}};
  passive.peak_hand_N = 12.0;
  result.passive.push_back(passive);
  const auto recordings = ToIdentified(result).valid_for.recordings;
  ASSERT_EQ(recordings.size(), 2u);
  EXPECT_EQ(recordings[0].file, "noise.mcap");
  EXPECT_EQ(recordings[0].hash, HashOf(file));
  EXPECT_EQ(recordings[1].hash, "1111111111111111");

  // an ordinary run gives no estimate of the hand, and a warning states the reason
  JudgePassive(result);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].what.find("found a hand's force of 12 N with the law on, where force over "
                                         "motion is the robot's impedance"),
            std::string::npos)
      << result.warnings[0].what;
}

// --- the cell's present gains ---

TEST(PresentGains, AreJudgedByTheMeasuredResponse) {
  config::CellConfig cell = ShippedCell("demo").config;
  const auto judged = [&](double damping_Ns_per_m) {
    cell.servo.admittance.damping_Ns_per_m = Vector3::Constant(damping_Ns_per_m);
    IdentifyResult result = ResultOf({ArmAxis(false)});
    JudgeGains(cell, result);
    return result;
  };
  const IdentifyResult calm = judged(400.0), shaking = judged(1.0);
  ASSERT_FALSE(calm.margins.empty());
  EXPECT_TRUE(GainsStand(calm));
  EXPECT_EQ(Judge(calm).level, session::VerdictLevel::kGood);
  EXPECT_FALSE(GainsStand(shaking));
  EXPECT_EQ(Judge(shaking).level, session::VerdictLevel::kBad);
  EXPECT_NE(NextStep(shaking).find("run no cell with these gains"), std::string::npos);

  const auto json = nlohmann::json::parse(ToJson(shaking, "osteon identify demo"));
  EXPECT_EQ(json.at("margins").size(), shaking.margins.size());
  for (const char* key : {"hand", "contact", "stable", "gain", "phase_deg", "modulus", "robust"})
    EXPECT_TRUE(json.at("margins").at(0).contains(key)) << key;
  EXPECT_EQ(json.at("frf").size(), 27u);
  for (const char* key : {"axis", "speed_mm_per_s", "by", "hz", "re", "im", "sd", "coherence"})
    EXPECT_TRUE(json.at("frf").at(0).contains(key)) << key;

  const std::string page = IdentifyPage(shaking, "osteon identify demo");
  EXPECT_NE(page.find("Nyquist curves of the worst hands"), std::string::npos);
  EXPECT_EQ(page.find("nothing was written"), std::string::npos) << "the file is written all the same";

  IdentifyResult refused = ResultOf({ArmAxis(false)});
  refused.refused.push_back({"free run", "somebody holds the handle"});
  JudgeGains(cell, refused);
  EXPECT_TRUE(refused.margins.empty()) << "by bad data nothing is judged";
  cell.servo.law = control::Law::kImpedance;
  EXPECT_TRUE(judged(1.0).margins.empty());
}

TEST(PresentGains, NeedACoherentResponseAtTheLoopsCrossingFrequency) {
  const config::CellConfig cell = ShippedCell("demo").config;
  AxisResult axis = ArmAxis(false);
  axis.crossing_hz = CrossingOf(cell, axis);
  ASSERT_TRUE(axis.crossing_hz);
  EXPECT_GT(*axis.crossing_hz, 1.0);
  EXPECT_LT(*axis.crossing_hz, 30.0);
  const auto refusal = [&](double from_hz, double to_hz) {
    AxisResult noisy = axis;
    for (ResponseLine& line : noisy.by_encoders.lines)
      if (line.hz >= from_hz && line.hz <= to_hz) line.coherence = 0.4;
    IdentifyResult result = ResultOf({noisy});
    JudgeAxis(result.axes[0], result);
    return result.refused.empty() ? std::string() : result.refused[0].what;
  };
  const double crossing_hz = *axis.crossing_hz;
  EXPECT_NE(refusal(0.8 * crossing_hz, 1.25 * crossing_hz).find("where the loop's gain is 1"),
            std::string::npos);
  EXPECT_EQ(refusal(1.5 * crossing_hz, 60.0), "");
}

TEST(IdentifyPage, ShowsTheHandOverTimeAndTheNextStep) {
  AxisResult axis = ArmAxis(true);
  axis.hand_windows = {{0.0, {1900.0, 50.0}}, {4.0, {2100.0, 50.0}}};
  const IdentifyResult result = ResultOf({ArmAxis(false), axis});
  const std::string page = IdentifyPage(result, "osteon identify demo");
  EXPECT_NE(page.find("stiffness over time"), std::string::npos);
  EXPECT_NE(page.find("osteon tune CELL --identified identified.yaml"), std::string::npos);
  const auto json = nlohmann::json::parse(ToJson(result, ""));
  ASSERT_EQ(json.at("hands").size(), 1u);
  EXPECT_EQ(json.at("hands")[0].at("name"), "hand 1");
  EXPECT_EQ(json.at("hands")[0].at("windows")[1].at("stiffness_N_per_m"), 2100.0);
  EXPECT_EQ(ToIdentified(result).hands.at(0).name, "hand 1");
}

}  // namespace
}  // namespace osteon::studies
