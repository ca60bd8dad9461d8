#include "studies/calibrate/calibration_history.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_path.h"

namespace osteon::studies {
namespace {

/// An entry of a payload and an apex, with typical uncertainties.
CalibrationEntry Entry(const std::string& time, double mass_kg, double bias_x_N, double apex_x_m) {
  return {.time = time,
          .payload = CalibrationEntry::Payload{.mass_kg = mass_kg,
                                               .mass_sd_kg = 0.002,
                                               .center_F_m = {0.0, 0.01, 0.08},
                                               .center_sd_m = 1e-4,
                                               .bias_N = {bias_x_N, -3.0, 5.0},
                                               .residual_N = 0.02},
          .apex = CalibrationEntry::Apex{.p_FT_m = {apex_x_m, 0.0, 0.2}, .sd_m = 1e-5, .residual_m = 2e-5}};
}

TEST(CalibrationHistory, AppendsEntriesAndNamesADamagedLine) {
  const std::filesystem::path file = HistoryFile(TemporaryPath("tool.yaml"));
  EXPECT_EQ(file.filename(), "tool.history.jsonl");
  std::filesystem::remove(file);
  ASSERT_TRUE(ReadHistory(file));
  EXPECT_TRUE(ReadHistory(file)->empty()) << "no file yet";
  ASSERT_TRUE(AppendHistory(file, Entry("2026-01-01T00:00:00Z", 2.5, 2.0, 1e-3)));
  ASSERT_TRUE(AppendHistory(file, {.time = "2026-02-01T00:00:00Z", .apex = CalibrationEntry::Apex{}}));
  const auto history = ReadHistory(file);
  ASSERT_TRUE(history) << history.error();
  ASSERT_EQ(history->size(), 2u);
  EXPECT_EQ(history->front().time, "2026-01-01T00:00:00Z");
  EXPECT_DOUBLE_EQ(history->front().payload->mass_kg, 2.5);
  EXPECT_NEAR(history->front().apex->p_FT_m.x(), 1e-3, 1e-12);
  EXPECT_FALSE(history->back().payload);
  std::ofstream(file, std::ios::app) << "{\"time\": 3}\n";
  const auto damaged = ReadHistory(file);
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().find("tool.history.jsonl:3: found"), std::string::npos) << damaged.error();
}

TEST(CalibrationHistory, ReportsChangesAboveTheFloorAndTheFitsUncertainty) {
  const CalibrationEntry first = Entry("a", 2.5, 2.0, 1e-3), second = Entry("b", 2.53, 2.0, 1e-3);
  EXPECT_TRUE(DriftSince({}, first).empty());
  EXPECT_TRUE(DriftSince({first}, Entry("c", 2.515, 2.3, 1.05e-3)).empty()) << "below every floor";
  EXPECT_EQ(DriftSince({first}, second).size(), 1u) << "30 g";
  CalibrationEntry unsure = second;
  unsure.payload->mass_sd_kg = 0.02;
  EXPECT_TRUE(DriftSince({first}, unsure).empty()) << "30 g is within the fit's uncertainty";
  const std::vector<std::string> drift = DriftSince({first, second}, Entry("c", 2.53, 3.0, 1.3e-3));
  ASSERT_EQ(drift.size(), 5u) << "bias and apex since either entry, the mass since the first";
  EXPECT_NE(drift[0].find("the sensor's bias has drifted by 1.00 N since b"), std::string::npos) << drift[0];
}

}  // namespace
}  // namespace osteon::studies
