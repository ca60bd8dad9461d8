#include "studies/validate/validate.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/validate/fitted_constants.h"
#include "studies/validate/validate_page.h"
#include "studies/validate/validate_plot.h"
#include "tests/report/report_markup.h"

// The rows of `osteon validate`: how they are chosen, judged and counted, and their table, JSON and page.

namespace osteon::studies {
namespace {

using testing::HasSubstr;

TEST(Validate, HasAtLeastTwelveJudgedRowsWithSourceAndConditions) {
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

TEST(Validate, ComparesWithTheResolutionThatTheSourceStates) {
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

// A measurement's row with this simulated value.
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
  EXPECT_EQ(KindsText(counts), "within: levels 1 of 2, trends 0 of 0, ranges 1 of 1, tolerances 0 of 0");
  EXPECT_THAT(ValidationTable(rows), HasSubstr("\n" + KindsText(counts) + "\n"));

  const nlohmann::json json = nlohmann::json::parse(ValidationJson(rows, "osteon validate"));
  EXPECT_EQ(json.at("schema"), "osteon.validate/1");
  for (const nlohmann::json& row : json.at("rows"))
    for (const char* key : {"id", "quantity", "measured", "spread", "simulated", "within", "fitted", "source",
                            "leaves_out", "conditions", "compliance"})
      EXPECT_TRUE(row.contains(key)) << key;
  EXPECT_EQ(json.at("rows")[0].at("fitted"), true);
  EXPECT_EQ(json.at("rows")[1].at("within"), true);
  EXPECT_EQ(json.at("rows")[2].at("reason"), "shown");
  EXPECT_TRUE(json.at("rows")[1].at("reason").is_null()) << "a row that lies within needs none";
  EXPECT_TRUE(json.at("rows")[5].at("simulated").is_null());
  EXPECT_EQ(json.at("fitted_constants").size(), 4u);
  EXPECT_EQ(json.at("counts").at("by_use").at("validates"), nlohmann::json({{"judged", 2}, {"within", 1}}));
  EXPECT_EQ(json.at("counts").at("by_use").at("tolerance"), nlohmann::json({{"judged", 0}, {"within", 0}}));

  const std::string page = ValidationPage(rows, "osteon validate");
  EXPECT_THAT(page, HasSubstr("1 of 3 judged rows miss"));
  EXPECT_THAT(page, HasSubstr("Why it misses: shown"));
  EXPECT_THAT(page, HasSubstr(KindsText(counts)));
  EXPECT_EQ(report::MarkupError(page), "");
  const std::string plot = ValidationPlot(rows);
  EXPECT_EQ(report::TextsOverlapping(plot), "");
  EXPECT_EQ(report::TextOutside(plot), "");
}

// Each row also shows its variants (a tool that bends, bone on a mount) with their own verdicts, or the
// reason why there is no result.
TEST(Validate, ShowsEachRowWithAndWithoutCompliantParts) {
  std::vector<ValidationRow> rows{RowOf("3-high", 61.0), RowOf("8-level", 198.0)};
  rows[0].simulated.compliance = {{.part = CompliantPart::kTool, .simulated = 60.5},
                                  {.part = CompliantPart::kMount, .error = "cell stopped: mount_beyond"}};
  rows[1].simulated.compliance = {{.part = CompliantPart::kTool, .simulated = 197.5}};
  ASSERT_NE(rows[0].simulated.With(CompliantPart::kMount), nullptr);
  EXPECT_EQ(rows[1].simulated.With(CompliantPart::kMount), nullptr);
  EXPECT_EQ(rows[0].verdict(), "within") << "the row's own run decides";

  EXPECT_THAT(ValidationTable(rows), testing::ContainsRegex("3-high .* 61 +60.5 +- mm"));
  EXPECT_THAT(ValidationTable(rows), testing::ContainsRegex("8-level .* 198 +197.5 +N "));
  const nlohmann::json json = nlohmann::json::parse(ValidationJson(rows, "osteon validate"));
  const nlohmann::json &tool = json.at("rows")[0].at("compliance")[0],
                       &mount = json.at("rows")[0].at("compliance")[1];
  EXPECT_EQ(tool.at("part"), "tool");
  EXPECT_EQ(tool.at("simulated"), 60.5);
  EXPECT_EQ(tool.at("within"), false);
  EXPECT_EQ(mount.at("part"), "mount");
  EXPECT_TRUE(mount.at("simulated").is_null() && mount.at("within").is_null());
  EXPECT_EQ(mount.at("error"), "cell stopped: mount_beyond");
  EXPECT_TRUE(json.at("rows")[1].at("compliance")[0].at("within").is_null())
      << "a calibration has no verdict";
  const std::string page = ValidationPage(rows, "osteon validate");
  EXPECT_THAT(page, HasSubstr("<td class=\"n\">61 mm</td><td class=\"n\">60.5</td><td class=\"n\"></td><td "
                              "class=\"n\">–</td><td>validates</td>"));
  EXPECT_THAT(page, HasSubstr("<th class=\"n\">tool bends</th><th class=\"n\">layer yields</th><th "
                              "class=\"n\">on a mount</th><th>use</th>"));
  EXPECT_THAT(page, HasSubstr("60.5 mm: a tool that bends"));
  EXPECT_THAT(page, HasSubstr("no result, cell stopped: mount_beyond: the bone on the mount"));
  EXPECT_EQ(report::MarkupError(page), "");
}

// Every row that runs cells must also run with a tool that bends. Except for the hand-held drill and bur, it
// must also run with its bone on a mount. The demo's rows must also run with cartilage that yields.
TEST(Validate, RowsOfCellsAreAlsoRunWithCompliantParts) {
  for (const ValidationItem& item : ValidationItems()) {
    if (!item.cells) continue;
    const std::vector<CellTrialParams> cells = item.cells(true);
    const auto bent = std::ranges::count_if(cells, [](const CellTrialParams& cell) {
      return std::ranges::find(cell.set, "compliance.tool=on") != cell.set.end();
    });
    const auto yielding = std::ranges::count_if(cells, [](const CellTrialParams& cell) {
      return std::ranges::find(cell.set, "compliance.layer=on") != cell.set.end();
    });
    const auto mounted = std::ranges::count(cells, "pelvis_mount", &CellTrialParams::cell);
    const bool by_foam = item.id.starts_with("1-") || item.id.starts_with("2-");
    const bool by_demo =
        FindMeasurement(item.id)->use != RowUse::kValidates && item.id != "12" && item.id != "15";
    EXPECT_EQ(yielding, by_demo ? 1 : 0) << item.id;
    EXPECT_EQ(bent, by_foam ? 2 : 1) << item.id;
    EXPECT_EQ(mounted, item.id == "12" || item.id == "15" ? 0 : by_foam ? 2 : 1) << item.id;
  }
}

// Runs rows from the drill through the engine to the verdict. The simulated thrust must use no constant that
// was fitted to it, and the edge force must slow the thrust's fall with the spindle's speed.
TEST(Validate, SawbonesThrustIsIndependentOfItsOwnMeasurement) {
  ValidationLab lab({.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config", .quick = true});
  const std::vector<std::string> ids{"9-1000", "9-1500", "9-speed"};
  const auto rows = RunValidation(lab, ids, [](std::string_view) {});
  ASSERT_EQ(rows.size(), 3u);
  for (const ValidationRow& row : rows)
    for (const std::string& constant : row.simulated.constants)
      for (const FittedConstant& fitted : FittedConstants())
        EXPECT_FALSE(fitted.name() == constant &&
                     std::ranges::find(fitted.minor, row.measurement->id) != fitted.minor.end())
            << row.measurement->id << " has a part in " << constant;
  // the shipped energy is 0.5 J/mm³; the torques alone give 0.485
  const Ablation& shipped = rows[0].simulated.ablations.at(2);
  EXPECT_THAT(shipped.what, HasSubstr("shipped cutting energy"));
  EXPECT_NEAR(rows[0].simulated.value / shipped.simulated, 0.485 / 0.5, 0.005) << rows[0].error;
  EXPECT_EQ(rows[1].verdict(), "misses") << rows[1].simulated.value;
  EXPECT_NEAR(rows[2].simulated.ablations.at(0).simulated, 1.0, 0.02) << "at the same feed a turn";
  EXPECT_NEAR(rows[2].simulated.ablations.at(1).simulated, 2.0 / 3.0, 0.02) << "without the edges' own force";
  EXPECT_GT(rows[2].simulated.value, 0.75);
  const ComplianceVariant* bent = rows[0].simulated.With(CompliantPart::kTool);
  ASSERT_TRUE(bent && bent->simulated);
  EXPECT_NEAR(*bent->simulated, rows[0].simulated.value, 0.02 * rows[0].simulated.value)
      << "at a constant feed a drill that bends settles at the same thrust";
  EXPECT_NE(*bent->simulated, rows[0].simulated.value);
}

// Runs a row whose simulation is a whole cell with its hand.
TEST(Validate, TheDemosHandFeelsTheRenderedForce) {
  ValidationLab lab({.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config", .quick = true});
  const std::vector<std::string> ids{"18"};
  const auto rows = RunValidation(lab, ids, [](std::string_view) {});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].error, "");
  EXPECT_EQ(rows[0].verdict(), "within") << rows[0].simulated.value;
  EXPECT_GT(rows[0].simulated.value, 0.0);
  for (const CompliantPart part : {CompliantPart::kTool, CompliantPart::kLayer, CompliantPart::kMount}) {
    const ComplianceVariant* variant = rows[0].simulated.With(part);
    ASSERT_NE(variant, nullptr) << NameOf(part);
    ASSERT_TRUE(variant->simulated) << NameOf(part) << ": " << variant->error;
    EXPECT_LT(*variant->simulated, 7.0) << NameOf(part);
    EXPECT_NE(*variant->simulated, rows[0].simulated.value) << NameOf(part) << " changes nothing";
  }
}

}  // namespace
}  // namespace osteon::studies
