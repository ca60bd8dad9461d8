#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "config/reading/load_rubric.h"
#include "config/reading/strict/config_error.h"
#include "tests/temporary_path.h"

// Tests the rubric's file, which defines the score of a procedure. A metric gets full points up to one norm,
// and no points beyond another norm.

namespace osteon::config {
namespace {

const std::filesystem::path kRubric = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/rubrics/rubric.yaml";

TEST(RubricFiles, TheShippedRubricHasTheDesignsNormsAndASourceForEach) {
  const procedure::Rubric rubric = LoadRubric(kRubric);
  double weights = 0.0;
  for (const procedure::RubricItem& item : rubric.items) {
    weights += item.weight;
    EXPECT_FALSE(item.source.empty()) << item.metric;
  }
  EXPECT_DOUBLE_EQ(weights, 100.0);
  ASSERT_EQ(rubric.items.size(), 7u);
  // `full` and `zero` are the two norms in SI units: rad, m, m³
  const auto expect_item = [&](std::size_t i, const char* metric, double weight, double full, double zero) {
    EXPECT_EQ(rubric.items[i].metric, metric);
    EXPECT_DOUBLE_EQ(rubric.items[i].weight, weight);
    EXPECT_NEAR(rubric.items[i].full, full, 1e-12);
    EXPECT_NEAR(rubric.items[i].zero, zero, 1e-12);
  };
  expect_item(0, "axis_error", 30.0, 0.08726646259971647, 0.17453292519943295);
  expect_item(1, "superior_shift", 15.0, 3e-3, 6e-3);
  expect_item(2, "medial_shift", 15.0, 5e-3, 8e-3);
  expect_item(3, "diameter_error", 20.0, 0.3e-3, 1.6e-3);
  expect_item(4, "coverage", 10.0, 0.77, 0.61);
  expect_item(5, "over_reamed", 10.0, 0.0, 2e-6);
  expect_item(6, "under_reamed", 0.0, 0.0, 2e-6);
  EXPECT_TRUE(rubric.items[6].source.starts_with("assumed"))
      << "the design has no such item: shown, not scored";
  EXPECT_DOUBLE_EQ(rubric.breach_points, 20.0);
}

TEST(RubricFiles, WrongNormsWeightsAndMetricsAreRefused) {
  const std::filesystem::path file = TemporaryPath("rubric.yaml");
  const auto error = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      static_cast<void>(LoadRubric(file));
    } catch (const ConfigError& refused) {
      return refused.what();
    }
    return "";
  };
  const std::string norm = "{weight_points: 1, full_deg: 5, zero_deg: 5, source: x}";
  EXPECT_NE(error("axis_error: " + norm).find(":1: zero_deg: found 5, accepted more than full (5)"),
            std::string::npos);
  EXPECT_NE(error("coverage: {weight_points: 1, full_ratio: 0.6, zero_ratio: 0.7, source: x}")
                .find(":1: zero_ratio: found 0.7, accepted less than full (0.6)"),
            std::string::npos)
      << "no item gains by a larger error";
  EXPECT_NE(error("axis_error: {weight_points: 60, full_deg: 5, zero_deg: 10, source: x}\n"
                  "path: {weight_points: 60, full_mm: 5, zero_mm: 10, source: x}\n")
                .find(":2: weight_points: found 120 points"),
            std::string::npos);
  EXPECT_NE(error("axes_error: " + norm).find("axis_error"), std::string::npos);
}

}  // namespace
}  // namespace osteon::config
