// Pass 3: finds the large balls and the points in the volume that the cutting balls sweep.
#if defined(OSTEON_CPU_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_SWEEP_INL_H
#undef OSTEON_CPU_SWEEP_INL_H
#else
#define OSTEON_CPU_SWEEP_INL_H
#endif

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// A straight piece of one tool ball's path, with the values that ClosestOnSegment computes from its ends a
// and b: m = b - a.
template <class V>
struct Segment {
  Three<V> a, m, end;  // end: a + m, which may differ from b by rounding
  V mm;                // m · m
  bool moves;
};
// Makes the straight path of tool ball t from its place in a to its place in b.
template <class V>
HWY_INLINE Segment<V> SegmentOf(const Places& a, const Places& b, unsigned t) {
  const auto all = [](double value) HWY_ATTR { return Make<V>::Of(value); };
  const double x = b.x[t] - a.x[t], y = b.y[t] - a.y[t], z = b.z[t] - a.z[t], mm = (x * x + y * y) + z * z;
  const Three<V> none{all(0.0), all(0.0), all(0.0)};
  if (mm == 0.0) return {{all(a.x[t]), all(a.y[t]), all(a.z[t])}, none, none, all(0.0), false};
  // a + 0 m, as in ClosestOnSegment: a coordinate of -0 may become +0
  return {{all(a.x[t] + 0.0 * x), all(a.y[t] + 0.0 * y), all(a.z[t] + 0.0 * z)},
          {all(x), all(y), all(z)},
          {all(a.x[t] + x), all(a.y[t] + y), all(a.z[t] + z)},
          all(mm),
          true};
}
// Returns the vector from the segment's closest point to p, with the bits of p - ClosestOnSegment(p, a, b).
// The paths are micrometres long, so most points lie before or past the path; the closest point is then a + 0
// m or a + 1 m.
template <class V>
HWY_INLINE Three<V> AwayFrom(const Segment<V>& s, const Three<V>& p) {
  const Three<V> out = p - s.a;
  if (!s.moves) return out;
  const V along = ExactDot(out, s.m), zero = Make<V>::Of(0.0), one = Make<V>::Of(1.0);
  const auto past = along >= s.mm, before = along <= zero;
  if (Bits(past | before) == (1u << Traits<V>::kSize) - 1u) {
    const Three<V> behind = p - s.end;
    return {Select(past, behind.x, out.x), Select(past, behind.y, out.y), Select(past, behind.z, out.z)};
  }
  const V share = Select(past, one, Select(before, zero, along / s.mm));
  return p - Three<V>{s.a.x + share * s.m.x, s.a.y + share * s.m.y, s.a.z + share * s.m.z};
}

// Whether tool ball t cuts in this sweep.
HWY_INLINE bool Cuts(const SweepView& s, unsigned t) {
  return s.tool.cutting[t] != 0 && (s.only < 0 || s.only == static_cast<std::int32_t>(t));
}
// Returns the largest gap to a cutting ball at first contact from which the sweep may still touch bone [mm].
// No tool ball moves farther than way_mm from its place at first contact.
HWY_INLINE float ReachOf(const SweepView& s) { return s.way_mm + s.rounding_mm; }
// Returns the limit for the rows' bounds: the sweep cannot touch a row with a larger bound.
HWY_INLINE float SweepLimit(const SweepView& s) {
  return LimitOf(s.every_row, s.displacement_mm + ReachOf(s));
}
// Computes the gaps [mm] between eight balls and tool ball t at first contact.
HWY_INLINE F8 GapAtContact(const SweepView& s, unsigned t, const F3& center, const F8& r) {
  const F3 from = At(s.contact, t) - center;
  return Sqrt(Dot(from, from)) - F(s.tool.r_mm[t]) - r;
}

// Finds the balls above a given size that the sweep may touch. They may have to be split.
inline void FindLargeBalls(LargeBallPass& p) {
  const float limit = SweepLimit(p.sweep);
  const F8 reach = F(ReachOf(p.sweep));
  std::uint32_t b = 0, row = 0;
  for (BoundCursor blocks = BlocksOf(p.rows); blocks.Next(limit, b);) {
    const std::uint32_t block = p.rows.block[b];
    if (block >= p.end_block) return;
    const F3 c = CentersOf(p.balls[block]);
    const F8 r = Load(p.balls[block].r);
    const MF large = r > F(p.larger_than_mm);
    if (Bits(large) == 0) continue;
    unsigned touched = 0;
    for (BoundCursor rows = RowsOf(p.rows, b); rows.Next(limit, row);) {
      const unsigned t = p.rows.tool[row];
      if (Cuts(p.sweep, t)) touched |= Bits(large & (GapAtContact(p.sweep, t, c, r) <= reach));
    }
    for (; touched != 0; touched &= touched - 1) p.ball[p.count++] = block * 8 + Lowest(touched);
  }
}

// Finds the points within the sweep: the same points as ReferenceEngine::Remove.
inline void FindCleared(ClearingPass& p) {
  const SweepView& s = p.sweep;
  const float limit = SweepLimit(s);
  const F8 reach = F(ReachOf(s));
  std::uint32_t b = 0, row = 0;
  for (BoundCursor blocks = BlocksOf(p.rows); blocks.Next(limit, b);) {
    const std::uint32_t block = p.rows.block[b];
    const F3 at = CentersOf(p.points[block]);
    unsigned cleared = 0;
    for (BoundCursor rows = RowsOf(p.rows, b); rows.Next(limit, row);) {
      const unsigned t = p.rows.tool[row];
      if (!Cuts(s, t)) continue;
      const unsigned near = Bits(GapAtContact(s, t, at, F(0.0f)) <= reach) & ~cleared;
      if (near == 0) continue;
      const D3 place = Metres(at);
      const D8 R = D(s.tool.r[t]);
      const D3 u = AwayFrom(SegmentOf<D8>(s.contact, s.slid, t), place),
               v = AwayFrom(SegmentOf<D8>(s.slid, s.end, t), place);
      cleared |= near & Bits((Sqrt(Dot(u, u)) < R) | (Sqrt(Dot(v, v)) < R));
    }
    for (; cleared != 0; cleared &= cleared - 1) p.cleared[p.count++] = block * 8 + Lowest(cleared);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
