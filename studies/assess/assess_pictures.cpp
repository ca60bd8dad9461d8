#include "studies/assess/assess_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "procedure/assessment/target_tissue.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::studies {
namespace {

using Color = std::array<std::uint8_t, 3>;

constexpr Color kAir{255, 255, 255}, kBone{222, 205, 176}, kRemoved{244, 240, 232}, kOver{213, 94, 0},
    kUnder{0, 114, 178}, kOutline{27, 31, 36}, kNoBone{228, 232, 236}, kTarget{216, 150, 150};
constexpr int kSlicePixels = 425;  // width and height of a slice's picture [pixels]
// The map of the deviation: cells along an edge, and pixels along a cell's edge.
constexpr int kMapCells = 108, kCellPixels = 3, kMapPixels = kMapCells * kCellPixels;

// Half the width of the region that a slice shows, in radii of the planned cavity. It is larger for an
// opening, which is deeper than it is wide.
double WindowRadii(procedure::PlanKind kind) { return kind == procedure::PlanKind::kCup ? 1.7 : 3.5; }

// For each pixel of a slice, row by row, whether it lies in one of the balls. The slice goes through
// origin_m, which is its middle, and spans the unit vectors `right` and `up`.
std::vector<bool> Filled(std::span<const simulation::Ball> balls, const Vector3& origin_m,
                         const Vector3& right, const Vector3& up, double pixel_m) {
  constexpr int size = kSlicePixels;
  std::vector<bool> filled(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const Vector3 normal = right.cross(up);
  const double half = 0.5 * size;
  for (const simulation::Ball& ball : balls) {
    // The slice cuts the ball in a circle: centre (x, y) and radius r in pixels.
    const Vector3 way_m = Vector3(ball.center_m) - origin_m;
    const double plane_distance_m = way_m.dot(normal),
                 radius2 = ball.radius_m * ball.radius_m - plane_distance_m * plane_distance_m;
    if (radius2 <= 0.0) continue;
    const double x = way_m.dot(right) / pixel_m + half, y = half - way_m.dot(up) / pixel_m;
    const double r = std::sqrt(radius2) / pixel_m;
    for (int row = std::max(0, static_cast<int>(y - r)); row < std::min<double>(size, y + r + 1.0); ++row)
      for (int column = std::max(0, static_cast<int>(x - r)); column < std::min<double>(size, x + r + 1.0);
           ++column)
        if (std::hypot(column + 0.5 - x, row + 0.5 - y) <= r)
          filled[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                 static_cast<std::size_t>(column)] = true;
  }
  return filled;
}

// The balls that were cut or removed, in their size before the cut. A session saves its bone's balls rounded,
// so a ball that differs only by rounding does not count as cut.
std::vector<simulation::Ball> TouchedBalls(const AssessedSession& session) {
  constexpr double kKept_mm = 1e-2;  // a ball that lost less of its radius counts as uncut
  std::vector<simulation::Ball> touched;
  for (std::size_t i = 0; i < session.bone.balls.size() && 4 * i + 3 < session.state.balls.size(); ++i)
    if (session.state.balls[4 * i + 3] < 1e3 * session.bone.balls[i].radius_m - kKept_mm)
      touched.push_back(session.bone.balls[i]);
  return touched;
}

// The target's tissue, as balls: one around each of its mass points, large enough to cover the point's
// volume.
std::vector<simulation::Ball> TargetPoints(const AssessedSession& session) {
  std::vector<simulation::Ball> balls;
  for (const simulation::MassPoint& point : session.bone.points)
    if (procedure::IsTarget(session.plan.plan, session.bone, point))
      balls.push_back({.center_m = point.p_m, .radius_m = 0.75 * std::cbrt(point.volume_m3)});
  return balls;
}

// The colour between a (share 0) and b (share 1).
Color Mix(const Color& a, const Color& b, double share) {
  Color mixed{};
  for (std::size_t i = 0; i < 3; ++i)
    mixed[i] = static_cast<std::uint8_t>(std::lround(a[i] + share * (b[i] - a[i])));
  return mixed;
}

// Appends a pixel.
void Put(report::Image& image, const Color& color) {
  image.rgb.insert(image.rgb.end(), color.begin(), color.end());
}

// A slice through the planned centre that spans the unit vectors `right` and `up`.
report::Image SliceImage(const AssessedSession& session, const Vector3& right, const Vector3& up) {
  const procedure::PlannedCavity cavity = session.plan.plan.cavity();
  constexpr int size = kSlicePixels;
  const double pixel_m = 2.0 * WindowRadii(session.plan.plan.kind) * cavity.opening_radius_m() / size;
  const std::vector<simulation::Ball> live = simulation::LiveBalls(session.state);
  const auto touched = Filled(TouchedBalls(session), cavity.centre_m, right, up, pixel_m),
             target = Filled(TargetPoints(session), cavity.centre_m, right, up, pixel_m),
             after = Filled(live, cavity.centre_m, right, up, pixel_m);
  report::Image image{.width = size, .height = size};
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const std::size_t at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column);
      const Vector3 p_m =
          cavity.centre_m + pixel_m * ((column + 0.5 - 0.5 * size) * right + (0.5 * size - row - 0.5) * up);
      const double outside_m = cavity.DistanceTo(p_m);
      const bool planned = outside_m < 0.0;
      if (std::abs(outside_m) < 0.75 * pixel_m)
        Put(image, kOutline);
      else if (after[at])
        Put(image, target[at] ? kTarget : planned ? kUnder : kBone);
      else if (touched[at])
        Put(image, planned || target[at] ? kRemoved : kOver);
      else
        Put(image, kAir);
    }
  return image;
}

// The map of a cup's deviation from the plan over the planned hemisphere.
report::Image DeviationImage(const AssessedSession& session) {
  const procedure::SurgicalPlan& plan = session.plan.plan;
  const Vector3& a = plan.axis_G;
  const Vector3 up = (plan.pelvis.superior - plan.pelvis.superior.dot(a) * a).normalized();
  const Vector3 right = up.cross(a);  // as seen when looking into the opening, against the axis
  std::vector<Vector3> directions;
  std::vector<std::array<int, 2>> cells;  // row and column
  const double half = 0.5 * kMapCells;
  for (int row = 0; row < kMapCells; ++row)
    for (int column = 0; column < kMapCells; ++column) {
      const double x = (column + 0.5 - half) / half, y = (half - row - 0.5) / half, r2 = x * x + y * y;
      if (r2 > 1.0) continue;
      // Lambert's equal-area map: the component of the direction along -a is 1 - r², r being the radius on
      // the map.
      const double across = std::sqrt(std::max(0.0, r2 * (2.0 - r2))), r = std::sqrt(r2);
      const Vector3 aside = r > 0.0 ? Vector3((x * right + y * up) / r) : Vector3::Zero();
      directions.push_back(across * aside - (1.0 - r2) * a);
      cells.push_back({row, column});
    }
  const std::vector<simulation::Ball> live = simulation::LiveBalls(session.state);
  const auto map = procedure::DeviationMap(plan, live, directions);
  report::Image image{.width = kMapPixels, .height = kMapPixels};
  image.rgb.assign(static_cast<std::size_t>(3 * kMapPixels * kMapPixels), 255);
  for (std::size_t i = 0; i < map.size(); ++i) {
    Color color = kNoBone;
    if (map[i]) {
      const double share = std::clamp(1e3 * *map[i] / DeviationScale_mm(plan.kind), -1.0, 1.0);
      color = Mix(kRemoved, share > 0.0 ? kOver : kUnder, std::abs(share));
    }
    for (int y = 0; y < kCellPixels; ++y)
      for (int x = 0; x < kCellPixels; ++x)
        std::ranges::copy(color, image.rgb.begin() + 3 * ((cells[i][0] * kCellPixels + y) * kMapPixels +
                                                          cells[i][1] * kCellPixels + x));
  }
  return image;
}

}  // namespace

double DeviationScale_mm(procedure::PlanKind kind) { return kind == procedure::PlanKind::kCup ? 2.0 : 0.5; }

std::vector<CavityPicture> CavityPictures(const AssessedSession& session) {
  const procedure::SurgicalPlan& plan = session.plan.plan;
  const procedure::PelvicFrame& frame = plan.pelvis;
  std::vector<CavityPicture> pictures;
  const auto add = [&](const std::string& caption, report::Image image) {
    pictures.push_back({.caption = caption, .image = std::move(image)});
  };
  if (plan.kind == procedure::PlanKind::kOpening) {
    add("Section along the axis: out of the opening is up, x to the right.",
        SliceImage(session, frame.lateral, frame.superior));
    add("Section along the axis: out of the opening is up, y to the right.",
        SliceImage(session, frame.anterior, frame.superior));
    add("Section across the axis at the planned end: x to the right, y up.",
        SliceImage(session, frame.lateral, frame.anterior));
    return pictures;
  }
  add("Coronal section through the planned centre: superior is up, lateral to the right.",
      SliceImage(session, frame.lateral, frame.superior));
  add("Axial section: anterior is up, lateral to the right.",
      SliceImage(session, frame.lateral, frame.anterior));
  add(fmt::format(
          "The planned hemisphere, seen into its opening, superior up: blue, bone stands {0:g} mm and "
          "more within the plan; orange, {0:g} mm and more beyond it; grey, no bone.",
          DeviationScale_mm(plan.kind)),
      DeviationImage(session));
  return pictures;
}

}  // namespace osteon::studies
