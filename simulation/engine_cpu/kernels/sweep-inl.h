// Pass 3: what the cutting balls sweep.
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

// A piece of one tool ball's way, as ClosestOnSegment has it.
struct Segment {
  D3 a, m, end;  // end: a + m, which is not always the other end
  D8 mm;
  bool moves;
};
HWY_INLINE Segment SegmentOf(const Places& a, const Places& b, unsigned t) {
  const double x = b.x[t] - a.x[t], y = b.y[t] - a.y[t], z = b.z[t] - a.z[t], mm = (x * x + y * y) + z * z;
  const D3 none{D(0.0), D(0.0), D(0.0)};
  if (mm == 0.0) return {ExactlyAt(a, t), none, none, D(0.0), false};
  // a + 0 m: a zero may have another sign than in a
  return {{D(a.x[t] + 0.0 * x), D(a.y[t] + 0.0 * y), D(a.z[t] + 0.0 * z)},
          {D(x), D(y), D(z)},
          {D(a.x[t] + x), D(a.y[t] + y), D(a.z[t] + z)},
          D(mm),
          true};
}
// From the segment's closest point to p, to the bits of p - ClosestOnSegment(p, a, b). Most points lie before
// or past a way of micrometres: the closest point is a + 0 m or a + 1 m then.
HWY_INLINE D3 AwayFrom(const Segment& s, const D3& p) {
  const D3 out = p - s.a;
  if (!s.moves) return out;
  const D8 along = Dot(out, s.m);
  const MD past = along >= s.mm, before = along <= D(0.0);
  if (Bits(past | before) == 0xffu) {
    const D3 behind = p - s.end;
    return {Select(past, behind.x, out.x), Select(past, behind.y, out.y), Select(past, behind.z, out.z)};
  }
  const D8 share = Select(past, D(1.0), Select(before, D(0.0), along / s.mm));
  return p - D3{s.a.x + share * s.m.x, s.a.y + share * s.m.y, s.a.z + share * s.m.z};
}

HWY_INLINE bool Cuts(const SweepView& s, unsigned t) {
  return s.tool.cutting[t] != 0 && (s.only < 0 || s.only == static_cast<std::int32_t>(t));
}
// Every place on a ball's way is within way_mm of where it begins: farther than that from there, nothing is
// swept.
HWY_INLINE float ReachOf(const SweepView& s) { return s.way_mm + s.rounding_mm; }
HWY_INLINE float SweepLimit(const SweepView& s) {
  return LimitOf(s.every_row, s.displacement_mm + ReachOf(s));
}
HWY_INLINE F8 GapAtContact(const SweepView& s, unsigned t, const F3& center, const F8& r) {
  const F3 from = At(s.contact, t) - center;
  return Sqrt(Dot(from, from)) - F(s.tool.r_mm[t]) - r;
}

// Balls above a size that the sweep may touch: those that may have to be split.
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

// Points within the sweep, as ReferenceEngine::Remove clears them.
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
      const D3 u = AwayFrom(SegmentOf(s.contact, s.slid, t), place),
               v = AwayFrom(SegmentOf(s.slid, s.end, t), place);
      cleared |= near & Bits((Sqrt(Dot(u, u)) < R) | (Sqrt(Dot(v, v)) < R));
    }
    for (; cleared != 0; cleared &= cleared - 1) p.cleared[p.count++] = block * 8 + Lowest(cleared);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
