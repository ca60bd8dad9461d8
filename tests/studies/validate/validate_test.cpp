#include "studies/validate/validate.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/validate/validate_page.h"
#include "studies/validate/validate_plot.h"
#include "tests/report/report_markup.h"

// The table of `osteon validate`: its rows, what they choose, their JSON and page.

namespace osteon::studies {
namespace {

using testing::HasSubstr;

TEST(Validate, HasAtLeastTwelveRowsWithSourceConditionsAndWhatIsLeftOut) {
  ASSERT_EQ(ValidationItems().size(), Measurements().size());
  std::size_t judged = 0;
  std::set<std::string_view> ids;
  for (std::size_t i = 0; i < Measurements().size(); ++i) {
    const Measurement& m = Measurements()[i];
    EXPECT_EQ(ValidationItems()[i].id, m.id);
    EXPECT_TRUE(ids.insert(m.id).second) << m.id;
    EXPECT_FALSE(m.source.empty() || m.conditions.empty() || m.leaves_out.empty() || m.spread.empty())
        << m.id;
    if (m.judged()) {
      EXPECT_LE(m.low, m.measured) << m.id;
      EXPECT_GE(m.high, m.measured) << m.id;
    }
    judged += m.judged() && m.use != RowUse::kCalibrates;
  }
  EXPECT_GE(judged, 12u);
}

TEST(Validate, ComparesToTheLastDigitThatTheSourceStates) {
  const Measurement& wide = *FindMeasurement("3-high");  // 61.4 ± 0.4 mm, stated to 0.1 mm
  EXPECT_TRUE(wide.Contains(60.96));
  EXPECT_FALSE(wide.Contains(60.94));
  EXPECT_TRUE(wide.Contains(61.84));
  EXPECT_FALSE(wide.Contains(61.86));
}

TEST(Validate, ChoosesRowsByNumberAndById) {
  const std::vector<std::string> words{"9", "14-depth"};
  const auto ids = ChooseRows(words);
  ASSERT_TRUE(ids) << ids.error();
  EXPECT_EQ(*ids, (std::vector<std::string>{"9-1000", "9-1250", "9-1500", "9-speed", "9-to-8", "14-depth"}));
  const std::vector<std::string> wrong{"21"};
  EXPECT_THAT(ChooseRows(wrong).error(), HasSubstr("found 21, accepted 1, 2, 3, 5"));
}

ValidationRow RowOf(std::string_view id, double value) {
  return {.measurement = FindMeasurement(id), .simulated = {.value = value, .how = "run", .reason = "shown"}};
}

TEST(Validate, CountsMissesAndLeavesCalibrationOut) {
  std::vector<ValidationRow> rows{RowOf("8-level", 198.0), RowOf("9-1000", 87.0), RowOf("9-1500", 60.0),
                                  RowOf("7", 6000.0), RowOf("20", 120.0)};
  rows.push_back(RowOf("13", 3.5));
  rows.back().error = "no bone";
  const ValidationCounts counts = CountRows(rows);
  EXPECT_EQ(counts.rows, 6u);
  EXPECT_EQ(counts.judged, 3u);
  EXPECT_EQ(counts.within, 2u);
  EXPECT_EQ(counts.missed, 1u);
  EXPECT_EQ(counts.calibrates, 1u);
  EXPECT_EQ(counts.not_judged, 1u);
  EXPECT_EQ(counts.failed, 1u);
  EXPECT_EQ(counts.levels_and_trends_within, 1u)
      << "a range that an operator's choice decides does not count";

  const nlohmann::json json = nlohmann::json::parse(ValidationJson(rows, "osteon validate"));
  EXPECT_EQ(json.at("schema"), "osteon.validate/1");
  for (const nlohmann::json& row : json.at("rows"))
    for (const char* key : {"id", "quantity", "measured", "spread", "simulated", "within", "fitted", "source",
                            "leaves_out", "conditions"})
      EXPECT_TRUE(row.contains(key)) << key;
  EXPECT_EQ(json.at("rows")[0].at("fitted"), true);
  EXPECT_EQ(json.at("rows")[1].at("within"), true);
  EXPECT_EQ(json.at("rows")[2].at("reason"), "shown");
  EXPECT_TRUE(json.at("rows")[1].at("reason").is_null()) << "a row that lies within needs none";
  EXPECT_TRUE(json.at("rows")[5].at("simulated").is_null());
  EXPECT_EQ(json.at("fitted_constants").size(), 4u);

  const std::string page = ValidationPage(rows, "osteon validate");
  EXPECT_THAT(page, HasSubstr("1 of 3 judged rows miss"));
  EXPECT_THAT(page, HasSubstr("Why it misses: shown"));
  EXPECT_EQ(report::MarkupError(page), "");
  const std::string plot = ValidationPlot(rows);
  EXPECT_EQ(report::TextsOverlapping(plot), "");
  EXPECT_EQ(report::TextOutside(plot), "");
}

// A row through the whole way: drill, engine, verdict.
TEST(Validate, SawbonesThrustAt1000RpmLiesWithinAndTheEdgeSlowsItsFallWithTheSpeed) {
  ValidationLab lab({.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config", .quick = true});
  const std::vector<std::string> ids{"9-1000", "9-1500", "9-speed"};
  const auto rows = RunValidation(lab, ids, [](std::string_view) {});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].verdict(), "within") << rows[0].simulated.value << rows[0].error;
  EXPECT_EQ(rows[1].verdict(), "misses") << rows[1].simulated.value;
  EXPECT_NEAR(rows[2].simulated.ablations.at(0).simulated, 1.0, 0.02) << "at the same feed a turn";
  EXPECT_NEAR(rows[2].simulated.ablations.at(1).simulated, 2.0 / 3.0, 0.02) << "without the edges' own force";
  EXPECT_GT(rows[2].simulated.value, 0.75);
}

// A row that a cell with its hand runs.
TEST(Validate, TheDemosHandFeelsWhatIsRendered) {
  ValidationLab lab({.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config", .quick = true});
  const std::vector<std::string> ids{"18"};
  const auto rows = RunValidation(lab, ids, [](std::string_view) {});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].error, "");
  EXPECT_EQ(rows[0].verdict(), "within") << rows[0].simulated.value;
  EXPECT_GT(rows[0].simulated.value, 0.0);
}

}  // namespace
}  // namespace osteon::studies
