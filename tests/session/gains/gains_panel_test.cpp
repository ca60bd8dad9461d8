#include "session/gains/gains_panel.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "safety/cell_state.h"
#include "session/replay/replay.h"
#include "tests/session/run/virtual_run.h"
#include "tests/session/set_up_cell.h"

namespace osteon::session {
namespace {

using Kind = console::GainsRequest::Kind;

// The console's panel of gains, on the cell "thin_plate".
class GainsPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    setup_ = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
    ASSERT_TRUE(setup_) << setup_.error();
    own_ = control::GainsOf(setup_->config.servo.admittance, setup_->config.servo.coupling);
  }
  decltype(SetUpCell("", std::nullopt)) setup_;
  control::Gains own_;  // the gains of the cell's file
};

TEST_F(GainsPanelTest, AcceptsOnlyASofterCouplingAndMoreDragThanTheCells) {
  GainsPanel panel(setup_->config);
  const double k = own_.max_stiffness_N_per_m, d = own_.damping_Ns_per_m.x;
  for (const auto& [kind, value] : {std::pair{Kind::kStiffness, 1.01 * k},
                                    {Kind::kStiffness, 0.05 * k},
                                    {Kind::kStiffness, -k},
                                    {Kind::kDrag, 0.9 * d},
                                    {Kind::kDrag, 100.0 * d}}) {
    const auto refused = panel.Request({.kind = kind, .value = value});
    EXPECT_FALSE(refused.done) << value;
    EXPECT_NE(refused.reason.find("accepted"), std::string::npos) << refused.reason;
  }
  EXPECT_FALSE(panel.Take()) << "nothing goes to the loop";
  EXPECT_TRUE(panel.Request({.kind = Kind::kStiffness, .value = 0.5 * k}).done);
  EXPECT_TRUE(panel.Request({.kind = Kind::kDrag, .value = 2.0 * d}).done);
  const auto taken = panel.Take();
  ASSERT_TRUE(taken);
  EXPECT_DOUBLE_EQ(taken->max_stiffness_N_per_m, 0.5 * k);
  EXPECT_DOUBLE_EQ(taken->damping_Ns_per_m.x, 2.0 * d);
  EXPECT_FALSE(panel.Take()) << "once";
}

TEST_F(GainsPanelTest, UndoRestoresThePreviousValuesOneByOne) {
  GainsPanel panel(setup_->config);
  EXPECT_FALSE(panel.Request({.kind = Kind::kUndo}).done);
  const double k = own_.max_stiffness_N_per_m;
  EXPECT_TRUE(panel.Request({.kind = Kind::kStiffness, .value = 0.5 * k}).done);
  EXPECT_TRUE(panel.Request({.kind = Kind::kStiffness, .value = 0.25 * k}).done);
  EXPECT_TRUE(panel.Request({.kind = Kind::kUndo}).done);
  EXPECT_DOUBLE_EQ(panel.Take()->max_stiffness_N_per_m, 0.5 * k);
  EXPECT_TRUE(panel.Request({.kind = Kind::kUndo}).done);
  EXPECT_DOUBLE_EQ(panel.Take()->max_stiffness_N_per_m, k);
  EXPECT_FALSE(nlohmann::json::parse(panel.Json())["can_undo"].get<bool>());
}

// The coupling is stable if D > a K, with the drag D, the contact model's age a and the stiffness K. Twice
// the drag must therefore permit twice the age.
TEST_F(GainsPanelTest, TheLargestStableAgeGrowsWithTheDrag) {
  GainsPanel panel(setup_->config);
  const double before = nlohmann::json::parse(panel.Json())["stable_age_ms"];
  EXPECT_TRUE(panel.Request({.kind = Kind::kDrag, .value = 2.0 * own_.damping_Ns_per_m.x}).done);
  EXPECT_NEAR(nlohmann::json::parse(panel.Json())["stable_age_ms"].get<double>(), 2.0 * before, 1e-9);
}

TEST_F(GainsPanelTest, AChangeDuringARunIsRecordedAndReplaysBitForBit) {
  auto engine = MakeEngine(*setup_, {});
  ASSERT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  GainsPanel panel(setup_->config);
  int asked = 0;
  const CellRunParams params{
      .seconds = 3.0,
      .virtual_time = true,
      .recording = folder.path() / "r.mcap",
      .gains_panel = &panel,
      .ticked = [&](const control::TickRecord& tick, const simulation::ContactModel&) {
        if (!safety::Renders(static_cast<safety::CellState>(tick.cell_state))) return;
        if (++asked == 500) {
          EXPECT_TRUE(panel.Request({.kind = Kind::kDrag, .value = 2.0 * own_.damping_Ns_per_m.x}).done);
        }
        if (asked == 2000) {
          EXPECT_TRUE(panel.Request({.kind = Kind::kUndo}).done);
        }
      }};
  const auto result = RunCell(*setup_, **engine, params);
  ASSERT_TRUE(result) << result.error().what;
  const auto recording = io::ReadRecording(params.recording);
  ASSERT_TRUE(recording) << recording.error();
  std::vector<double> drags;
  for (const control::TickRecord& tick : recording->ticks)
    if (tick.input.has_gains) drags.push_back(tick.input.gains.damping_Ns_per_m.x);
  EXPECT_EQ(drags, (std::vector{2.0 * own_.damping_Ns_per_m.x, own_.damping_Ns_per_m.x}));
  const ReplayResult replayed = Replay(*recording, setup_->config);
  EXPECT_TRUE(replayed.identical) << replayed.why_not
                                  << (replayed.first_difference ? replayed.first_difference->field : "");
}

}  // namespace
}  // namespace osteon::session
