#include "report/svg_plot.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "report/svg_frame.h"
#include "report/svg_text.h"
#include "report_markup.h"

namespace osteon::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Ticks, StepsAre1Or2Or5TimesAPowerOfTenAndTicksAreWithinTheRange) {
  for (const double size : {1e-6, 0.03, 0.7, 1.0, 9.9, 123.0, 4.7e6}) {
    for (const double start : {-0.37, 0.0, 0.61}) {
      const Range range{start * size, (start + 1.0) * size};
      for (int most = 2; most <= 12; ++most) {
        const Ticks ticks = LinearTicks(range, most);
        ASSERT_LE(static_cast<int>(ticks.at.size()), most);
        ASSERT_EQ(ticks.at.size(), ticks.labels.size());
        if (ticks.at.size() < 2) continue;
        const double step = ticks.at[1] - ticks.at[0];
        const double leading = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
        EXPECT_TRUE(std::abs(leading - 1) < 1e-6 || std::abs(leading - 2) < 1e-6 ||
                    std::abs(leading - 5) < 1e-6)
            << step;
        EXPECT_GE(ticks.at.front(), range.min - 1e-6 * size);
        EXPECT_LE(ticks.at.back(), range.max + 1e-6 * size);
        // different marks have different texts
        for (std::size_t i = 1; i < ticks.labels.size(); ++i) EXPECT_NE(ticks.labels[i - 1], ticks.labels[i]);
      }
    }
  }
}

// The bytes E2 88 92 are the minus sign U+2212.
TEST(Ticks, LabelsOfThreeKnownAxesAreAsExpected) {
  const Ticks ticks = LinearTicks({0.0, 10.0}, 6);
  EXPECT_EQ(ticks.labels, (std::vector<std::string>{"0", "2", "4", "6", "8", "10"}));
  const Ticks across_zero = LinearTicks({-0.1, 0.1}, 5);
  EXPECT_EQ(across_zero.labels, (std::vector<std::string>{"\xE2\x88\x92"
                                                          "0.10",
                                                          "\xE2\x88\x92"
                                                          "0.05",
                                                          "0.00", "0.05", "0.10"}));
  const Ticks decades = LogTicks({0.5, 2000.0}, 4);
  std::vector<std::string> shown;
  for (const std::string& label : decades.labels)
    if (!label.empty()) shown.push_back(label);
  EXPECT_EQ(shown, (std::vector<std::string>{"1", "10", "100", "1000"}));
}

TEST(Ticks, RangesWithoutWidthOrFiniteEndsHaveNoTicks) {
  EXPECT_TRUE(LinearTicks({1.0, 1.0}, 5).at.empty());
  EXPECT_TRUE(LinearTicks({kNaN, 1.0}, 5).at.empty());
  EXPECT_TRUE(LinearTicks({0.0, kInf}, 5).at.empty());
  EXPECT_TRUE(LinearTicks({2.0, 1.0}, 5).at.empty());
  EXPECT_TRUE(LogTicks({0.0, 1.0}, 5).at.empty());
  const Range widened = NiceRange({3.0, 3.0}, 5);
  EXPECT_LT(widened.min, 3.0);
  EXPECT_GT(widened.max, 3.0);
}

TEST(Decimation, KeepsSinglePeaksAndTheOrderOfSamples) {
  // 10 s at 1 kHz with one sample's spike up and one down
  std::vector<double> x, y;
  for (int i = 0; i < 10'000; ++i) {
    x.push_back(1e-3 * i);
    y.push_back(std::sin(0.01 * i));
  }
  y[4321] = 50.0;
  y[8765] = -50.0;
  const auto runs = DecimateMinMax(x, y, {0.0, 10.0}, 800);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_LE(runs[0].size(), 4u * 800u);
  double min_y = 0.0, max_y = 0.0, last_x = -1.0;
  for (const PlotPoint& point : runs[0]) {
    EXPECT_GT(point.x, last_x);
    last_x = point.x;
    min_y = std::min(min_y, point.y);
    max_y = std::max(max_y, point.y);
  }
  EXPECT_EQ(max_y, 50.0);
  EXPECT_EQ(min_y, -50.0);
  EXPECT_EQ(runs[0].front().x, x.front());
  EXPECT_EQ(runs[0].back().x, x.back());
}

TEST(Decimation, NotFiniteValuesLeaveGaps) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5}, y{1, 2, kNaN, 4, kInf, 6};
  const auto runs = DecimateMinMax(x, y, {0.0, 5.0}, 100);
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].size(), 2u);
  EXPECT_EQ(runs[1].size(), 1u);
}

// The bytes EF BF BD are U+FFFD, which replaces each byte that is not valid.
TEST(Text, IsEscapedAndAlwaysUtf8) {
  EXPECT_EQ(Escape("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(Escape("µ"), "µ");
  EXPECT_EQ(Escape("\xB5m"), "\xEF\xBF\xBDm") << "Latin-1";
  EXPECT_EQ(Escape("\xC0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD") << "overlong zero";
  EXPECT_EQ(Escape("\xED\xA0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD") << "surrogate";
  EXPECT_EQ(Escape("\xE2\x82"), "\xEF\xBF\xBD\xEF\xBF\xBD") << "cut short";
  EXPECT_EQ(Escape(std::string_view("a\0b\x1b", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(Escape("tab\tand\nline"), "tab\tand\nline");
}

// The bytes E2 80 89 are a thin space, which groups thousands from five digits on.
TEST(Text, NumbersAreGroupedRoundedAndWithoutNegativeZero) {
  EXPECT_EQ(Number(12345.6, 1),
            "12\xE2\x80\x89"
            "345.6");
  EXPECT_EQ(Number(1234567.0, 0),
            "1\xE2\x80\x89"
            "234\xE2\x80\x89"
            "567");
  EXPECT_EQ(Number(1234.0, 0), "1234");
  EXPECT_EQ(Number(-0.0001, 2), "0.00") << "no negative zero";
  EXPECT_EQ(Number(kNaN, 2), "n/a");
  EXPECT_EQ(Number(0.01234), "0.0123");
  EXPECT_EQ(Number(123.4), "123");
  EXPECT_EQ(Pixels(kNaN), "0");
  EXPECT_EQ(Pixels(-0.01), "0");
}

TEST(Text, ATextIsShortenedToItsWidthAtWholeCharacters) {
  const std::string text = "a very long name of a series with µ and Ω";
  for (double width = 20.0; width < 400.0; width += 7.0) {
    const std::string fitted = Fit(text, width);
    EXPECT_LE(TextWidth(fitted, kFontPx), std::max(width, kFontPx));
    EXPECT_EQ(Escape(fitted).find("\xEF\xBF\xBD"), std::string::npos) << "cut within a character";
  }
}

// Two curves with gaps, a limit, and two spans of which one is too narrow for its name.
LineChart Example() {
  LineChart chart{.title = "Title & <more>",
                  .x_label = "time [s]",
                  .y_label = "force [N]",
                  .series = {{.name = "a", .x = {0, 1, 2, 3}, .y = {0, 50, kNaN, 120}},
                             {.name = "b", .x = {0, 1, 2, 3}, .y = {kInf, 10, 20, -kInf}}},
                  .limits = {{200.0, "limit 200 N"}},
                  .spans = {{0.0, 0.01, "short", "#eeeeee"}, {1.0, 3.0, "long enough", "#eeeeee"}}};
  return chart;
}

TEST(LineChart, IsWellFormedAndWithoutNaN) {
  const std::string svg = Svg(Example());
  EXPECT_EQ(MarkupError(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("Title &amp; &lt;more&gt;"), std::string::npos);
  EXPECT_NE(svg.find(">short<"), std::string::npos) << "a span too narrow for its name goes into the legend";
}

TEST(LineChart, TextStaysInsideTheDrawing) {
  for (const double width : {320.0, 450.0, 920.0}) {
    LineChart chart = Example();
    chart.limits = {{200.0, "limit 200 N"}, {198.0, "another limit"}, {196.0, "a third"}};
    for (int i = 0; i < 8; ++i)
      chart.series.push_back({.name = "one more series with a long name", .x = {0, 1}, .y = {1e6, 2e6}});
    EXPECT_EQ(TextOutside(Svg(chart, width)), "") << width;
  }
}

TEST(LineChart, DrawsAPeakAtItsPlace) {
  LineChart chart{.x_label = "x", .y_label = "y", .x = Range{0, 10}, .y = Range{0, 100}, .series = {{}}};
  for (int i = 0; i <= 10'000; ++i) {
    chart.series[0].x.push_back(1e-3 * i);
    chart.series[0].y.push_back(i == 5000 ? 100.0 : 0.0);
  }
  const std::string svg = Svg(chart);
  EXPECT_LT(svg.size(), 120'000u);
  // the value y = 100 must lie at the top of the plot's area, at the grid's topmost line
  const auto path = AttributeOf(svg, "path", "d");
  const auto grid = AttributeOf(svg, "line", "y1");
  EXPECT_NE(path.find(" " + grid + "L"), std::string::npos) << path.substr(0, 200) << " … " << grid;
}

TEST(LineChart, AChartWithoutDataIsValidAndSaysSo) {
  const std::string svg =
      Svg(LineChart{.title = "t", .x_label = "x", .y_label = "y", .series = {{.name = "s"}}});
  EXPECT_EQ(MarkupError(svg), "");
  EXPECT_NE(svg.find("no data"), std::string::npos);
  EXPECT_EQ(MarkupError(Svg(std::span<const LineChart>{})), "");
}

TEST(Histogram, LeavesOutValuesThatAreNotFiniteAndStaysValid) {
  Histogram histogram{.title = "h", .x_label = "t [µs]", .log_x = true, .log_y = true, .unit = "µs"};
  for (int i = 0; i < 5000; ++i) histogram.values.push_back(10.0 + i % 50);
  histogram.values.insert(histogram.values.end(), {5000.0, 0.0, -3.0, kNaN, kInf});
  const std::string svg = Svg(histogram);
  EXPECT_EQ(MarkupError(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(TextOutside(svg), "");
  EXPECT_NE(svg.find("max 5000 µs"), std::string::npos);
  EXPECT_EQ(MarkupError(Svg(Histogram{.title = "none"})), "");
  EXPECT_EQ(MarkupError(Svg(Histogram{.title = "same", .values = {3.0, 3.0, 3.0}})), "");
  EXPECT_EQ(MarkupError(Svg(Histogram{.title = "same", .values = {3.0, 3.0, 3.0}, .log_x = true})), "");
}

// On logarithmic axes equal ratios have equal lengths. The value -1, which has no logarithm, is left out.
TEST(SvgPlot, LogarithmicAxesKeepRatios) {
  LineChart chart{.title = "t", .x_label = "x", .y_label = "y", .log_x = true, .log_y = true};
  chart.series.push_back({.name = "s", .x = {-1.0, 1.0, 10.0, 100.0}, .y = {1.0, 0.001, 0.01, 0.1}});
  const std::string svg = Svg(chart);
  const std::size_t at = svg.find("<path d=\"M");
  ASSERT_NE(at, std::string::npos);
  double x[3]{}, y[3]{};
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "<path d=\"M%lf %lfL%lf %lfL%lf %lf\"", &x[0], &y[0], &x[1], &y[1],
                        &x[2], &y[2]),
            6);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.11);  // coordinates are rounded to 0.1 px
  EXPECT_NEAR(y[1] - y[0], y[2] - y[1], 0.11);
  EXPECT_GT(x[1] - x[0], 100.0);
}

// The page's script needs these attributes to zoom and move a plot; it clips the curves to the inner <svg>.
TEST(SvgPlot, AZoomablePlotHasItsAreaAndRangesAsAttributes) {
  LineChart chart{
      .title = "force", .y_label = "force [N]", .series = {{.x = {0.0, 1.0, 4.0}, .y = {0.0, 50.0, 100.0}}}};
  EXPECT_EQ(Svg(chart).find("class=\"panel\""), std::string::npos);
  chart.zooms = true;
  const std::string svg = Svg(chart);
  EXPECT_EQ(MarkupError(svg), "");
  EXPECT_EQ(TextOutside(svg), "");
  EXPECT_EQ(AttributeOf(svg, "g", "data-x"), "0 4");
  EXPECT_EQ(AttributeOf(svg, "g", "data-y"), "0 100");
  const std::string inner = svg.substr(svg.find("<svg class=\"data\""));
  EXPECT_EQ(AttributeOf(inner, "svg", "viewBox"), AttributeOf(svg, "g", "data-area"));
  EXPECT_EQ(AttributeOf(inner, "path", "vector-effect"), "non-scaling-stroke");
}

}  // namespace
}  // namespace osteon::report
