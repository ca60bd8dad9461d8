#include "studies/regress/regress_result.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/io/temporary_folder.h"
#include "tests/report/report_markup.h"
#include "tests/studies/regress/sample_trace.h"

namespace osteon::studies {
namespace {

// Four results: one equal to the golden trace, one with other bits, one beyond a tolerance, and one without a
// golden trace.
std::vector<RegressResult> ResultsOfEachKind() {
  const auto make = [](const std::string& name, const auto& change) {
    RegressResult result;
    result.scenario.name = name;
    result.scenario.shows = "what <" + name + "> shows";
    result.golden = Golden{.head = {.scenario = name,
                                    .reasons = {"2026-01-02 commit abc: first & last"},
                                    .build = {},
                                    .machine = {},
                                    .engine = {},
                                    .sources = {}},
                           .trace = SampleTrace()};
    ScenarioRun run;
    run.trace = SampleTrace();
    run.seconds_simulated = 0.04;
    run.seconds_wall = 0.01;
    change(run.trace);
    result.run = run;
    result.difference = Compare(result.golden->trace, run.trace, result.scenario.tolerances);
    result.explained = Explain(result.difference, run.trace);
    return result;
  };
  std::vector<RegressResult> results;
  results.push_back(make("same", [](ScenarioTrace&) {}));
  results.push_back(make("rounds", [](ScenarioTrace& trace) {
    trace.hash ^= 1u;
    trace.digests[3][4] ^= 1u;
  }));
  results.push_back(make("differs", [](ScenarioTrace& trace) {
    trace.hash ^= 1u;
    trace.digests[3][4] ^= 1u;
    trace.samples[1].values[QuantityNamed("coupling_z_N")] += 1.0;
    trace.samples[1].values[QuantityNamed("tool_x_mm")] += 0.1;
  }));
  RegressResult none;
  none.scenario.name = "none";
  none.error = "no golden trace <yet>\x01";
  results.push_back(none);
  return results;
}

TEST(RegressResult, PassesWithinItsTolerancesUnlessExactBitsAreRequired) {
  const auto results = ResultsOfEachKind();
  EXPECT_TRUE(results[0].Passed(false) && results[0].Passed(true));
  EXPECT_TRUE(results[1].Passed(false));
  EXPECT_FALSE(results[1].Passed(true));
  EXPECT_FALSE(results[2].Passed(false));
  EXPECT_FALSE(results[3].Passed(false));
}

TEST(RegressResult, TableExplainsEachDifferenceBelowItsRow) {
  auto results = ResultsOfEachKind();
  const RegressOptions options;
  const std::string text = RegressTable({.results = results, .options = options, .seconds = 1.5});
  EXPECT_NE(text.find("same      passed  the same              0.04 s   0.01 s     4.0x\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("rounds    passed  differs"), std::string::npos) << text;
  EXPECT_NE(text.find("differs   FAILED  differs"), std::string::npos) << text;
  EXPECT_NE(text.find("none      ERROR"), std::string::npos) << text;
  EXPECT_NE(text.find("    coupling_z_N: left at 0.021 s (tick 20)"), std::string::npos) << text;
  EXPECT_NE(text.find("If that is meant: osteon regress "), std::string::npos) << text;
  EXPECT_NE(text.find("2 of 4 passed, 1 bit for bit, in 1.5 s\n"), std::string::npos) << text;
  results[0].updated = true;  // counted once
  const std::string updated = RegressTable({.results = results, .options = options, .seconds = 1.5});
  EXPECT_NE(updated.find("1 golden trace written, 1 of 3 passed, 0 bit for bit, in 1.5 s\n"),
            std::string::npos)
      << updated;
}

TEST(RegressResult, JsonHasTheDocumentedKeys) {
  const auto results = ResultsOfEachKind();
  const RegressOptions options;
  const auto json =
      nlohmann::json::parse(RegressJson({.results = results, .options = options, .seconds = 1.5}));
  EXPECT_EQ(json["schema"], "osteon.regress/1");
  EXPECT_EQ(json["passed"], false);
  ASSERT_EQ(json["scenarios"].size(), 4u);
  for (const auto& scenario : json["scenarios"])
    for (const char* key : {"name", "passed", "hash", "seconds_simulated", "seconds_wall"})
      EXPECT_TRUE(scenario.contains(key)) << key;
  EXPECT_EQ(json["scenarios"][0]["hash"], "0123456789abcdef");
  EXPECT_EQ(json["scenarios"][0]["passed"], true);
  EXPECT_EQ(json["scenarios"][1]["passed"], true);
  EXPECT_EQ(json["scenarios"][1]["identical"], false);
  EXPECT_EQ(json["scenarios"][2]["quantities"][0]["name"], "coupling_z_N");
  EXPECT_EQ(json["scenarios"][2]["quantities"][0]["left_tick"], 20);
  EXPECT_EQ(json["scenarios"][2]["first_difference"]["part"], "the coupling");
  EXPECT_EQ(json["scenarios"][2]["first_difference"]["tick"], 8);
}

// The JUnit file must have one suite, one case for each scenario, the counts, and no character that XML
// forbids.
TEST(RegressResult, JunitFileIsXmlWithACaseForEachScenario) {
  const auto results = ResultsOfEachKind();
  const RegressOptions options;
  const std::string xml = RegressJunit({.results = results, .options = options, .seconds = 1.5});
  EXPECT_TRUE(xml.starts_with("<?xml version=\"1.0\""));
  std::string markup = xml.substr(xml.find("<testsuites"));
  // the checker accepts names without hyphens only
  for (std::size_t at = 0; (at = markup.find("system-out")) != std::string::npos;) markup.erase(at + 6, 1);
  EXPECT_EQ(report::MarkupError(markup), "");
  EXPECT_NE(
      xml.find("<testsuite name=\"osteon regress\" tests=\"4\" failures=\"1\" errors=\"1\" time=\"1.500\">"),
      std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<testcase classname=\"osteon.regress\" name=\"same\" time=\"0.010\">\n    </testcase>"),
            std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<failure message=\"the first bit differs at 0.009 s (tick 8): the coupling"),
            std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<error message=\"no golden trace &lt;yet&gt;"), std::string::npos) << xml;
  EXPECT_NE(xml.find("<system-out>the first bit differs"), std::string::npos)
      << "what passed and is not the same says so: " << xml;
  EXPECT_EQ(xml.find('\x01'), std::string::npos);
}

TEST(RegressResult, PageShowsOnlyWhatDiffers) {
  const auto results = ResultsOfEachKind();
  const io::test::TemporaryFolder folder;
  RegressOptions options;
  options.out = folder.path() / "out";
  const auto page = WriteRegressReport({.results = results, .options = options, .seconds = 1.5});
  ASSERT_TRUE(page) << page.error();
  const std::string html = io::test::ReadAll(*page);
  EXPECT_EQ(report::MarkupError(html), "");
  EXPECT_EQ(html.find("what &lt;same&gt; shows"), std::string::npos);
  EXPECT_NE(html.find("what &lt;differs&gt; shows"), std::string::npos);
  EXPECT_NE(html.find("first &amp; last"), std::string::npos) << "why the golden trace was accepted";
  std::size_t charts = 0;
  for (std::size_t at = 0; (at = html.find("<svg", at)) != std::string::npos; ++at) ++charts;
  EXPECT_EQ(charts, 2u) << "one for each quantity that differs";

  const auto none =
      WriteRegressReport({.results = std::span(results).first(1), .options = options, .seconds = 1.0});
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
}

}  // namespace
}  // namespace osteon::studies
