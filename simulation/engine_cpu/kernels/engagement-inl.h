// Pass 3: area of the cutting surface that lies in bone, from the mass points in a layer at this surface.
#if defined(OSTEON_CPU_ENGAGEMENT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_ENGAGEMENT_INL_H
#undef OSTEON_CPU_ENGAGEMENT_INL_H
#else
#define OSTEON_CPU_ENGAGEMENT_INL_H
#endif

#include <cmath>

#include "simulation/engine_cpu/kernels/rows-inl.h"
#include "simulation/engine_cpu/rounding.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Collects the points that may be engaged, each with its nearest cutting ball, and adds up their areas with
// the same bits as ReferenceEngine::MeasureEngagement.
class EngagedPoints {
 public:
  explicit EngagedPoints(EngagementPass& pass) : e_(pass) {}
  // Adds the points of those lanes of a block that may be engaged. @param tools  nearest cutting ball of each
  // point
  HWY_INLINE void Add(std::uint32_t block, const F3& p, const U8& tools, const MF& lanes) {
    if (count_ > kChunk - kLanes) AddUp();
    const std::uint32_t i = count_;
    Pack(x_ + i, p.x, lanes), Pack(y_ + i, p.y, lanes), Pack(z_ + i, p.z, lanes);
    Pack(place_ + i, LaneNumbers(block * kAreaStride), lanes);
    count_ += static_cast<std::uint32_t>(Pack(tool_ + i, tools, lanes));
  }
  // Adds the collected points to the pass's results, and empties the collection.
  void AddUp();

 private:
  static constexpr std::uint32_t kChunk = 256;  // number of points that are measured together
  // distance in memory from one block's areas to the next block's [doubles]
  static constexpr std::uint32_t kAreaStride = sizeof(PointBlock) / sizeof(double);
  void Measure(std::uint32_t i, bool one_tool);

  EngagementPass& e_;
  std::uint32_t count_{0};
  alignas(64) float x_[kChunk + kLanes], y_[kChunk + kLanes], z_[kChunk + kLanes];
  alignas(64) double area_m2_[kChunk + kLanes], moment_m3_[kChunk + kLanes];
  std::uint32_t place_[kChunk + kLanes];  // offset of the point's area from the first block's areas [doubles]
  std::uint32_t tool_[kChunk + kLanes];
};

// Computes area and moment of eight points; both are zero for a point that is not engaged, which changes no
// sum.
HWY_INLINE void EngagedPoints::Measure(std::uint32_t i, bool one_tool) {
  const D3 p = Metres({Load(x_ + i), Load(y_ + i), Load(z_ + i)});
  const std::uint32_t* t = tool_ + i;
  const D3 at =
      one_tool ? ExactlyAt(e_.at, t[0]) : D3{Gather(e_.at.x, t), Gather(e_.at.y, t), Gather(e_.at.z, t)};
  const D8 R = one_tool ? D(e_.tool.r[t[0]]) : Gather(e_.tool.r, t), zero = D(0.0);
  const D3 out = p - at;
  const D8 d = Sqrt(Dot(out, out)), gap = d - R;
  const D8 along = Negative(Dot(D3{D(e_.n[0]), D(e_.n[1]), D(e_.n[2])}, out));
  const D8 projection = Select((Abs(gap) < D(e_.layer_m)) & (d > zero), along / d, zero);
  const MD counts = projection > zero;
  const D8 area = Gather(e_.points->area_m2, place_ + i) * projection;
  const D3 q = p - D3{D(e_.origin[0]), D(e_.origin[1]), D(e_.origin[2])};
  const D8 ax = D(e_.axis[0]), ay = D(e_.axis[1]), az = D(e_.axis[2]);
  const D3 cross{q.y * az - q.z * ay, q.z * ax - q.x * az, q.x * ay - q.y * ax};
  Store(area_m2_ + i, Select(counts, area, zero));
  Store(moment_m3_ + i, Select(counts, area * Sqrt(Dot(cross, cross)), zero));
}

// Adds up the points one after the other, because the bits of a sum depend on the order.
inline void EngagedPoints::AddUp() {
  if (count_ == 0) return;
  Store(place_ + count_, U(place_[0])), Store(tool_ + count_, U(tool_[0]));
  bool one_tool = true;
  for (std::uint32_t i = 0; i < count_; i += kLanes)
    one_tool = one_tool && Bits(Load(tool_ + i) == U(tool_[0])) == 0xffu;
  for (std::uint32_t i = 0; i < count_; i += kLanes) Measure(i, one_tool);
  double area = e_.area_m2, moment = e_.moment_m3;
  for (std::uint32_t i = 0; i < count_; ++i) area += area_m2_[i], moment += moment_m3_[i];
  e_.area_m2 = area, e_.moment_m3 = moment;
  count_ = 0;
}

// Finds in doubles the nearest cutting ball of one point. Called if floats cannot decide which ball is
// nearest.
// @returns -1 if no ball is within the layer
inline std::int32_t ExactlyNearest(const EngagementPass& e, const PointBlock& block, unsigned k,
                                   std::uint32_t b) {
  const double x = 1e-3 * block.x[k], y = 1e-3 * block.y[k], z = 1e-3 * block.z[k];
  double nearest = e.layer_m;
  std::int32_t nearest_ball = -1;
  for (std::uint32_t row = e.rows.first[b]; row < e.rows.first[b + 1]; ++row) {
    const unsigned t = e.rows.tool[row];
    if (e.tool.cutting[t] == 0) continue;
    const double ox = x - e.at.x[t], oy = y - e.at.y[t], oz = z - e.at.z[t];
    const double gap = std::sqrt((ox * ox + oy * oy) + oz * oz) - e.tool.r[t];
    if (std::abs(gap) >= e.layer_m || gap >= nearest) continue;
    nearest = gap, nearest_ball = static_cast<std::int32_t>(t);
  }
  return nearest_ball;
}

// Whether the tool's surface at a point may face the bone: -n · out > 0, with n the contact normal and out
// the vector from the tool ball's centre to the point. False only if floats are certain. The product's error
// is the error of the tool ball's place, plus a few u |out| for n, products and sums (u = 2^-24).
HWY_INLINE MF MayFace(const EngagementPass& e, const F3& out, const F8& distance) {
  const F3 n{F(static_cast<float>(e.n[0])), F(static_cast<float>(e.n[1])), F(static_cast<float>(e.n[2]))};
  return Dot(n, out) < MulAdd(distance, F(kDirectionRounding), F(e.rounding_mm));
}

// Examines a block with one row: all its points have the same tool ball.
HWY_INLINE void EngageOneRow(const EngagementPass& e, std::uint32_t b, EngagedPoints& engaged) {
  const PointBlock& block = e.points[e.rows.block[b]];
  const std::uint32_t row = e.rows.first[b];
  const unsigned t = e.rows.tool[row];
  const F3 p = CentersOf(block), out = p - At(e.at, t);
  const F8 d = Sqrt(Dot(out, out)), gap = d - F(e.tool.r_mm[t]);
  e.rows.bound[row] = e.rows.block_bound[b] = Least(gap) + e.displacement_mm - e.rounding_mm;
  const MF candidates = (Abs(gap) < F(e.layer_mm + e.rounding_mm)) & MayFace(e, out, d);
  if (Bits(candidates) != 0) engaged.Add(e.rows.block[b], p, U(t), candidates);
}

// Examines a block with several rows. Floats find each point's nearest tool ball; doubles decide if two balls
// are nearly equally near, or if the point is too close to the layer's inner border.
HWY_INLINE void EngageRows(const EngagementPass& e, std::uint32_t b, float limit, EngagedPoints& engaged) {
  const PointBlock& block = e.points[e.rows.block[b]];
  const F3 p = CentersOf(block);
  const F8 none = F(e.layer_mm + e.rounding_mm), deepest = Negative(none);
  F8 nearest = none, next = none, nearest_ball = F(0.0f);
  std::uint32_t row = 0;
  for (BoundCursor rows = RowsOf(e.rows, b); rows.Next(limit, row);) {
    const unsigned t = e.rows.tool[row];
    if (e.tool.cutting[t] == 0) continue;
    const F3 out = p - At(e.at, t);
    const F8 gap = Sqrt(Dot(out, out)) - F(e.tool.r_mm[t]);
    e.rows.bound[row] = Least(gap) + e.displacement_mm - e.rounding_mm;
    const F8 within = Select(gap > deepest, gap, none);
    nearest_ball = Select(within < nearest, F(static_cast<float>(t)), nearest_ball);
    next = Min(next, Max(within, nearest));
    nearest = Min(nearest, within);
  }
  UpdateBlockBound(e.rows, b);
  unsigned candidates = Bits(nearest < none);
  if (candidates == 0) return;
  const F8 slack = F(2.0f * e.rounding_mm);
  unsigned unsure = Bits((next - nearest < slack) | (nearest < deepest + slack)) & candidates;
  float which[8];
  Store(which, nearest_ball);
  std::uint32_t tools[8];
  for (unsigned k = 0; k < 8; ++k) tools[k] = static_cast<std::uint32_t>(which[k]);
  for (; unsure != 0; unsure &= unsure - 1) {
    const unsigned k = Lowest(unsure);
    const std::int32_t exact = ExactlyNearest(e, block, k, b);
    if (exact >= 0)
      tools[k] = static_cast<std::uint32_t>(exact);
    else
      candidates &= ~(1u << k);
  }
  engaged.Add(e.rows.block[b], p, Load(tools), MaskF(candidates));
}

// Does ReferenceEngine::MeasureEngagement for the points of one material, with the same bits as result.
inline void MeasureEngagement(EngagementPass& pass) {
  // copy the data, so that they stay in registers: the compiler assumes that stores of vectors may change
  // `pass`
  const EngagementPass e = pass;
  EngagedPoints engaged(pass);
  const float limit = LimitOf(e.every_row, e.displacement_mm + e.layer_mm + e.rounding_mm);
  std::uint32_t b = 0;
  for (BoundCursor blocks = BlocksOf(e.rows); blocks.Next(limit, b);) {
    PrefetchAhead(e.rows, e.points, b);
    if (e.rows.first[b + 1] == e.rows.first[b] + 1 && e.tool.cutting[e.rows.tool[e.rows.first[b]]] != 0)
      EngageOneRow(e, b, engaged);
    else
      EngageRows(e, b, limit, engaged);
  }
  engaged.AddUp();
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
