#include "session/procedure/load_step.h"

#include <gtest/gtest.h>

#include "safety/cell_state.h"
#include "session/procedure/procedure_session.h"

namespace osteon::session {
namespace {

// The parameters of a sensor with a tool of this mass.
control::ForceSensorParams Load(double mass_kg) {
  return {.X_FS = {}, .tool_mass_kg = mass_kg, .tool_center_F_m = Vector3(0.0, 0.0, 0.1)};
}

// A reading is the tool's weight m g along W's -z, in the frame of a rotated sensor, plus a constant bias.
// After a change of tool the new reading is one of three: that of the right reamer, that without a reamer, or
// that of the neighbouring size.
TEST(LoadStep, AMissingReamerIsFoundButANeighbouringSizeIsNot) {
  Pose X_WF = Pose::Identity();
  X_WF.linear() = Eigen::AngleAxisd(2.5, Vector3(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
  const auto weight = [&](double mass_kg) {
    return Vector3(X_WF.linear().transpose() * Vector3(0.0, 0.0, -9.81 * mass_kg));
  };
  const Vector3 bias(3.0, -1.0, 2.0);
  const Vector3 before = weight(0.876) + bias, right = weight(0.8894) + bias, missing = bias;
  EXPECT_LT(LoadStepError_N(before, right, Load(0.876), Load(0.8894), X_WF), 1e-9);
  EXPECT_NEAR(LoadStepError_N(before, missing, Load(0.876), Load(0.8894), X_WF), 9.81 * 0.8894, 1e-9);
  const Vector3 neighbour = weight(0.8847) + bias;
  EXPECT_LT(LoadStepError_N(before, neighbour, Load(0.876), Load(0.8894), X_WF), 0.05)
      << "4.7 g: a person confirms the size";
}

TEST(LoadStep, OnlyReadingsDuringAPauseCount) {
  PausedReadings readings;
  control::TickRecord tick;
  const auto run = [&](safety::CellState state, int count, double z_N) {
    tick.cell_state = static_cast<std::uint8_t>(state);
    tick.input.F_sensor_S.f = Vector3(0.0, 0.0, z_N);
    for (int i = 0; i < count; ++i) readings.Add(tick);
  };
  run(safety::CellState::kCutting, 2000, 100.0);
  EXPECT_FALSE(readings.known());
  run(safety::CellState::kPaused, 400, 5.0);
  EXPECT_FALSE(readings.known());
  run(safety::CellState::kPaused, 800, 6.0);
  ASSERT_TRUE(readings.known());
  EXPECT_NEAR(readings.first_S().z(), 5.0, 1e-12);
  EXPECT_NEAR(readings.newest_S().z(), 6.0, 1e-12);
  run(safety::CellState::kPaused, 100, 6.0);
  readings.Restart();  // the readings since the last mean belong to the old tool
  run(safety::CellState::kPaused, PausedReadings::kTicksUntilKnown, 7.0);
  ASSERT_TRUE(readings.known());
  EXPECT_NEAR(readings.first_S().z(), 7.0, 1e-12);
  EXPECT_NEAR(readings.newest_S().z(), 7.0, 1e-12);
  run(safety::CellState::kHaptic, 1, 0.0);
  EXPECT_FALSE(readings.known());
}

TEST(SessionRequest, AcceptsOnlyTheKnownRequests) {
  using Kind = SessionRequest::Kind;
  EXPECT_EQ(ParseSessionRequest("next")->kind, Kind::kNext);
  EXPECT_EQ(ParseSessionRequest("tool 46")->diameter_mm, 46.0);
  EXPECT_TRUE(ParseSessionRequest("tool 46.5 confirmed")->confirmed);
  EXPECT_EQ(ParseSessionRequest(" undo ")->kind, Kind::kUndo);
  EXPECT_EQ(ParseSessionRequest("finish")->kind, Kind::kFinish);
  EXPECT_FALSE(ParseSessionRequest("finish")->confirmed);
  EXPECT_TRUE(ParseSessionRequest("finish confirmed")->confirmed);
  for (const char* wrong : {"", "tool", "tool x", "tool 46 47", "tool nan", "undo confirmed", "confirmed",
                            "next now", "NEXT", "save all"})
    EXPECT_FALSE(ParseSessionRequest(wrong)) << wrong;
}

}  // namespace
}  // namespace osteon::session
