#include "hil/rsi/rsi_controller.h"

#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/kinematics/kr_arms.h"

// Tests the simulated KR controller: IPOC, corrections, missing and late answers, and its monitors.

namespace osteon::hil {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

RsiControllerParams Params() {
  RsiControllerParams params;
  params.arm = kinematics::Kr6R900Params();
  params.first_ipoc = 1000;
  params.axis_speed_ratio = std::numeric_limits<double>::infinity();  // no speed limit, because corrections
                                                                      // in these tests are steps
  return params;
}

// Sends the answer to the message with this IPOC. The corrections are in degrees for the axes A1 … A6, or, if
// `cartesian`, in mm and degrees for X, Y, Z, A, B, C. Returns whether the controller accepts the answer.
bool Send(RsiController& controller, std::uint64_t ipoc, const Six& c, bool cartesian = false) {
  const std::string text =
      cartesian ? fmt::format(R"(<Sen Type="ImFree"><RKorr X="{}" Y="{}" Z="{}" A="{}" B="{}" C="{}"/>)"
                              R"(<IPOC>{}</IPOC></Sen>)",
                              c[0], c[1], c[2], c[3], c[4], c[5], ipoc)
                : fmt::format(R"(<Sen Type="ImFree"><AK A1="{}" A2="{}" A3="{}" A4="{}" A5="{}" A6="{}"/>)"
                              R"(<IPOC>{}</IPOC></Sen>)",
                              c[0], c[1], c[2], c[3], c[4], c[5], ipoc);
  return controller.Receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// Runs one cycle with an answer that is in time.
void Cycle(RsiController& controller, const Six& correction, bool cartesian = false) {
  ASSERT_FALSE(controller.Step().empty());
  ASSERT_TRUE(Send(controller, controller.state().ipoc, correction, cartesian)) << controller.last_error();
}

// Runs one cycle and returns its message as text.
std::string NextMessage(RsiController& controller) {
  const auto bytes = controller.Step();
  return {bytes.begin(), bytes.end()};
}

TEST(RsiController, IpocRisesByTheConfiguredStep) {
  for (const int step : {1, 4, 12}) {
    RsiControllerParams params = Params();
    params.ipoc_step = step;
    RsiController controller(params);
    for (int k = 0; k < 3; ++k)
      EXPECT_NE(NextMessage(controller).find(fmt::format("<IPOC>{}</IPOC>", 1000 + k * step)),
                std::string::npos);
  }
}

TEST(RsiController, AbsoluteCorrectionsAreOffsetsFromTheStart) {
  RsiController controller(Params());
  for (int k = 0; k < 100; ++k) Cycle(controller, {10, 0, 0, 0, 0, -2});
  controller.Step();
  EXPECT_NEAR(controller.state().axes_set_deg[0], 10.0, 1e-9);
  EXPECT_NEAR(controller.state().axes_measured_deg[0], 10.0, 0.01) << "400 ms later the servo is there";
  EXPECT_NEAR(controller.state().axes_measured_deg[5], -2.0, 0.01);
}

TEST(RsiController, RelativeCorrectionsAddUp) {
  RsiControllerParams params = Params();
  params.absolute = false;
  RsiController controller(params);
  for (int k = 0; k < 100; ++k) Cycle(controller, {0.1, 0, 0, 0, 0, 0});
  controller.Step();
  EXPECT_NEAR(controller.state().axes_set_deg[0], 10.0, 1e-9);
}

// One cycle gets no answer. HOLDON decides whether the last correction is held or dropped (table in
// io/rsi/README.md).
TEST(RsiController, HoldOnDecidesWhatAMissingAnswerDoes) {
  struct Row {
    bool absolute, hold_on;
    double after_deg;  // position of A1 [deg] after answers with 2 and 3 deg and one cycle without an answer
  };
  for (const Row& row :
       {Row{true, true, 3.0}, Row{true, false, 0.0}, Row{false, true, 8.0}, Row{false, false, 5.0}}) {
    RsiControllerParams params = Params();
    params.absolute = row.absolute;
    params.hold_on = row.hold_on;
    RsiController controller(params);
    Cycle(controller, {2, 0, 0, 0, 0, 0});
    Cycle(controller, {3, 0, 0, 0, 0, 0});
    controller.Step();
    EXPECT_EQ(controller.state().delay, 0u);
    controller.Step();  // this cycle got no answer
    EXPECT_NEAR(controller.state().axes_set_deg[0], row.after_deg, 1e-9) << row.absolute << row.hold_on;
    EXPECT_EQ(controller.state().delay, 1u);
    EXPECT_EQ(controller.state().counters.missed, 1u);
  }
}

// Without HOLDON, a missing answer sets the absolute correction of 20 deg to zero at once. The axis then
// returns at its highest speed, 360 deg/s.
TEST(RsiController, WithHoldOnZeroAMissingAnswerSendsTheArmBackToItsStart) {
  RsiControllerParams params = Params();
  params.hold_on = false;
  RsiController controller(params);
  for (int k = 0; k < 200; ++k) Cycle(controller, {20, 0, 0, 0, 0, 0});
  controller.Step();
  ASSERT_NEAR(controller.state().axes_measured_deg[0], 20.0, 0.01);
  controller.Step();
  EXPECT_NEAR(controller.state().axes_set_deg[0], 0.0, 1e-9) << "20 deg in one cycle";
  double before = controller.state().axes_measured_deg[0];
  for (int k = 0; k < 90; ++k) {
    controller.Step();
    const double at = controller.state().axes_measured_deg[0];
    EXPECT_LE(std::abs(at - before), 360.0 * 0.004 + 1e-9) << "no faster than the axis can";
    before = at;
  }
  EXPECT_LT(before, 1.0) << "and there it goes";
}

TEST(RsiController, LateAnswersRaiseDelayUntilTimeoutEndsRsi) {
  RsiControllerParams params = Params();
  params.timeout_cycles = 3;
  RsiController controller(params);
  Cycle(controller, {1, 0, 0, 0, 0, 0});
  std::uint64_t late_ipoc = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    EXPECT_NE(NextMessage(controller).find(fmt::format("<Delay D=\"{}\"/>", k)), std::string::npos);
    if (k > 0) {
      EXPECT_FALSE(Send(controller, late_ipoc, {5, 0, 0, 0, 0, 0})) << "its cycle is over";
    }
    late_ipoc = controller.state().ipoc;
  }
  EXPECT_EQ(controller.state().counters.late, 2u);
  EXPECT_TRUE(controller.Step().empty());
  EXPECT_FALSE(controller.state().running);
  EXPECT_EQ(Describe(controller.state().stop), "timeout: 3 answers late, RSI ends at 3");
  EXPECT_TRUE(controller.Step().empty()) << "and stays silent";
}

// Every second answer is missing. If Delay counts all missing answers, they end RSI at 4. If it counts only
// those in a row, they never end RSI.
TEST(RsiController, DelayCountsAllMissingAnswersOrOnlyThoseInARow) {
  for (const bool in_a_row : {false, true}) {
    RsiControllerParams params = Params();
    params.timeout_cycles = 4;
    params.delay_in_a_row = in_a_row;
    RsiController controller(params);
    for (int k = 0; k < 20 && controller.state().running; ++k) {
      controller.Step();
      if (k % 2 != 0) Send(controller, controller.state().ipoc, {});
    }
    EXPECT_EQ(controller.state().running, in_a_row);
    if (in_a_row) {
      EXPECT_LE(controller.state().delay, 1u);
    }
  }
}

TEST(RsiController, CountsAnswersThatBelongToNoCycle) {
  RsiController controller(Params());
  EXPECT_FALSE(Send(controller, 1000, {})) << "it has not spoken yet";
  controller.Step();
  EXPECT_FALSE(Send(controller, 2000, {}));
  EXPECT_TRUE(Send(controller, 1000, {}));
  EXPECT_FALSE(Send(controller, 1000, {1, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(controller.Receive({}));
  controller.Step();
  const RsiCounters& n = controller.state().counters;
  EXPECT_EQ(n.wrong_ipoc, 2u);
  EXPECT_EQ(n.duplicate, 1u);
  EXPECT_EQ(n.malformed, 1u);
  EXPECT_EQ(n.answered, 1u);
  EXPECT_NEAR(controller.state().axes_set_deg[0], 0.0, 1e-9) << "the first answer counts";
}

TEST(RsiController, CorrectionsOutOfRangeEndRsi) {
  struct Case {
    Six correction;
    bool cartesian;
    const char* stop;
  };
  for (const Case& c : {
           Case{{0, 0, 0, 0, 0, 90.5}, false, "correction range: number 6 corrected by 90.5, accepted 90"},
           Case{{0, 0, 70, 0, 0, 0}, false, "axis limit: A3 set to 160 deg, accepted at most 156"},
           Case{{0, 0, 0, 0, 31, 0}, false, "axis limit: A5 set to 121 deg, accepted at most 120"},
           Case{{0, 0, 600, 0, 0, 0}, true, "out of reach: no posture for the corrected pose"},
       }) {
    RsiControllerParams params = Params();
    params.cartesian = c.cartesian;
    if (c.cartesian) params.range = {1000, 1000, 1000, 90, 90, 90};
    RsiController controller(params);
    Cycle(controller, c.correction, c.cartesian);
    EXPECT_TRUE(controller.Step().empty());
    EXPECT_EQ(Describe(controller.state().stop), c.stop);
    EXPECT_NEAR(controller.state().axes_set_deg[2], 90.0, 1e-9) << "the set point stays";
  }
}

// A set point that is 28.64 deg away within a cycle of 4 ms would need 7160 deg/s. The controller must stop
// with its message KSS01102.
TEST(RsiController, ASetPointFasterThanItsAxisEndsRsiAndIsNotFollowed) {
  RsiControllerParams params = Params();
  params.axis_speed_ratio = 1.0;
  RsiController controller(params);
  Cycle(controller, {0, 0, 0, 0, 28.64, 0});
  EXPECT_TRUE(controller.Step().empty());
  EXPECT_FALSE(controller.state().running);
  EXPECT_EQ(controller.state().stop.reason, RsiStopReason::kAxisSpeed);
  EXPECT_EQ(Describe(controller.state().stop),
            "axis speed: A5 told to move at 7160 deg/s, accepted 450 (KSS01102)");
  EXPECT_NEAR(controller.state().axes_set_deg[4], 90.0, 1e-9) << "the set point stays";
  RsiController slower(
      params);  // this motion needs 447.5 deg/s for some cycles; the axis's own limit is 450 deg/s
  for (int k = 1; k <= 15; ++k) Cycle(slower, {0, 0, 0, 0, -1.79 * k, 0});
  EXPECT_FALSE(slower.Step().empty()) << Describe(slower.state().stop);
}

// HOLDON is 0, the corrections are absolute, and the arm monitors the speed of its axes. A single missing
// answer then demands a jump of 10 deg back to the start, which the monitor must stop.
TEST(RsiController, WithHoldOnZeroAMissingAnswerExceedsTheAxisSpeed) {
  RsiControllerParams params = Params();
  params.axis_speed_ratio = 1.0;
  params.hold_on = false;
  RsiController controller(params);
  for (int k = 1; k <= 200; ++k) Cycle(controller, {0.05 * k, 0, 0, 0, 0, 0});
  EXPECT_FALSE(controller.Step().empty());
  EXPECT_TRUE(controller.Step().empty()) << "nobody answered";
  EXPECT_EQ(controller.state().stop.reason, RsiStopReason::kAxisSpeed);
  EXPECT_NEAR(controller.state().axes_set_deg[0], 10.0, 1e-9) << "10 deg in 4 ms are not followed";
}

TEST(RsiController, CartesianCorrectionMovesTheFlangeByItsValue) {
  for (const bool absolute : {true, false}) {
    RsiControllerParams params = Params();
    params.cartesian = true;
    params.absolute = absolute;
    params.range = {500, 500, 500, 90, 90, 90};
    RsiController controller(params);
    const kinematics::SerialChain<6> chain(kinematics::ChainFrom(params.arm));
    const auto flange = [&] {
      kinematics::JointVectorN<6> q;
      for (int i = 0; i < 6; ++i)
        q[i] = controller.state().axes_set_deg[static_cast<std::size_t>(i)] * kDegree;
      return chain.FlangePose(q);
    };
    const Pose before = flange();
    const int cycles = absolute ? 1 : 10;
    const double share = 1.0 / cycles;
    for (int k = 0; k < cycles; ++k)
      Cycle(controller, {30 * share, -40 * share, 50 * share, 0, 0, 12 * share}, true);
    controller.Step();
    const Pose after = flange();
    EXPECT_LT((after.translation() - before.translation() - Vector3(0.03, -0.04, 0.05)).norm(), 1e-9);
    const Vector3 turn = LogRotation(after.linear() * before.linear().transpose());
    EXPECT_LT((turn - Vector3(12 * kDegree, 0, 0)).norm(), 1e-9) << "about the base's x";
  }
}

TEST(RsiController, SameInputGivesTheSameBytes) {
  RsiController a(Params()), b(Params());
  for (int k = 0; k < 200; ++k) {
    const auto m = a.Step(), n = b.Step();
    ASSERT_TRUE(std::equal(m.begin(), m.end(), n.begin(), n.end()));
    if (k % 7 == 0) continue;
    const Six correction{0.01 * k, 0, -0.02 * k, 0, 0, 0};
    Send(a, a.state().ipoc, correction);
    Send(b, b.state().ipoc, correction);
  }
}

TEST(RsiController, RefusesParametersOutOfRangeAndNamesThem) {
  const auto refused = [](auto change) -> std::string {
    RsiControllerParams params = Params();
    change(params);
    try {
      RsiController controller(params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refused([](auto& p) { p.cycle_ms = 8; }).find("cycle_ms: found 8"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.start_deg[1] = 46; }).find("start_deg of A2: found 46"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.range[0] = 0; }).find("range 1"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.timeout_cycles = 0; }).find("timeout_cycles"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.axis_speed_ratio = 0; }).find("axis_speed_ratio"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.ipoc_step = 0; }).find("ipoc_step"), std::string::npos);
}

}  // namespace
}  // namespace osteon::hil
