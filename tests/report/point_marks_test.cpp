#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "report/pareto.h"
#include "report/point_marks.h"
#include "report/svg_plot.h"
#include "report/svg_raster.h"
#include "report_markup.h"

namespace osteon::report {
namespace {

std::size_t CountOccurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(ParetoFront, HoldsThePointsThatNoOtherPointBeats) {
  const std::vector<CostPoint> points{{1, 9}, {2, 5}, {3, 6}, {4, 1}, {2, 5}, {5, 1}, {0.5, HUGE_VAL}};
  EXPECT_EQ(OnParetoFront(points), (std::vector<bool>{true, true, false, true, true, false, false}));
  EXPECT_TRUE(OnParetoFront({}).empty());
}

// Three labelled points on logarithmic axes; the third is outside the range of x.
LineChart Points() {
  LineChart chart{.title = "t",
                  .x_label = "x",
                  .y_label = "y",
                  .x = Range{1, 1000},
                  .y = Range{1, 1000},
                  .log_x = true,
                  .log_y = true};
  chart.series.push_back({.name = "a",
                          .x = {10, 100, 5000},
                          .y = {10, 100, 100},
                          .marker = Marker::kCircle,
                          .y_low = {5, 90, 90},
                          .y_high = {20, 110, 110},
                          .labels = {"first", "second", "beyond"}});
  return chart;
}

TEST(PointMarks, AreDrawnOncePerPointWithinTheAxes) {
  const std::string svg = Svg(Points());
  EXPECT_EQ(CountOccurrences(svg, "<circle"), 2u + 1u);  // two points in the drawing, one in the legend
  EXPECT_EQ(CountOccurrences(svg, "first"), 1u);
  EXPECT_EQ(CountOccurrences(svg, "second"), 1u);
  EXPECT_EQ(CountOccurrences(svg, "beyond"), 0u);
}

// A staircase over three decades. On a linear axis most corners would share a pixel column and be dropped. On
// a logarithmic axis the corners are apart, and all of them must be drawn.
TEST(PointMarks, LinesOverLogarithmicAxesKeepTheirCorners) {
  LineChart chart = Points();
  chart.series = {{.x = {1.5, 2.0, 2.0, 3.0, 3.0, 900}, .y = {900, 900, 500, 500, 100, 100}}};
  const std::string svg = Svg(chart);
  const std::size_t begin = svg.find("<path d=\"M");
  ASSERT_NE(begin, std::string::npos);
  const std::string path = svg.substr(begin, svg.find("fill", begin) - begin);
  EXPECT_EQ(CountOccurrences(path, "L"), 5u) << path;
}

// Places the names of 40 clustered points. Names that have no room are left out; the others do not overlap.
TEST(LabelPlacer, NamesOfClusteredPointsDoNotOverlap) {
  const PlotArea area{.left = 0, .top = 0, .width = 200, .height = 100};
  LabelPlacer placer(area);
  std::vector<std::array<double, 2>> at;
  for (int i = 0; i < 40; ++i) {
    const std::string svg = placer.Place(100 + 3 * (i % 5), 50 + 2 * (i % 7), "name", "#000", false);
    if (svg.empty()) continue;
    double x = 0, y = 0;
    ASSERT_EQ(std::sscanf(svg.c_str(), "<text x=\"%lf\" y=\"%lf\"", &x, &y), 2) << svg;
    for (const auto& other : at) EXPECT_TRUE(std::abs(other[0] - x) > 20 || std::abs(other[1] - y) > 10) << i;
    at.push_back({x, y});
  }
  EXPECT_GE(at.size(), 4u);
  EXPECT_LT(at.size(), 40u);
  EXPECT_EQ(placer.Place(199, 99, std::string(60, 'm'), "#000", false), "");
}

TEST(SvgGrid, PutsPanelsBesideEachOther) {
  const std::array panels{Points(), Points(), Points()};
  const std::string svg =
      SvgGrid(panels, 2, "all", {{.text = "a", .color = "#123456", .marker = Marker::kSquare}}, 800);
  EXPECT_EQ(CountOccurrences(svg, "<g transform"), 3u);
  EXPECT_EQ(CountOccurrences(svg, ">second<"), 3u);
  const auto image = Rasterise(svg, 1.0);
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image->width, 800);
}

TEST(Rasterise, FillsARectangleWithItsColourAtTwiceTheSize) {
  const auto image =
      Rasterise(R"(<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10" viewBox="0 0 20 10">)"
                R"(<rect x="10" y="0" width="10" height="10" fill="#ff8000"/></svg>)",
                2.0);
  ASSERT_TRUE(image) << image.error();
  ASSERT_EQ(image->width, 40);
  ASSERT_EQ(image->height, 20);
  const auto pixel = [&](int x, int y) {
    const std::size_t at = 3 * static_cast<std::size_t>(y * image->width + x);
    return std::array{image->rgb[at], image->rgb[at + 1], image->rgb[at + 2]};
  };
  EXPECT_EQ(pixel(30, 10), (std::array<std::uint8_t, 3>{0xff, 0x80, 0x00}));
  EXPECT_EQ(pixel(5, 10), (std::array<std::uint8_t, 3>{0xff, 0xff, 0xff}));  // the background is white
}

TEST(Rasterise, RefusesTextThatIsNoSvgAndPicturesThatAreTooLarge) {
  EXPECT_FALSE(Rasterise("no svg at all"));
  EXPECT_FALSE(Rasterise(""));
  const std::string huge = R"(<svg xmlns="http://www.w3.org/2000/svg" width="100000" height="100000"></svg>)";
  ASSERT_FALSE(Rasterise(huge));
  EXPECT_NE(Rasterise(huge).error().find("100 million"), std::string::npos);
  EXPECT_FALSE(Rasterise(huge, 0.0));
}

}  // namespace
}  // namespace osteon::report
