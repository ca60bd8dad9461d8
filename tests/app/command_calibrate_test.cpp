#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "io/recording/recorder.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/serial_chain.h"
#include "tests/app/command.h"
#include "tests/config/cell_text.h"

// Runs `osteon calibrate` as a user does, on recordings whose true values are known.

namespace osteon::app {
namespace {

using kinematics::JointVector;

const std::filesystem::path kCell = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml";

// True values of the simulated sensor and tool, which the calibration must find: the payload's mass and
// centre of mass in the flange frame F, the sensor's bias, and the position of the tool's apex T in F.
struct Truth {
  double mass_kg{0.0};
  Vector3 center_F_m{Vector3::Zero()};
  Wrench bias{.f = {2.0, -3.0, 5.0}, .t = {0.1, 0.2, -0.3}};
  Vector3 p_FT_m{Vector3::Zero()};
};

// Records simulated measurements of a cell. The true payload and apex differ a little from those in the
// cell's file.
class CalibrateTest : public ::testing::Test {
 protected:
  CalibrateTest() {
    truth_.mass_kg = cell_.servo.sensor.tool_mass_kg + 0.2;
    truth_.center_F_m = Vector3(cell_.servo.sensor.tool_center_F_m) + Vector3(0.004, -0.002, 0.006);
    truth_.p_FT_m = cell_.tool.X_FT.translation() + Vector3(0.001, -0.002, 0.0015);
  }

  // Writes a recording in which the arm rests for 0.7 s at each place and moves between them. The sensor has
  // 0.1 N and 5 mN·m of noise.
  void Record(const std::filesystem::path& file, const std::vector<JointVector>& places) {
    const auto recorder = io::Recorder::Open(
        {.path = file, .tick_capacity = 1u << 15, .writer_thread = false}, io::SessionInfo{});
    ASSERT_TRUE(recorder) << recorder.error();
    control::TickRecord tick;
    tick.stamp = rt::kSecond;
    tick.session_state = 4;  // COMMANDING_ACTIVE
    tick.sensor_age_s = 0.001;
    std::normal_distribution<double> normal;
    const auto noise = [&](double size) {
      return Vector3(size * normal(random_), size * normal(random_), size * normal(random_));
    };
    // appends a tick with the arm at the joint positions q: the sensor reads the sum of bias, weight and
    // noise
    const auto push = [&](const JointVector& q) {
      tick.stamp += rt::kMillisecond;
      std::copy_n(q.data(), 7, tick.q_meas.begin());
      const Pose X_WF = cell_.X_WB * arm_.FlangePose(q), X_FS = cell_.servo.sensor.X_FS, X_WS = X_WF * X_FS;
      const Vector3 weight_W(0.0, 0.0, -9.81 * truth_.mass_kg);
      const Vector3 lever_W = X_WF * truth_.center_F_m - X_WS.translation();
      const Matrix3 R_SW = X_WS.linear().transpose();
      tick.input.F_sensor_S = Wrench{.f = truth_.bias.f + R_SW * weight_W + noise(0.1),
                                     .t = truth_.bias.t + R_SW * lever_W.cross(weight_W) + noise(0.005)};
      ASSERT_TRUE((*recorder)->Push(tick));
      ++tick.tick;
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (int k = 0; k < 100 && i > 0; ++k)
        push(places[i - 1] + (k + 1) / 101.0 * (places[i] - places[i - 1]));
      for (int k = 0; k < 700; ++k) push(places[i]);
    }
    ASSERT_TRUE((*recorder)->Close());
  }

  [[nodiscard]] JointVector Start() const { return cell_.start.q; }

  config::CellConfig cell_{config::LoadCell(kCell)};
  kinematics::LbrArm arm_{cell_.robot.lbr()->params};
  Truth truth_;
  std::mt19937 random_{7};
  TemporaryFolder folder_;
};

TEST_F(CalibrateTest, FindsPayloadBiasAndApexAndTheCellUsesThem) {
  std::vector<JointVector> weigh, tip;
  for (const auto& [a4, a5, a6] : {std::array{0.0, 0.0, 0.0},
                                   {0.3, 0.0, 0.5},
                                   {-0.3, 0.6, -0.4},
                                   {0.2, -0.7, 0.3},
                                   {0.0, 1.0, 0.6},
                                   {-0.2, -1.0, -0.5}}) {
    JointVector q = Start();
    q[3] += a4;
    q[4] += a5;
    q[5] += a6;
    weigh.push_back(q);
  }
  Record(folder_.path() / "weigh.mcap", weigh);
  // the arm is moved so that the tool's apex stays at one point while the flange turns about it
  const Pose X_WF = cell_.X_WB * arm_.FlangePose(Start());
  const Vector3 point_W = X_WF * truth_.p_FT_m;
  for (const auto& [x, y] :
       {std::array{0.0, 0.0}, {0.4, 0.0}, {-0.4, 0.1}, {0.0, 0.4}, {0.1, -0.4}, {0.3, 0.3}}) {
    Pose X = X_WF;
    X.linear() =
        X_WF.linear() *
        (Eigen::AngleAxisd(x, Vector3::UnitX()) * Eigen::AngleAxisd(y, Vector3::UnitY())).toRotationMatrix();
    X.translation() = point_W - X.linear() * truth_.p_FT_m;
    JointVector q;
    ASSERT_TRUE(arm_.Inverse(cell_.X_WB.inverse() * X, cell_.start.arm_angle_rad, Start(), q));
    tip.push_back(q);
  }
  Record(folder_.path() / "tip.mcap", tip);

  const CommandResult run =
      RunCommand(folder_.path(), {"calibrate", "demo", "--payload", "weigh.mcap", "--pivot", "tip.mcap",
                                  "--out", "found.yaml", "--json", "found.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder_.path() / "found.json");
  EXPECT_EQ(json.at("schema"), "osteon.calibrate/1");
  const nlohmann::json& payload = json.at("payload");
  EXPECT_EQ(payload.at("poses"), 6);
  // the mean of 500 readings per pose reduces the noise of 0.1 N to 5 mN, the weight of half a gram
  EXPECT_NEAR(payload.at("mass_kg").get<double>(), truth_.mass_kg, 0.003);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(payload.at("center_mm")[at].get<double>(), 1e3 * truth_.center_F_m[i], 0.5);
    EXPECT_NEAR(payload.at("bias_N")[at].get<double>(), truth_.bias.f[i], 0.03);
    EXPECT_NEAR(json.at("tcp").at("position_mm")[at].get<double>(), 1e3 * truth_.p_FT_m[i], 1e-3);
  }
  EXPECT_LT(json.at("residual").at("payload_N").get<double>(), 0.02);
  EXPECT_LT(json.at("residual").at("tcp_mm").get<double>(), 1e-3);

  // there is one residual for each posture; the repeatability is known only if a posture was visited twice
  ASSERT_EQ(payload.at("postures").size(), 6u);
  for (const nlohmann::json& posture : payload.at("postures")) EXPECT_LT(posture.at("residual_N"), 0.1);
  EXPECT_EQ(json.at("tcp").at("postures").size(), 6u);
  EXPECT_TRUE(json.at("repeatability_N").is_null());
  EXPECT_TRUE(json.at("drift").empty());
  EXPECT_EQ(json.at("earlier_calibrations"), 0);

  // the loop must use the calibration once the cell's file names it
  std::ofstream(folder_.path() / "cell.yaml") << "calibration: found.yaml\n" << config::CellText("demo");
  const config::CellConfig measured = config::LoadCell(folder_.path() / "cell.yaml");
  EXPECT_NEAR(measured.servo.sensor.tool_mass_kg, truth_.mass_kg, 0.003);
  EXPECT_LT((measured.tool.X_FT.translation() - truth_.p_FT_m).norm(), 1e-5);
  EXPECT_LT((Vector3(measured.servo.sensor.bias_S.f) - truth_.bias.f).norm(), 0.05);
  EXPECT_EQ(measured.simulated.sensor.tool_mass_kg, cell_.simulated.sensor.tool_mass_kg)
      << "the simulated cell stays as it was";
}

TEST_F(CalibrateTest, KeepsAHistoryAndWarnsOfDrift) {
  std::vector<JointVector> weigh;
  for (const auto& [a4, a5, a6] :
       {std::array{0.0, 0.0, 0.0}, {0.3, 0.0, 0.5}, {-0.3, 0.6, -0.4}, {0.2, -0.7, 0.3}, {0.0, 0.0, 0.0}}) {
    JointVector q = Start();
    q[3] += a4;
    q[4] += a5;
    q[5] += a6;
    weigh.push_back(q);
  }
  const auto calibrate = [&] {
    return RunCommand(folder_.path(), {"calibrate", "demo", "--payload", "weigh.mcap", "--out", "found.yaml",
                                       "--json", "found.json"});
  };
  Record(folder_.path() / "weigh.mcap", weigh);
  ASSERT_EQ(calibrate().exit_code, 0);
  nlohmann::json json = ReadJson(folder_.path() / "found.json");
  EXPECT_EQ(json.at("payload").at("poses"), 4) << "the first posture was visited again";
  EXPECT_LT(json.at("repeatability_N"), 0.05);
  EXPECT_GT(json.at("repeatability_N"), 0.0);

  Record(folder_.path() / "weigh.mcap", weigh);
  ASSERT_EQ(calibrate().exit_code, 0);
  json = ReadJson(folder_.path() / "found.json");
  EXPECT_EQ(json.at("earlier_calibrations"), 1);
  EXPECT_TRUE(json.at("drift").empty()) << json.at("drift").dump();

  truth_.mass_kg += 0.05;
  truth_.bias.f[0] += 2.0;
  Record(folder_.path() / "weigh.mcap", weigh);
  const CommandResult run = calibrate();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  json = ReadJson(folder_.path() / "found.json");
  ASSERT_EQ(json.at("drift").size(), 4u) << "mass and bias, since the last and since the first";
  EXPECT_NE(run.out.find("the payload's mass has drifted"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("the sensor's bias has drifted by 2.0"), std::string::npos) << run.out;

  // if a line of the history is damaged, the error names it and the calibration's file is not overwritten
  std::ofstream(folder_.path() / "found.history.jsonl", std::ios::app) << "no json\n";
  const CommandResult refused = calibrate();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("found.history.jsonl:4"), std::string::npos) << refused.err;
}

TEST_F(CalibrateTest, RefusesTooFewPosesAndAPayloadThatIsNotThisTools) {
  EXPECT_EQ(RunCommand(folder_.path(), {"calibrate", "demo"}).exit_code, 2);
  Record(folder_.path() / "still.mcap", {Start()});
  const CommandResult run = RunCommand(folder_.path(), {"calibrate", "demo", "--payload", "still.mcap"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("found 1 poses"), std::string::npos) << run.err;
  std::ofstream(folder_.path() / "other.yaml") << "payload:\n  mass_kg: 40\n";
  std::ofstream(folder_.path() / "cell.yaml") << "calibration: other.yaml\n" << config::CellText("demo");
  try {
    static_cast<void>(config::LoadCell(folder_.path() / "cell.yaml"));
    FAIL() << "40 kg are not this tool";
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("other.yaml:2"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("40"), std::string::npos);
  }
}

}  // namespace
}  // namespace osteon::app
