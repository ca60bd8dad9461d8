#include "simulation/surface/cell_vertex.h"

#include <cstdlib>

namespace osteon::surface {
namespace {

/// Two faces form no rim if the angle between them is below 10 degrees: sin² 10°.
constexpr float kMinSine2 = 0.03F;
/// A rim's point that lies at most this far outside the cell is moved onto the cell and used [voxels].
constexpr float kRimSlack = 0.25F;
/// Smallest squared gradient at which a Newton step is taken; it is about 1 near a smooth face.
constexpr float kMinGradient2 = 0.05F;

Vec3 ClampToCell(Vec3 p) {
  return {std::clamp(p.x, 0.0F, 1.0F), std::clamp(p.y, 0.0F, 1.0F), std::clamp(p.z, 0.0F, 1.0F)};
}

bool IsWithin(Vec3 p, float slack) {
  const float low = -slack, high = 1.0F + slack;
  return p.x > low && p.y > low && p.z > low && p.x < high && p.y < high && p.z < high;
}

/// Evaluates a linear model of the field at `place`. The field is linearised at the point of the cell nearest
/// to `place`.
FieldSample LinearAt(const CornerValues& corners, Vec3 place) {
  const Vec3 inside = ClampToCell(place);
  FieldSample sample = Interpolate(corners, inside);
  sample.value += Dot(sample.gradient, place - inside);
  return sample;
}

/// Moves `place` by the shortest step that takes both linear models to zero. Returns false if the faces are
/// nearly parallel.
bool StepOntoBoth(const CornerValues& solid, const CornerValues& swept, Vec3& place) {
  const FieldSample a = LinearAt(solid, place), b = LinearAt(swept, place);
  const float aa = Dot(a.gradient, a.gradient), ab = Dot(a.gradient, b.gradient),
              bb = Dot(b.gradient, b.gradient);
  const float det = aa * bb - ab * ab;
  if (!(det >= kMinSine2 * aa * bb) || det <= 0.0F) return false;
  // weights of the two gradients, whose combination is the shortest step
  const float weight_a = (a.value * bb - b.value * ab) / det, weight_b = (b.value * aa - a.value * ab) / det;
  place = place - (weight_a * a.gradient + weight_b * b.gradient);
  return true;
}

/// Moves `place` along `direction` to the middle of the line's part in the cell. Returns false, with `place`
/// unchanged, if the line misses the cell.
bool SlideIntoCell(Vec3& place, Vec3 direction) {
  constexpr float kFar = 4.0F, kParallel = 1e-6F;
  float from = -kFar, to = kFar;
  const std::array<float, 3> p{place.x, place.y, place.z}, d{direction.x, direction.y, direction.z};
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(d[i]) < kParallel) {
      if (p[i] < 0.0F || p[i] > 1.0F) return false;
      continue;
    }
    const float a = -p[i] / d[i], b = (1.0F - p[i]) / d[i];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (from > to) return false;
  place = place + 0.5F * (from + to) * direction;
  return true;
}

/// Central differences along one axis at the nodes `at` and `at` + step, interpolated with the weight w. The
/// unit is field steps per two nodes.
float LineDifference(const std::int16_t* field, int at, int step, float w) {
  return (1.0F - w) * static_cast<float>(field[at + step] - field[at - step]) +
         w * static_cast<float>(field[at + 2 * step] - field[at]);
}

/// One component of SmoothGradient: LineDifference along `step`, interpolated along the two other axes.
float AxisDifference(const std::int16_t* field, int at, int step, float w, int step1, float w1, int step2,
                     float w2) {
  const float a = LineDifference(field, at, step, w), b = LineDifference(field, at + step1, step, w);
  const float c = LineDifference(field, at + step2, step, w);
  const float d = LineDifference(field, at + step1 + step2, step, w);
  const float low = a + w1 * (b - a), high = c + w1 * (d - c);
  return low + w2 * (high - low);
}

}  // namespace

CornerValues CornersOf(const std::int16_t* field, int at) {
  CornerValues corners{};
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] = static_cast<float>(field[at + kCornerStep[k]]) * (1.0F / kStepsOfVoxel);
  return corners;
}

FieldSample Interpolate(const CornerValues& c, Vec3 p) {
  const float d0 = c[1] - c[0], d1 = c[3] - c[2], d2 = c[5] - c[4], d3 = c[7] - c[6];
  const float c00 = c[0] + p.x * d0, c10 = c[2] + p.x * d1, c01 = c[4] + p.x * d2, c11 = c[6] + p.x * d3;
  const float low = c00 + p.y * (c10 - c00), high = c01 + p.y * (c11 - c01);
  const float x_low = d0 + p.y * (d1 - d0), x_high = d2 + p.y * (d3 - d2);
  return {.value = low + p.z * (high - low),
          .gradient = {x_low + p.z * (x_high - x_low), (c10 - c00) + p.z * ((c11 - c01) - (c10 - c00)),
                       high - low}};
}

Vec3 SmoothGradient(const std::int16_t* field, int at, Vec3 p) {
  return {AxisDifference(field, at, 1, p.x, kRow, p.y, kLayer, p.z),
          AxisDifference(field, at, kRow, p.y, 1, p.x, kLayer, p.z),
          AxisDifference(field, at, kLayer, p.z, 1, p.x, kRow, p.y)};
}

EdgeCut CutEdge(float solid_low, float solid_high, float swept_low, float swept_high) {
  // positions for a field that does not cross the edge: beyond the outer end, so that the other field's
  // crossing is the first one
  constexpr float kBehind = 2.0F, kBefore = -1.0F;
  const bool low_inside = solid_low < 0.0F && swept_low < 0.0F;
  const auto crossing = [low_inside](float low, float high) {
    if ((low < 0.0F) != (high < 0.0F)) return low / (low - high);
    return low_inside ? kBehind : kBefore;
  };
  const float solid = crossing(solid_low, solid_high), swept = crossing(swept_low, swept_high);
  const bool by_swept = low_inside ? swept <= solid : swept >= solid;
  return {.t = by_swept ? swept : solid, .by_swept = by_swept};
}

Vec3 ProjectOnto(const CornerValues& corners, Vec3 place) {
  const FieldSample sample = Interpolate(corners, place);
  const float gradient2 = Dot(sample.gradient, sample.gradient);
  if (gradient2 < kMinGradient2) return place;
  return ClampToCell(place - (sample.value / gradient2) * sample.gradient);
}

bool FindRim(const CornerValues& solid, const CornerValues& swept, Vec3& place) {
  Vec3 rim = place;
  for (int i = 0; i < 3; ++i)
    if (!StepOntoBoth(solid, swept, rim)) return false;
  if (!IsWithin(rim, 0.0F)) {
    // The rim's nearest point is in another cell. Another point of the rim may still lie in this cell.
    const Vec3 along = Cross(LinearAt(solid, rim).gradient, LinearAt(swept, rim).gradient);
    if (SlideIntoCell(rim, along)) (void)StepOntoBoth(solid, swept, rim);
  }
  if (!IsWithin(rim, kRimSlack)) return false;
  place = ClampToCell(rim);
  return true;
}

}  // namespace osteon::surface
