#include "report/point_marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "report/svg_text.h"

namespace osteon::report {
namespace {

constexpr double kLabelPx = 11.5;  // font size

// Makes a <path>. @param filled  true: filled, with a white edge; false: only lines
std::string Shape(std::string_view path, std::string_view color, double opacity, bool filled) {
  return fmt::format(R"(<path d="{}" fill="{}" stroke="{}" stroke-width="{}" opacity="{:.2f}"/>)"
                     "\n",
                     path, filled ? color : "none", filled ? "#ffffff" : color, filled ? 1.0 : 2.0, opacity);
}

}  // namespace

std::string DrawMarker(double x, double y, Marker marker, std::string_view color, double opacity) {
  // coordinates of a corner, from the marker's middle
  const auto at = [&](double dx, double dy) { return Pixels(x + dx) + " " + Pixels(y + dy); };
  switch (marker) {
    case Marker::kNone:
      return {};
    case Marker::kCircle:
      return fmt::format(
          R"(<circle cx="{}" cy="{}" r="4.4" fill="{}" stroke="#ffffff" stroke-width="1" opacity="{:.2f}"/>)"
          "\n",
          Pixels(x), Pixels(y), color, opacity);
    case Marker::kRing:
      return fmt::format(
          R"(<circle cx="{}" cy="{}" r="3.8" fill="#ffffff" stroke="{}" stroke-width="2" opacity="{:.2f}"/>)"
          "\n",
          Pixels(x), Pixels(y), color, opacity);
    case Marker::kSquare:
      return Shape(fmt::format("M{}L{}L{}L{}Z", at(-4, -4), at(4, -4), at(4, 4), at(-4, 4)), color, opacity,
                   true);
    case Marker::kTriangle:
      return Shape(fmt::format("M{}L{}L{}Z", at(0, -5.4), at(5, 3.8), at(-5, 3.8)), color, opacity, true);
    case Marker::kDiamond:
      return Shape(fmt::format("M{}L{}L{}L{}Z", at(0, -5.6), at(5.2, 0), at(0, 5.6), at(-5.2, 0)), color,
                   opacity, true);
    case Marker::kDown:
      return Shape(fmt::format("M{}L{}L{}Z", at(0, 5.4), at(5, -3.8), at(-5, -3.8)), color, opacity, true);
    case Marker::kOpenUp:
      return fmt::format(
          R"(<path d="M{}L{}L{}Z" fill="#ffffff" stroke="{}" stroke-width="1.8" opacity="{:.2f}"/>)"
          "\n",
          at(0, -5.8), at(5, 3.8), at(-5, 3.8), color, opacity);
    case Marker::kCross:
      return Shape(fmt::format("M{}L{}M{}L{}", at(-3.8, -3.8), at(3.8, 3.8), at(-3.8, 3.8), at(3.8, -3.8)),
                   color, opacity, false);
  }
  return {};
}

std::string DrawWhisker(double x, double y_low, double y_high, std::string_view color, double opacity) {
  return fmt::format(R"(<path d="M{0} {1}V{2}M{3} {1}H{4}M{3} {2}H{4}" fill="none" stroke="{5}" )"
                     R"(stroke-width="1.1" opacity="{6:.2f}"/>)"
                     "\n",
                     Pixels(x), Pixels(y_low), Pixels(y_high), Pixels(x - 3), Pixels(x + 3), color, opacity);
}

void LabelPlacer::Block(double left, double top, double width, double height) {
  taken_.push_back({left, top, left + width, top + height});
}

void LabelPlacer::BlockLine(double x1, double y1, double x2, double y2) {
  constexpr double kPiece = 4.0;  // distance between the rectangles along the line [px]
  const int pieces = std::max(1, static_cast<int>(std::hypot(x2 - x1, y2 - y1) / kPiece));
  for (int i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    Block(x1 + t * (x2 - x1) - 1.0, y1 + t * (y2 - y1) - 1.0, 2.0, 2.0);
  }
}

bool LabelPlacer::IsFree(const Box& box) const {
  if (box.left < area_.left + 2 || box.right > area_.left + area_.width - 2 || box.top < area_.top + 2 ||
      box.bottom > area_.top + area_.height - 2)
    return false;
  return std::ranges::none_of(taken_, [&box](const Box& other) {
    return box.left < other.right && other.left < box.right && box.top < other.bottom &&
           other.top < box.bottom;
  });
}

std::string LabelPlacer::Place(double x, double y, std::string_view text, std::string_view color, bool far) {
  const double width = TextWidth(text, kLabelPx), height = kLabelPx + 1.0;
  struct Place {
    double dx, dy;  // from the point to the text's middle
    bool line;      // draw a line from the point to the text
  };
  const double beside = 0.5 * width + 8.0;
  std::vector<Place> places{{beside, 0, false},        {-beside, 0, false},
                            {0, -13, false},           {0, 13, false},
                            {beside, -9, false},       {beside, 9, false},
                            {-beside, -9, false},      {-beside, 9, false},
                            {0.5 * width, -14, false}, {-0.5 * width, -14, false},
                            {0.5 * width, 14, false},  {-0.5 * width, 14, false}};
  if (far)
    for (const double out : {24.0, 36.0, 50.0})
      for (const double side : {1.0, -1.0})
        for (const double up : {-1.0, 1.0, 0.0})
          places.push_back({side * (0.5 * width + (up == 0.0 ? out : 0.5 * out)), up * out, true});
  for (const Place& place : places) {
    const double left = x + place.dx - 0.5 * width, top = y + place.dy - 0.5 * height;
    if (!IsFree({left, top, left + width, top + height})) continue;
    std::string svg;
    if (place.line) {
      const double end_x = std::clamp(x, left, left + width), end_y = std::clamp(y, top, top + height);
      svg += SvgLine(x, y, end_x, end_y, kAxisColor, 0.8);
      BlockLine(x, y, end_x, end_y);
    }
    Block(left, top, width, height);
    return svg + SvgText(left, top + height - 2.5, text, "start", color, kLabelPx);
  }
  return {};
}

}  // namespace osteon::report
