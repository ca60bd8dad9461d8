// Pass 3: area of the cutting surface that lies in bone, from the mass points within a layer of it.
#if defined(OSTEON_CPU_ENGAGEMENT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_ENGAGEMENT_INL_H
#undef OSTEON_CPU_ENGAGEMENT_INL_H
#else
#define OSTEON_CPU_ENGAGEMENT_INL_H
#endif

#include <cmath>

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Adds eight points, each with its nearest cutting ball: ReferenceEngine::MeasureEngagement, to the same
// bits.
HWY_INLINE void AddEngaged(EngagementPass& e, const PointBlock& block, const D3& p, const D3& at, const D8& R,
                           unsigned candidates) {
  const D3 out = p - at;
  const D8 d = Sqrt(Dot(out, out)), gap = d - R, zero = D(0.0);
  const MD in = Abs(gap) < D(e.layer_m);
  if ((Bits(in) & candidates) == 0) return;
  const D8 along = Negative(Dot(D3{D(e.n[0]), D(e.n[1]), D(e.n[2])}, out));
  const D8 projection = Select(in & (d > zero), along / d, zero);
  const unsigned counts = Bits(projection > zero) & candidates;
  if (counts == 0) return;
  const D8 area = Load(block.area_m2) * projection;
  const D3 q = p - D3{D(e.origin[0]), D(e.origin[1]), D(e.origin[2])};
  const D8 ax = D(e.axis[0]), ay = D(e.axis[1]), az = D(e.axis[2]);
  const D3 cross{q.y * az - q.z * ay, q.z * ax - q.x * az, q.x * ay - q.y * ax};
  const D8 moment = area * Sqrt(Dot(cross, cross));
  // one after the other: the sums' bits hang on the order; a zero changes none
  double areas[8], moments[8], a = e.area_m2, m = e.moment_m3;
  Store(areas, Select(MaskD(counts), area, zero)), Store(moments, Select(MaskD(counts), moment, zero));
  for (int k = 0; k < 8; ++k) a += areas[k], m += moments[k];
  e.area_m2 = a, e.moment_m3 = m;
}

// The nearest tool ball of one point where floats do not tell; -1: none within the layer.
inline std::int32_t ExactlyNearest(const EngagementPass& e, const PointBlock& block, unsigned k,
                                   std::uint32_t b) {
  const double x = 1e-3 * block.x[k], y = 1e-3 * block.y[k], z = 1e-3 * block.z[k];
  double nearest = e.layer_m;
  std::int32_t of = -1;
  for (std::uint32_t row = e.rows.first[b]; row < e.rows.first[b + 1]; ++row) {
    const unsigned t = e.rows.tool[row];
    if (e.tool.cutting[t] == 0) continue;
    const double ox = x - e.at.x[t], oy = y - e.at.y[t], oz = z - e.at.z[t];
    const double gap = std::sqrt((ox * ox + oy * oy) + oz * oz) - e.tool.r[t];
    if (std::abs(gap) >= e.layer_m || gap >= nearest) continue;
    nearest = gap, of = static_cast<std::int32_t>(t);
  }
  return of;
}

// A block with one row: its points have one tool ball.
HWY_INLINE void EngageOneRow(EngagementPass& e, std::uint32_t b) {
  const PointBlock& block = e.points[e.rows.block[b]];
  const std::uint32_t row = e.rows.first[b];
  const unsigned t = e.rows.tool[row];
  const F3 p = CentersOf(block), out = p - At(e.at, t);
  const F8 gap = Sqrt(Dot(out, out)) - F(e.tool.r_mm[t]);
  e.rows.bound[row] = e.rows.block_bound[b] = Least(gap) + e.displacement_mm - e.rounding_mm;
  const unsigned candidates = Bits(Abs(gap) < F(e.layer_mm + e.rounding_mm));
  if (candidates != 0) AddEngaged(e, block, Metres(p), ExactlyAt(e.at, t), D(e.tool.r[t]), candidates);
}

// Floats find each point's nearest tool ball, and where the next one is too near to tell, or the layer's
// inner border, doubles decide.
HWY_INLINE void EngageRows(EngagementPass& e, std::uint32_t b, float limit) {
  const PointBlock& block = e.points[e.rows.block[b]];
  const F3 p = CentersOf(block);
  const F8 none = F(e.layer_mm + e.rounding_mm), deepest = Negative(none);
  F8 nearest = none, next = none, of = F(0.0f);
  std::uint32_t row = 0;
  for (BoundCursor rows = RowsOf(e.rows, b); rows.Next(limit, row);) {
    const unsigned t = e.rows.tool[row];
    if (e.tool.cutting[t] == 0) continue;
    const F3 out = p - At(e.at, t);
    const F8 gap = Sqrt(Dot(out, out)) - F(e.tool.r_mm[t]);
    e.rows.bound[row] = Least(gap) + e.displacement_mm - e.rounding_mm;
    const F8 within = Select(gap > deepest, gap, none);
    of = Select(within < nearest, F(static_cast<float>(t)), of);
    next = Min(next, Max(within, nearest));
    nearest = Min(nearest, within);
  }
  UpdateBlockBound(e.rows, b);
  unsigned candidates = Bits(nearest < none);
  if (candidates == 0) return;
  const F8 slack = F(2.0f * e.rounding_mm);
  unsigned unsure = Bits((next - nearest < slack) | (nearest < deepest + slack)) & candidates;
  float which[8];
  Store(which, of);
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
  AddEngaged(e, block, Metres(p), {Gather(e.at.x, tools), Gather(e.at.y, tools), Gather(e.at.z, tools)},
             Gather(e.tool.r, tools), candidates);
}

inline void MeasureEngagement(EngagementPass& e) {
  const float limit = LimitOf(e.every_row, e.displacement_mm + e.layer_mm + e.rounding_mm);
  std::uint32_t b = 0;
  for (BoundCursor blocks = BlocksOf(e.rows); blocks.Next(limit, b);) {
    if (e.rows.first[b + 1] == e.rows.first[b] + 1 && e.tool.cutting[e.rows.tool[e.rows.first[b]]] != 0)
      EngageOneRow(e, b);
    else
      EngageRows(e, b, limit);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
