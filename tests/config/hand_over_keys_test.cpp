#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "control/coupling/virtual_coupling.h"
#include "tests/config/cell_text.h"

// Tests that two values of a cell fit each other: max_slide, the largest step of the proxy within one frame,
// must not raise the force so fast that the trip on the wrench's rate stops the cell.

namespace osteon::config {
namespace {

using ::testing::HasSubstr;

TEST(HandOverKeys, AMaxSlideTooLongForTheHandOverIsRefusedAtItsLine) {
  const std::string text = CellText("sawbone_block");
  EXPECT_EQ(Refusal(With(text, "max_slide_um: 400", "max_slide_um: 1439")), "");
  const std::string refusal = Refusal(With(text, "max_slide_um: 400", "max_slide_um: 1441"));
  EXPECT_THAT(refusal, HasSubstr(": max_slide_um: found 1441, accepted at most 1440: "));
  EXPECT_THAT(refusal, HasSubstr("1.5 max_tool_speed_mm_per_s (150) × 8 ms / (1 + damping_share_ratio)"));
  EXPECT_THAT(Refusal(With(With(text, "max_tool_speed_mm_per_s: 150", "max_tool_speed_mm_per_s: 40"),
                           "model_sight_mm: 0.25", "model_sight_mm: 0.15")),
              HasSubstr("max_slide_um: found 400, accepted at most 384"))
      << "the other figure of the two";
}

/// Largest change of the force within a tick, as a ratio to the trip's limit. The tool presses with the
/// cell's largest force, and a frame moves the proxy sideways by max_slide.
/// @param hands_over  true: the hand-over spreads the proxy's step over several ticks, as in the loop; false:
/// the whole step acts in one tick
double MaxForceStepRatio(const CellConfig& cell, bool hands_over) {
  const control::ServoParams& servo = cell.servo;
  control::CouplingParams coupling = servo.coupling;
  if (!hands_over) coupling.turn_m_per_s = 10.0;  // the whole step in one tick
  const double K = coupling.max_stiffness_N_per_m, depth_m = servo.wrench.max_force_N / K;
  const double lean_rad = std::asin(std::min(0.9, cell.cutting.max_slide_m / depth_m));
  safety::WrenchRateTrip trip(K, servo.twist.max_speed_m_per_s);
  control::CouplingState state;
  state.fade = 1.0;
  simulation::ContactModel model;
  model.contact_count = 1;
  model.contacts[0].stiffness_N_per_m = K;
  model.contacts[0].n_W = Vector3(Vector3::UnitZ());
  model.frame = 1;
  Pose X_WT = Pose::Identity();
  X_WT.translation().z() = -depth_m;
  const Twist V_WT{.v = Vector3(0.0, 0.0, -servo.twist.max_speed_m_per_s), .w = Vector3::Zero()};
  double worst = 0.0;
  const auto period = static_cast<rt::Nanoseconds>(servo.period_s * 1e9);
  for (int tick = 0; tick < 60; ++tick) {
    const rt::Nanoseconds now = rt::kSecond + tick * period;
    // a new frame: at tick 10 the contact's normal leans to one side, at tick 30 it leans back
    if (tick % 20 == 10) {
      const double lean = tick < 20 ? lean_rad : 0.0;
      model.contacts[0].n_W = Vector3(std::sin(lean), 0.0, std::cos(lean));
      ++model.frame;
    }
    model.pose_stamp = now - period;
    const control::CouplingOutput out = control::EvaluateCoupling(
        coupling, {.model = model, .X_WT = X_WT, .V_WT = V_WT, .now = now, .spindle_turns = true}, state);
    static_cast<void>(trip.Check(out.F_T_W.f, servo.period_s));
    if (tick > 5) worst = std::max(worst, trip.growth_N() / (trip.max_rate_N_per_s() * servo.period_s));
  }
  return worst;
}

// No shipped cell may trip. Without the hand-over at least 4 of them would, which shows that they need it.
TEST(HandOverKeys, NoShippedCellTripsByItsOwnLargestSlide) {
  int trips_without_hand_over = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OSTEON_SOURCE_DIR "/config/cells")) {
    SCOPED_TRACE(entry.path().filename());
    const CellConfig cell = LoadCell(entry.path());
    EXPECT_LT(MaxForceStepRatio(cell, true), 1.0);
    trips_without_hand_over += MaxForceStepRatio(cell, false) > 1.0 ? 1 : 0;
  }
  EXPECT_GE(trips_without_hand_over, 4) << "24 N against 13.5 and 18, 10 against 6";
}

}  // namespace
}  // namespace osteon::config
