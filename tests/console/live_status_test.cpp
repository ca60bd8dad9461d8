#include "console/stream/live_status.h"

#include <array>
#include <span>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "console/stream/live_json.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/motion_permit.h"

namespace osteon::console {
namespace {

LiveWindow Window(safety::CellState state) {
  LiveWindow w;
  w.number = 7;
  w.tick.cell_state = static_cast<std::uint8_t>(state);
  w.tick.F_coupling_T_W.f = {3.0, 0.0, 4.0};
  w.rendered_s = 6.25;
  w.paused_s = 2.0;
  w.frame.model.frame = 5;
  w.frame.model.X_WP.p = {0.0, 0.0, -0.004};
  w.frame.cup_depth_m = 0.005;
  return w;
}

const LiveContext kContext{.force_limit_N = 200.0,
                           .depth_m = [](const Pose& X_WP) { return -X_WP.translation().z(); }};

TEST(LiveStatus, SaysStateForceAndDepth) {
  const LiveStatus s = StatusOf(Window(safety::CellState::kCutting), kContext);
  EXPECT_TRUE(s.known);
  EXPECT_EQ(s.state, "cutting");
  EXPECT_DOUBLE_EQ(s.force_N, 5.0);
  EXPECT_DOUBLE_EQ(s.depth_mm, 4.0);
  EXPECT_DOUBLE_EQ(s.deepest_mm, 5.0);
  EXPECT_TRUE(s.can_pause);
  EXPECT_FALSE(s.can_resume);
}

TEST(LiveStatus, HasTheLatencyOfItsContext) {
  EXPECT_TRUE(nlohmann::json::parse(StatusJson(StatusOf(Window(safety::CellState::kCutting), kContext)))
                  .at("latency_ms")
                  .is_null());
  LiveContext context = kContext;
  context.latency = [] {
    return LatencyStatus{
        .known = true,
        .hand_to_arm_ms = 26.0,
        .bone_to_hand_ms = 28.0,
        .parts = {{.name = "sensor", .mean_ms = 1.0}, {.name = "arm", .mean_ms = 25.0, .measured = true}}};
  };
  const auto json = nlohmann::json::parse(StatusJson(StatusOf(Window(safety::CellState::kCutting), context)));
  const auto& latency = json.at("latency_ms");
  EXPECT_EQ(latency.at("hand_to_arm"), 26.0);
  EXPECT_EQ(latency.at("measured"), false);
  EXPECT_EQ(latency.at("parts").at("arm").at("mean"), 25.0);
  EXPECT_EQ(latency.at("parts").at("sensor").at("measured"), false);
}

TEST(LiveStatus, TellsTheAgeOfTheBoneThatFollows) {
  LiveContext context = kContext;
  const LiveWindow window = Window(safety::CellState::kCutting);
  EXPECT_TRUE(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"].is_null());
  context.bone_age_s = [] { return std::optional<double>(); };
  EXPECT_TRUE(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"].is_null());
  context.bone_age_s = [] { return std::optional<double>(2.5); };
  EXPECT_EQ(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"], 2500.0);
}

TEST(LiveStatus, APausedCellCanOnlyGoOn) {
  const LiveStatus s = StatusOf(Window(safety::CellState::kPaused), kContext);
  EXPECT_FALSE(s.can_pause);
  EXPECT_TRUE(s.can_resume);
}

TEST(LiveStatus, ARecoveryIsOfferedAtRestForFaultsThatAllowIt) {
  LiveWindow w = Window(safety::CellState::kFault);
  w.tick.faults = static_cast<std::uint32_t>(safety::Fault::kSession);
  EXPECT_TRUE(StatusOf(w, kContext).can_recover);
  w.tick.cell_state = static_cast<std::uint8_t>(safety::CellState::kStop1);
  EXPECT_FALSE(StatusOf(w, kContext).can_recover) << "it still brakes";
  w.tick.cell_state = static_cast<std::uint8_t>(safety::CellState::kFault);
  w.tick.input.stop = true;
  EXPECT_FALSE(StatusOf(w, kContext).can_recover) << "the run ends";
  w.tick.input.stop = false;
  w.tick.faults |= static_cast<std::uint32_t>(safety::Fault::kInterlock);
  EXPECT_FALSE(StatusOf(w, kContext).can_recover) << "one of them asks for a new run";
  EXPECT_FALSE(StatusOf(Window(safety::CellState::kCutting), kContext).can_recover);
}

// While the arm moves the loop does not evaluate the conditions: the tick's bits are zero, and nothing is
// missing.
TEST(LiveStatus, ConditionsAreShownAsTheyAreAndWhileMovingAsTheyWere) {
  LiveWindow w = Window(safety::CellState::kChecking);
  safety::MotionPermits permits(safety::MotionPermits::kAll);
  permits.Set(safety::MotionPermit::kSensorFresh, false);
  w.tick.permits = permits.bits();
  const LiveStatus waits = StatusOf(w, kContext);
  ASSERT_EQ(waits.permits.size(), static_cast<std::size_t>(safety::kMotionPermits));
  for (const PermitStatus& permit : waits.permits)
    EXPECT_EQ(permit.holds, permit.text != safety::DescribeMissing(safety::MotionPermit::kSensorFresh))
        << permit.text;
  w = Window(safety::CellState::kCutting);
  w.tick.permits = 0;
  for (const PermitStatus& permit : StatusOf(w, kContext).permits) EXPECT_TRUE(permit.holds);
}

TEST(LiveStatus, NamesLimitsAndFaultsWithTheirCure) {
  LiveWindow w = Window(safety::CellState::kFault);
  w.limits = 1u << static_cast<unsigned>(safety::Limit::kToolSpeed);
  w.tick.faults = 1u;
  const LiveStatus s = StatusOf(w, kContext);
  ASSERT_EQ(s.limits.size(), 1u);
  EXPECT_EQ(s.limits[0], "tool speed");
  ASSERT_EQ(s.faults.size(), 1u);
  EXPECT_EQ(s.faults[0].name, safety::Describe(static_cast<safety::Fault>(1u)).name);
  EXPECT_FALSE(s.faults[0].clearing.empty());
  EXPECT_TRUE(s.faults[0].allows_recovery);
  EXPECT_TRUE(s.can_recover);
}

TEST(LiveStatus, TheLineFitsTheTerminalAndKeepsWhatMatters) {
  LiveWindow w = Window(safety::CellState::kCutting);
  w.limits = ~0u;
  const LiveStatus s = StatusOf(w, kContext);
  for (const std::size_t columns : {20u, 40u, 79u, 120u, 400u}) {
    const std::string line = StatusLine(s, 10.0, columns);
    EXPECT_LE(base::ColumnsOf(line), columns) << line;
    EXPECT_TRUE(line.starts_with("cutting")) << line;
  }
  const std::string whole = StatusLine(s, 10.0, 400);
  for (const char* part : {"6.2 of 10.0 s, paused 2.0 s", "5.0 N", "4.00 mm", "tool speed", "model"})
    EXPECT_NE(whole.find(part), std::string::npos) << whole;
}

TEST(LiveStatus, BeforeTheFirstMessageItSaysSo) {
  EXPECT_EQ(StatusLine(StatusOf(LiveWindow{}, kContext), 10.0, 80), "waits for the first message");
}

TEST(LiveStatus, AStateThatNobodyKnowsIsNoCrash) {
  LiveWindow w = Window(safety::CellState::kCutting);
  w.tick.cell_state = control::kNoCellState;
  EXPECT_EQ(StatusOf(w, kContext).state, "");
}

TEST(LiveJson, HasARowForEachWindowAndTheLastOnesStatusAndPoses) {
  std::array windows{Window(safety::CellState::kHaptic), Window(safety::CellState::kCutting)};
  windows[1].frame.model.contact_count = 2;
  windows[1].frame.model.contacts[1].n_W = {0.0, 0.6, 0.8};
  const auto json = nlohmann::json::parse(LiveJson(windows, kContext));
  EXPECT_EQ(json["type"], "live");
  ASSERT_EQ(json["windows"].size(), 2u);
  for (const auto& row : json["windows"]) EXPECT_EQ(row.size(), std::size(kStripFields));
  EXPECT_EQ(json["status"]["state"], "cutting");
  EXPECT_EQ(json["view"]["X_WT"].size(), 12u);
  EXPECT_EQ(json["view"]["X_WP"][11], -0.004);
  ASSERT_EQ(json["view"]["contacts"].size(), 2u);
  EXPECT_EQ(json["view"]["contacts"][1][5], 0.8);
}

// Where the bone and the bent head are drawn: X_WE = X_WM X_ME. Without anything that gives way neither is
// sent.
TEST(LiveJson, HasTheBonesAndTheHeadsPosesWhereSomethingGivesWay) {
  std::array windows{Window(safety::CellState::kCutting)};
  EXPECT_FALSE(nlohmann::json::parse(LiveJson(windows, kContext))["view"].contains("X_WM"));
  control::ComplianceRecord& gives = windows[0].tick.compliance;
  gives.present = true;
  gives.X_WM.p = {0.0, 0.0, -0.002};
  gives.X_ME.p = {0.001, 0.0, 0.3};
  const auto view = nlohmann::json::parse(LiveJson(windows, kContext))["view"];
  EXPECT_EQ(view["X_WM"][11], -0.002);
  EXPECT_EQ(view["X_WE"][3], 0.001);
  EXPECT_NEAR(view["X_WE"][11].get<double>(), 0.298, 1e-9);
}

TEST(LiveJson, AnEventOfAnyBytesIsValidJson) {
  const std::array<io::RecordedEvent, 1> events{io::RecordedEvent{.stamp = 1, .text = "\"\x01\xff</script>"}};
  const auto json = nlohmann::json::parse(EventsJson(std::span<const io::RecordedEvent>(events)));
  EXPECT_EQ(json["events"].size(), 1u);
}

}  // namespace
}  // namespace osteon::console
