#include "studies/failures/page/failure_scenes.h"

#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "base/text.h"
#include "studies/failures/failure.h"
#include "studies/failures/page/failure_page.h"
#include "tests/report/report_markup.h"

namespace osteon::studies {
namespace {

TEST(FailureScenes, EveryScenarioHasALegibleScene) {
  std::set<std::string> drawn;
  for (const FailureScenario& scenario : FailureScenarios()) {
    const std::string svg = FailureSceneSvg(scenario.id, scenario.name);
    ASSERT_FALSE(svg.empty()) << scenario.id << " " << scenario.name
                              << " has no scene: see studies/failures/page/failure_scenes.h";
    EXPECT_EQ(report::MarkupError(svg), "") << scenario.name;
    EXPECT_EQ(report::TextOutside(svg), "") << scenario.name;
    EXPECT_EQ(report::TextsOverlapping(svg), "") << scenario.name;
    for (const report::TextBox& box : report::TextBoxes(svg))
      EXPECT_GE(box.size_px, 11.0) << scenario.name << ": " << box.text;
    EXPECT_EQ(svg.find("\xE2\x80\xA6"), std::string::npos) << scenario.name << ": a text is cut";
    EXPECT_NE(svg.find(kWrongColor), std::string::npos) << scenario.name;
    EXPECT_NE(svg.find(kRightColor), std::string::npos) << scenario.name;
    EXPECT_TRUE(drawn.insert(svg).second) << scenario.name;
  }
}

// Whether a circle extends beyond the picture's top: its centre's y is less than its radius.
bool HasCircleBeyondTop(const std::string& svg) {
  const std::regex circle("<circle cx=\"[^\"]*\" cy=\"([^\"]*)\" r=\"([^\"]*)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), circle), end; at != end; ++at)
    if (std::stod((*at)[1]) < std::stod((*at)[2])) return true;
  return false;
}

TEST(FailureScenes, NoBallIsCutOffAtTheTop) {
  for (const FailureScenario& scenario : FailureScenarios())
    EXPECT_FALSE(HasCircleBeyondTop(FailureSceneSvg(scenario.id, scenario.name))) << scenario.name;
}

TEST(FailureScenes, NoNumberIsDrawnTwiceOrForNoScenario) {
  std::set<int> scenarios, scenes;
  for (const FailureScenario& scenario : FailureScenarios()) scenarios.insert(scenario.id);
  for (const auto& list : {ContactScenes(), CuttingScenes(), ArmScenes(), GuidanceScenes(), PlanScenes(),
                           SequenceScenes(), ComplianceScenes()})
    for (const FailureScene& scene : list) EXPECT_TRUE(scenes.insert(scene.id).second) << scene.id;
  EXPECT_EQ(scenes, scenarios);
  EXPECT_EQ(FailureSceneSvg(0, "none"), "");
}

// A made-up result whose axis label is too long for its axis.
FailureResult Example() {
  return {.id = 15,
          .name = "sensor",
          .metric = "speed of a tool that nobody holds",
          .unit = "mm/s",
          .bound = 1.0,
          .baseline = 16.84,
          .ours = 1.592e-14,
          .plot = {.x_label = "time [s]",
                   .y_label = "a name of an axis that is longer than the axis is high [mm]",
                   .series = {{.name = "no dead zone", .x = {0, 1}, .y = {0, 17}},
                              {.name = "ours", .x = {0, 1}, .y = {0, 0}, .ours = true}}}};
}

TEST(FailureChart, TitleSaysWhatIsPlotted) {
  FailureResult result = Example();
  EXPECT_NE(FailureSvg(result).find(">15 sensor: a name of an axis"), std::string::npos);
  result.plot.bound_is_on_y = true;
  EXPECT_NE(FailureSvg(result).find(">15 sensor: speed of a tool"), std::string::npos);
  EXPECT_NE(FailureSvg(result).find(">bound 1 mm/s<"), std::string::npos);
}

TEST(FailureChart, WrapsLongTextsInsteadOfCuttingThem) {
  FailureResult result = Example();
  result.plot.bound_is_on_y = true;
  result.metric +=
      ", in a scene whose name and metric together are far too long for a single line of a title";
  const std::string svg = FailureSvg(result);
  EXPECT_EQ(svg.find("\xE2\x80\xA6"), std::string::npos);
  EXPECT_EQ(report::TextOutside(svg), "");
  EXPECT_EQ(report::TextsOverlapping(svg), "");
}

TEST(FailureTable, ParagraphsAreInLinesOf120Characters) {
  EXPECT_EQ(base::WrapMarkdown(""), "");
  EXPECT_EQ(base::WrapMarkdown("short"), "short");
  const std::string word(59, 'a'), micro = std::string(58, 'b') + "\xC2\xB5";
  EXPECT_EQ(base::WrapMarkdown(word + " " + micro + " c"), word + " " + micro + "\nc")
      << "59 + 1 + 59 characters";
  EXPECT_EQ(base::WrapMarkdown(word + " " + word + " `ls -l`"), word + " " + word + "\n`ls -l`");
  EXPECT_EQ(base::WrapMarkdown(std::string(130, 'd') + " e"), std::string(130, 'd') + "\ne")
      << "a word is not cut";
}

TEST(FailureTable, NumbersHaveTwoSignificantDigits) {
  const FailurePageEntry entry{.result = Example(), .passed = true, .seconds = 1.0};
  const std::string page = FailureMarkdown({&entry, 1}, {}, "pictures");
  EXPECT_NE(page.find("| 17 mm/s | 1.6e-14 mm/s | passes |"), std::string::npos) << page;
  EXPECT_NE(page.find("](pictures/15_sensor_scene.svg)"), std::string::npos);
  EXPECT_NE(page.find("](pictures/15_sensor.svg)"), std::string::npos);
}

}  // namespace
}  // namespace osteon::studies
