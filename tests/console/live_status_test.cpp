#include "console/stream/live_status.h"

#include <array>
#include <optional>
#include <span>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "console/stream/live_json.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/motion_permit.h"
#include "safety/watchdog.h"

// Tests the status that the console shows: its figures, its text line for the terminal, and its JSON.

namespace osteon::console {
namespace {

// A window of a cell in this state, with a force of 5 N and a depth of 4 mm.

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

TEST(LiveStatus, HasStateForceAndDepth) {
  const LiveStatus s = StatusOf(Window(safety::CellState::kCutting), kContext);
  EXPECT_TRUE(s.known);
  EXPECT_EQ(s.state, "cutting");
  EXPECT_DOUBLE_EQ(s.force_N, 5.0);
  EXPECT_DOUBLE_EQ(s.depth_mm, 4.0);
  EXPECT_DOUBLE_EQ(s.deepest_mm, 5.0);
  EXPECT_TRUE(s.can_pause);
  EXPECT_FALSE(s.can_resume);
}

TEST(LiveStatus, HasTheLatencyWhereTheContextHasOne) {
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

TEST(LiveStatus, NamesTheForceLimitThatActsNow) {
  LiveContext context = kContext;
  context.force_limit_from = "cell";
  context.torque_limit_Nm = 20.0;
  LiveWindow w = Window(safety::CellState::kCutting);
  w.tick.F_coupling_T_W.t = {0.0, 2.0, 0.0};
  LiveStatus s = StatusOf(w, context);
  EXPECT_EQ(s.force_limit_now_N, 200.0);
  EXPECT_EQ(s.force_limit_number, -1);
  EXPECT_EQ(s.torque_Nm, 2.0);
  w.limits = w.tick.limits = 1u << static_cast<unsigned>(safety::Limit::kArmTorque) |
                             1u << static_cast<unsigned>(safety::Limit::kToolSpeed);
  w.tick.stamp = 5 * rt::kSecond;
  w.limit_since[static_cast<std::size_t>(safety::Limit::kArmTorque)] = 3 * rt::kSecond;
  s = StatusOf(w, context);
  EXPECT_EQ(s.force_limit_now_N, 5.0) << "what the arm's joints can hold is what is rendered";
  EXPECT_EQ(s.force_limit_number, static_cast<int>(safety::Limit::kArmTorque));
  EXPECT_EQ(s.limits_for_s, (std::vector{2.0, 5.0}));
  const auto json = nlohmann::json::parse(StatusJson(s));
  EXPECT_EQ(json.at("force_limit_from"), "cell");
  EXPECT_EQ(json.at("force_limit_N"), 200.0) << "the cell's own stays";
  EXPECT_EQ(json.at("limits_for_s").size(), json.at("limits").size());
}

TEST(LiveStatus, HasTheFeedAndTheRemainingDepthWhereTheyAreKnown) {
  LiveContext context = kContext;
  LiveWindow w = Window(safety::CellState::kCutting);
  w.tick.v_WT_cmd_m_per_s = {0.003, 0.0, -0.004};
  auto json = nlohmann::json::parse(StatusJson(StatusOf(w, context)));
  EXPECT_TRUE(json.at("depth_left_mm").is_null());
  EXPECT_TRUE(json.at("feed_mm_per_s").is_null());
  context.axis_W = PlainVector3(0.0, 0.0, 1.0);
  context.depth_left_m = [](const control::TickRecord& tick) { return 0.006 + tick.X_WT_cmd.p.z; };
  w.tick.X_WT_cmd.p.z = -0.002;
  json = nlohmann::json::parse(StatusJson(StatusOf(w, context)));
  EXPECT_NEAR(json.at("depth_left_mm").get<double>(), 4.0, 1e-9);
  EXPECT_NEAR(json.at("feed_mm_per_s").get<double>(), 4.0, 1e-9) << "into the bone";
}

TEST(LiveStatus, HasTheAgesOfArmAndPlcMessagesAndTheirLosses) {
  LiveContext context = kContext;
  LiveWindow w = Window(safety::CellState::kCutting);
  w.arm_age_s.Begin(0.003);
  w.interlock_age_s.Begin(0.02);
  w.compute_p99_us = 41.0;
  w.tick.input.lost = 3;
  w.tick.input.answers_lost = 2;
  auto json = nlohmann::json::parse(StatusJson(StatusOf(w, context)));
  EXPECT_NEAR(json.at("arm_age_ms").get<double>(), 3.0, 1e-9);
  EXPECT_TRUE(json.at("plc_age_ms").is_null()) << "motion needs none here";
  EXPECT_TRUE(json.at("disk_left_B").is_null());
  EXPECT_EQ(json.at("compute_p99_us"), 41.0);
  EXPECT_EQ(json.at("arm_messages_lost"), 3);
  EXPECT_EQ(json.at("answers_lost"), 2);
  context.has_plc = true;
  context.disk_left_B = [] { return std::optional<std::uintmax_t>(7'000'000'000); };
  json = nlohmann::json::parse(StatusJson(StatusOf(w, context)));
  EXPECT_NEAR(json.at("plc_age_ms").get<double>(), 20.0, 1e-9);
  EXPECT_EQ(json.at("disk_left_B"), 7'000'000'000);
  w.arm_age_s.Begin(safety::kNoAge_s);
  w.tick.model_age_s = w.tick.sensor_age_s = safety::kNoAge_s;
  json = nlohmann::json::parse(StatusJson(StatusOf(w, context)));
  for (const char* key : {"arm_age_ms", "model_age_ms", "sensor_age_ms"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  EXPECT_EQ(StatusLine(StatusOf(w, context), 0.0, 200).find("model"), std::string::npos);
}

TEST(LiveStatus, AFaultHasItsMeasuredCauseAndTheStopsPage) {
  LiveContext context = kContext;
  LiveWindow w = Window(safety::CellState::kFault);
  w.tick.faults = static_cast<std::uint32_t>(safety::Fault::kSensorStale);
  context.fault = [](std::uint32_t fault) {
    return FaultNote{.seen = fault == static_cast<std::uint32_t>(safety::Fault::kSensorStale)
                                 ? "the reading is 101 ms old"
                                 : "another",
                     .page = "run_stop_1.html"};
  };
  const auto fault = nlohmann::json::parse(StatusJson(StatusOf(w, context))).at("faults").at(0);
  EXPECT_EQ(fault.at("seen"), "the reading is 101 ms old");
  EXPECT_EQ(fault.at("page"), "run_stop_1.html");
  EXPECT_EQ(StatusOf(w, kContext).faults.at(0).note.seen, "") << "a recording's page";
}

TEST(LiveStatus, HasTheAgeOfTheDrawnBoneWhereItIsKnown) {
  LiveContext context = kContext;
  const LiveWindow window = Window(safety::CellState::kCutting);
  EXPECT_TRUE(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"].is_null());
  context.bone_age_s = [] { return std::optional<double>(); };
  EXPECT_TRUE(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"].is_null());
  context.bone_age_s = [] { return std::optional<double>(2.5); };
  EXPECT_EQ(nlohmann::json::parse(StatusJson(StatusOf(window, context)))["bone_age_ms"], 2500.0);
}

TEST(LiveStatus, APausedCellCanOnlyResume) {
  const LiveStatus s = StatusOf(Window(safety::CellState::kPaused), kContext);
  EXPECT_FALSE(s.can_pause);
  EXPECT_TRUE(s.can_resume);
}

TEST(LiveStatus, RecoveryIsOfferedAtRestIfAllFaultsAllowIt) {
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

// While the arm moves, the loop does not evaluate the conditions for a start of motion. Their bits in the
// tick are then zero, but no condition must be shown as missing.
TEST(LiveStatus, ConditionsForMotionAreShownAndCountAsMetDuringMotion) {
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

TEST(LiveStatus, NamesLimitsAndFaultsAndHowToClearThem) {
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

TEST(LiveStatus, TheLineFitsTheTerminalAndBeginsWithTheState) {
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

TEST(LiveStatus, TheLineSaysThatNoMessageHasCome) {
  EXPECT_EQ(StatusLine(StatusOf(LiveWindow{}, kContext), 10.0, 80), "waits for the first message");
}

TEST(LiveStatus, AnUnknownStateHasNoName) {
  LiveWindow w = Window(safety::CellState::kCutting);
  w.tick.cell_state = control::kNoCellState;
  EXPECT_EQ(StatusOf(w, kContext).state, "");
}

TEST(LiveJson, HasARowPerWindowAndTheLastWindowsStatusAndPoses) {
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

// In a compliant cell the page draws the bone at the pose X_WM, and the bent head at X_WE = X_WM X_ME. A
// rigid cell sends neither of these poses.
TEST(LiveJson, HasThePosesOfBoneAndBentHeadInACompliantCell) {
  std::array windows{Window(safety::CellState::kCutting)};
  EXPECT_FALSE(nlohmann::json::parse(LiveJson(windows, kContext))["view"].contains("X_WM"));
  control::ComplianceRecord& gives = windows[0].tick.compliance;
  gives.present = true;
  gives.X_WM.p = {0.0, 0.0, -0.002};
  gives.layer_m = {0.0, 0.0, -0.0005};
  gives.X_ME.p = {0.001, 0.0, 0.3};
  const auto view = nlohmann::json::parse(LiveJson(windows, kContext))["view"];
  EXPECT_EQ(view["X_WM"][11], -0.002);
  EXPECT_EQ(view["layer"], nlohmann::json({0.0, 0.0, -0.0005}))
      << "of it the tissue alone, which is drawn as a dent";
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
