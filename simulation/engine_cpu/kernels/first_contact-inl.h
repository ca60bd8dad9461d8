// Pass 1 and the slide: finds the fraction of the path at which the tool first meets a bone ball.
#if defined(OSTEON_CPU_FIRST_CONTACT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_FIRST_CONTACT_INL_H
#undef OSTEON_CPU_FIRST_CONTACT_INL_H
#else
#define OSTEON_CPU_FIRST_CONTACT_INL_H
#endif

#include <cmath>

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

constexpr double kNoContactFraction = 2.0;  // means: no contact on the path; real fractions are at most 1

// Does FirstContactFraction of cutting_math.h for one pair, with the same bits.
inline double PairContact(const ContactPass& p, std::uint32_t ball, std::uint32_t t) {
  const BallBlock& b = p.balls[ball / 8];
  const unsigned k = ball % 8;
  if (!(b.r[k] > 0.0f)) return kNoContactFraction;
  const double Dx = 1e-3 * b.x[k] - p.from.x[t], Dy = 1e-3 * b.y[k] - p.from.y[t],
               Dz = 1e-3 * b.z[k] - p.from.z[t];
  const double mx = p.to.x[t] - p.from.x[t], my = p.to.y[t] - p.from.y[t], mz = p.to.z[t] - p.from.z[t];
  const double R = p.tool.r[t] + 1e-3 * b.r[k] - p.tolerance_m;
  const double Dm = (Dx * mx + Dy * my) + Dz * mz;
  if (Dm <= 0.0) return kNoContactFraction;
  const double gap = ((Dx * Dx + Dy * Dy) + Dz * Dz) - R * R;
  if (gap <= 0.0) return 0.0;
  const double discriminant = Dm * Dm - ((mx * mx + my * my) + mz * mz) * gap;
  if (discriminant < 0.0) return kNoContactFraction;
  const double s = gap / (Dm + std::sqrt(discriminant));
  return s <= 1.0 ? s : kNoContactFraction;
}

// Returns the lanes whose bone balls the tool ball may meet before the fraction `first` of its path m. D is
// the vector from the tool ball to the bone ball at the path's start, d its length, R and r are the radii,
// and s is the fraction. The distance |D - s m| is a convex function of s, so it stays above its tangent at s
// = 0. It can reach R + r only if
//
//     gap d <= s (D·m)          with gap = d - R - r
//
// The error of gap is at most the tool ball's rounding error. The error of D·m is at most this rounding error
// times |m|, plus 5 u d |m| for m, products and sums (u = 2^-24). The margin 1e-5 d |m| covers the second
// term and the rounding of gap d.
HWY_INLINE unsigned MayMeet(const ContactPass& p, const BallBlock& b, unsigned t, double first) {
  const F3 from = CentersOf(b) - At(p.from, t);
  const F3 m{F(p.way_x_mm[t]), F(p.way_y_mm[t]), F(p.way_z_mm[t])};
  const F8 r = Load(b.r), d = Sqrt(Dot(from, from));
  const float rounding = p.tool.rounding_mm[t];
  const F8 gap = d - (F(p.tool.r_mm[t] - p.tolerance_mm + rounding) + r);
  const F8 along = MulAdd(F(1e-5f * p.longest_way_mm), d, Dot(from, m) + F(rounding * p.longest_way_mm));
  const F8 fraction = F(static_cast<float>(first) * 1.000001f);
  return Bits((r > F(0.0f)) & (gap * d < fraction * along) & (along > F(0.0f)));
}

// Returns the smallest fraction at which tool ball t meets a ball of the block, if it is below `first`; else
// `first`.
inline double BlockContact(const ContactPass& p, std::uint32_t block, std::uint32_t t, double first) {
  unsigned bits = MayMeet(p, p.balls[block], t, first);
  for (; bits != 0; bits &= bits - 1) {
    const double s = PairContact(p, block * 8 + Lowest(bits), t);
    first = s < first ? s : first;
  }
  return first;
}

// Returns the limit for the rows' bounds: rows with a larger bound cannot have a contact before the fraction
// `first`. The limit is the gap that the tool can close on its path up to `first`, plus the displacement
// since the list was built.
HWY_INLINE float ContactLimit(const ContactPass& p, double first) {
  const float fraction = static_cast<float>(first > 1.0 ? 1.0 : first) * 1.000001f;
  return LimitOf(p.every_row,
                 p.displacement_mm + fraction * p.longest_way_mm - p.tolerance_mm + p.rounding_mm);
}

// Does the search of BlockContact for all rows of the list. Each contact found lowers the limit for the
// remaining rows.
inline double FirstContact(const ContactPass& p, double first) {
  float limit = ContactLimit(p, first);
  std::uint32_t b = 0, row = 0;
  for (BoundCursor blocks = BlocksOf(p.rows); first > 0.0 && blocks.Next(limit, b);)
    for (BoundCursor rows = RowsOf(p.rows, b); rows.Next(limit, row);) {
      const double met = BlockContact(p, p.rows.block[b], p.rows.tool[row], first);
      if (met >= first) continue;
      first = met;
      limit = ContactLimit(p, first);
    }
  return first;
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
