#include <cmath>
#include <complex>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/loops/admittance_loop.h"
#include "session/setup/cell_setup.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify_estimate.h"
#include "studies/tune/overlay_measured.h"
#include "studies/tune/tune_measured.h"
#include "tests/temporary_path.h"

// Stability margins of a cell's gains computed from measured responses of simulated cells, whose true limits
// are known: the loop of a hand from a held run, and an arm under the impedance law.

namespace osteon::studies {
namespace {

session::CellSetup CellNamed(const std::string& name) {
  auto setup = session::PrepareCell(
      std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells" / (name + ".yaml"), std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

// Runs an excitation and adds its estimates to the result.
void AddRunTo(const session::CellSetup& setup, const ExcitationRequest& request, IdentifyResult& result) {
  const std::filesystem::path file = TemporaryPath(request.held ? "gains_held.mcap" : "gains_free.mcap");
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  ASSERT_TRUE(run) << run.error();
  const auto added = AddRecording(file, setup.config, result);
  ASSERT_TRUE(added) << added.error();
}

// The smallest virtual mass, in free air, with which the loop by the hand's measured response is stable.
double LeastMass_kg(const TuneTask& task) {
  double low = 0.1, high = 2.0;
  while (high > 1.002 * low) {
    const double middle = std::sqrt(low * high);
    const bool stands = MeasuredMargins(task, "own", {middle, 5.0}, {}).front().margins.stable;
    (stands ? high : low) = middle;
  }
  return high;
}

// A hand's measured loop is compared with the loop of the cell's own parameters: a hand of 2000 N/m, 60 N s/m
// and 1.5 kg behind a grip, and the tool's mass, which the sensor feels too.
TEST(MeasuredGains, AHandsLoopIsJudgedByItsMeasuredResponse) {
  const session::CellSetup setup = CellNamed("demo");
  ExcitationRequest request{.axis = 'z', .peak_speed_m_per_s = 0.05, .seed = 1, .draws = 2, .periods = 2};
  IdentifyResult result = EmptyResult("demo", setup.config);
  AddRunTo(setup, request, result);
  request.held = true;
  AddRunTo(setup, request, result);
  ASSERT_EQ(result.axes.size(), 2u);
  UseFreeRuns(result);
  config::CellConfig cell = setup.config;
  cell.identified = ToIdentified(result);
  TuneTask task = MeasuredTaskOf(cell);
  ASSERT_EQ(task.held.size(), 1u);

  // the same loop, computed from the cell's own parameters
  const hil::OperatorHandParams& hand = setup.config.simulated.hand;
  const double delay_s = *cell.identified->sensor->delay_s;
  const ResponseModel arm{.arm = setup.config.simulated.servo, .period_s = task.loop.period_s};
  std::vector<PlantLine> exact_lines;
  for (const MeasuredPlant::Point& at : task.held[0].response->grid()) {
    if (at.hz < 0.6 || at.hz > 30.0) continue;
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * at.hz);
    const hil::GridHand& fitted = task.held[0].hand;
    const std::complex<double> fitted_impedance =
        fitted.stiffness_N_per_m + s * fitted.damping_Ns_per_m + s * s * fitted.mass_kg;
    const std::complex<double> truth = hand.stiffness_N_per_m + s * hand.damping_Ns_per_m +
                                       s * s * hand.mass_kg / (1.0 + s * (hand.grip_time_s + 0.5e-3)) +
                                       s * s * result.tool_mass_kg;
    const std::complex<double> expected =
        ModelResponse(arm, at.hz) * std::exp(-s * delay_s) * truth / fitted_impedance;
    // 8 %: the measured response is smoothed over a third of an octave, in which its phase changes; 7.5 % was
    // measured
    EXPECT_LT(std::abs(at.value - expected), 0.08 * std::abs(expected)) << at.hz << " Hz";
    exact_lines.push_back({.hz = at.hz, .value = expected, .sd = 1e-3 * std::abs(expected)});
  }

  const std::vector<TuneMargin> margins = MeasuredMargins(task, "own", {1.7, 30.0}, {});
  ASSERT_EQ(margins.size(), 3u) << "free, wall, planes";
  EXPECT_NE(margins[0].hand.name.find("its own loop as measured"), std::string::npos);
  EXPECT_TRUE(margins[0].margins.stable);
  EXPECT_FALSE(MeasuredMargins(task, "own", {0.3, 1.0}, {})[0].margins.stable);

  // both loops need the same least virtual mass in free air
  TuneTask exact = task;
  exact.held[0].response = std::make_shared<MeasuredPlant>(exact_lines, arm);
  EXPECT_NEAR(LeastMass_kg(task), LeastMass_kg(exact), 0.05 * LeastMass_kg(exact));
  EXPECT_GT(LeastMass_kg(exact), 0.3);
}

// The stiffest wall with which `stable` holds for the loop.
double GreatestWall_N_per_m(OverlayLoopParams loop, const auto& stable) {
  return hil::FirstCrossing(
             [&](double stiffness) {
               loop.wall.stiffness_N_per_m = stiffness;
               return stable(loop);
             },
             {.from = 500.0, .to = 200e3, .factor = 1.2, .tolerance = 2e-3})
      .value;
}

// The file's arm has wrong springs and damping. By the measured response, the stiffest wall must nevertheless
// be that of the true arm.
TEST(MeasuredGains, WallsUnderTheImpedanceLawAreThoseOfTheMeasuredArm) {
  session::CellSetup setup = CellNamed("thin_plate_impedance");
  setup.config.simulated.dynamic.friction_compensation = 1.0;
  setup.config.simulated.dynamic.mount.reset();
  IdentifyResult result = EmptyResult("thin_plate_impedance", setup.config);
  AddRunTo(setup,
           {.axis = 'z', .peak_speed_m_per_s = 0.05, .seed = 1, .draws = 2, .periods = 2, .overlay = true},
           result);
  ASSERT_EQ(result.axes.size(), 1u);
  const config::IdentifiedCell identified = ToIdentified(result);
  ASSERT_TRUE(identified.response.at(0).spring_N_per_m);

  OverlayLoopParams truth{.chain = setup.config.robot.lbr()->chain,
                          .arm = setup.config.simulated.dynamic,
                          .X_FT = setup.config.tool.X_FT,
                          .q = setup.config.start.q,
                          .law = setup.config.servo.impedance};
  truth.gravity_B = setup.config.X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2;
  truth.law.damping_Ns_per_m.setConstant(100.0);
  OverlayLoopParams by_file = truth;
  by_file.arm.cartesian_damping_ratio *= 2.0;
  by_file.arm.stiffness_N_per_m *= 1.5;
  const auto by_matrix = [](const OverlayLoopParams& p) { return OverlayLoop(p).IsStable(); };
  const double wall = GreatestWall_N_per_m(truth, by_matrix);
  EXPECT_GT(GreatestWall_N_per_m(by_file, by_matrix), 1.15 * wall);
  const std::vector<MeasuredAxis> axes = MeasuredAxesOf(identified, by_file);
  ASSERT_EQ(axes.size(), 1u);
  EXPECT_NEAR(GreatestWall_N_per_m(
                  by_file, [&](const OverlayLoopParams& p) { return IsStableAsMeasured(axes, p, 0.0); }),
              wall, 0.05 * wall);
}

}  // namespace
}  // namespace osteon::studies
