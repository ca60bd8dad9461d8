// Pass 2, the nearest pair in each bin of direction: computes in doubles the few pairs that floats could not
// exclude.
#if defined(OSTEON_CPU_EXACT_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_EXACT_PAIRS_INL_H
#undef OSTEON_CPU_EXACT_PAIRS_INL_H
#else
#define OSTEON_CPU_EXACT_PAIRS_INL_H
#endif

#include <cmath>

#include "simulation/engine_cpu/kernels/divisor-inl.h"
#include "simulation/engine_cpu/kernels/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// The result of FindBin for eight directions: axis and sign give the cube's face, thirds give the bin on the
// face.
struct ExactBins {
  D8 cutting_off, shaft_off;  // 1 - cosine to the bin's centre, for cutting and for other balls
  unsigned x, y, negative, low1, high1, low2, high2;

  // Returns the bin's number for lane k. Balls that cut have nine bins for each face of the cube; then
  // follows one bin for each face for the other balls.
  HWY_INLINE unsigned Number(unsigned k, bool cutting) const {
    const auto at = [k](unsigned bits) { return bits >> k & 1u; };
    const unsigned axis = at(x) != 0 ? 0 : at(y) != 0 ? 1 : 2, face = 2 * axis + at(negative);
    if (!cutting) return 54 + face;
    const unsigned i = at(low1) != 0    ? 0
                       : at(high1) != 0 ? 2
                                        : 1,
                   j = at(low2) != 0    ? 0
                       : at(high2) != 0 ? 2
                                        : 1;
    return 9 * face + 3 * i + j;
  }
};
// Does FindBin of contact_law.h for eight directions u in T.
HWY_INLINE ExactBins FindExactBins(const D3& u) {
  const D8 size_x = Abs(u.x), size_y = Abs(u.y), size_z = Abs(u.z), zero = D(0.0), three = D(3.0);
  const MD x = (size_x >= size_y) & (size_x >= size_z), y = (!x) & (size_y >= size_z);
  const D8 main = Select(x, u.x, Select(y, u.y, u.z)), b = Select(x, u.y, Select(y, u.z, u.x)),
           c = Select(x, u.z, Select(y, u.x, u.y));
  const D8 edge = Abs(main), minus_edge = Negative(edge);
  const MD low1 = three * b < minus_edge, high1 = (!low1) & (three * b > edge);
  const MD low2 = three * c < minus_edge, high2 = (!low2) & (three * c > edge);
  // (i - 1) b + (j - 1) c, where i and j number the thirds from 0
  const D8 side =
      Select(low1, zero - b, Select(high1, b, zero)) + Select(low2, zero - c, Select(high2, c, zero));
  const D8 along = edge + D(2.0 / 3.0) * side;
  // length of the vector to a bin's centre; in `off` of the two directions on the face, the bin is an outer
  // third
  const auto length = [](int off) HWY_ATTR { return D(std::sqrt(1.0 + 4.0 / 9.0 * off)); };
  const MD off1 = low1 | high1, off2 = low2 | high2;
  const D8 middle = Select(off1 & off2, length(2), Select(off1 | off2, length(1), length(0)));
  return {D(1.0) - along / middle,
          D(1.0) - edge,
          Bits(x),
          Bits(y),
          Bits(main < zero),
          Bits(low1),
          Bits(high1),
          Bits(low2),
          Bits(high2)};
}

// Component of n along T's axis c, in the order in which Eigen adds the products.
HWY_INLINE D8 AlongAxis(const NearFieldPass& p, int c, const D3& n) {
  return (D(p.axes[3 * c]) * n.x + D(p.axes[3 * c + 1]) * n.y) + D(p.axes[3 * c + 2]) * n.z;
}

// Finds the nearest pair of each bin by FindBin and Nearer of contact_law.h, with the same bits.
inline void FindNearestPairs(NearFieldPass& p, std::size_t count) {
  for (std::size_t i = 0; i < count; i += 8) {
    const unsigned valid = FirstBits(count - i);
    const Pairs pairs = LoadPairs(p, p.near_place + i, p.near_tool + i, valid);
    const D8 d = Sqrt(Dot(pairs.from_bone, pairs.from_bone)), gap = d - pairs.R - pairs.r, zero = D(0.0);
    unsigned bits = Bits((pairs.r > zero) & (d > zero) & (gap < D(p.enlargement_m))) & valid;
    if (bits == 0) continue;
    const D3 n = Quotients(pairs.from_bone, d);
    const ExactBins bins = FindExactBins({AlongAxis(p, 0, n), AlongAxis(p, 1, n), AlongAxis(p, 2, n)});
    double gaps[8], cutting_off[8], shaft_off[8];
    Store(gaps, gap), Store(cutting_off, bins.cutting_off), Store(shaft_off, bins.shaft_off);
    for (; bits != 0; bits &= bits - 1) {
      const unsigned k = Lowest(bits);
      const std::uint32_t place = p.near_place[i + k];
      const auto tool = static_cast<std::uint16_t>(p.near_tool[i + k]);
      const bool cutting = p.tool.cutting[tool] != 0;
      const unsigned bin = bins.Number(k, cutting);
      const double score = gaps[k] + p.middle_worth_m * (cutting ? cutting_off[k] : shaft_off[k]);
      const bool nearer = score != p.score[bin]        ? score < p.score[bin]
                          : place != p.best_place[bin] ? place < p.best_place[bin]
                                                       : tool < p.best_tool[bin];
      if (nearer) p.score[bin] = score, p.best_place[bin] = place, p.best_tool[bin] = tool;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
