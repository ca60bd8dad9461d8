// Pairs by the handful, exactly: the nearest in each bin of direction, and the sums about each face.
#if defined(OSTEON_CPU_EXACT_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_EXACT_PAIRS_INL_H
#undef OSTEON_CPU_EXACT_PAIRS_INL_H
#else
#define OSTEON_CPU_EXACT_PAIRS_INL_H
#endif

#include <cmath>
#include <numbers>

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Correctly rounded quotients by one divisor b > 0, without a division each.
//
// With y = RN(1/b) and q = RN(a y): |q - a/b| <= 1.5 ulp. One correction q + y RN(a - b q) leaves less than
// an ulp (its own error is 2^-51 of the first one's), so q is then a faithful quotient. For such a one
// Markstein's theorem holds (Muller et al., Handbook of Floating-Point Arithmetic, section 4.7): a - b q is
// exact in one fused operation, and the next correction gives RN(a/b). The sign is a's, also where a is a
// zero. Operands of this model are far from overflow, and from where their quotients' rests would be
// subnormal.
class Divisor {
 public:
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_NEON
  HWY_INLINE explicit Divisor(const D8& b) : b_(b), reciprocal_(D(1.0) / b) {}
  HWY_INLINE D8 Of(const D8& a) const {
    D8 q = a * reciprocal_;
    q = MulAdd(NegMulAdd(b_, q, a), reciprocal_, q);
    q = MulAdd(NegMulAdd(b_, q, a), reciprocal_, q);
    return CopySignOf(q, a);
  }

 private:
  D8 b_, reciprocal_;
#else  // without fused multiply-adds
  HWY_INLINE explicit Divisor(const D8& b) : b_(b) {}
  HWY_INLINE D8 Of(const D8& a) const { return a / b_; }

 private:
  D8 b_;
#endif
};

// Eight pairs of a list; lanes beyond its end hold anything.
struct Pairs {
  D3 from_bone;  // from the bone ball's centre to the tool ball's [m]
  D8 r, R;       // radii of bone and tool ball [m]
  D3 center_T;
};
HWY_INLINE Pairs LoadPairs(const NearFieldPass& p, const std::uint32_t* place, const std::uint16_t* tool,
                           unsigned valid) {
  const float* base = p.balls->x;
  std::uint32_t places[8], tools[8];
  bool one_tool = true;
  for (unsigned k = 0; k < 8; ++k) {
    const bool is_pair = (valid >> k & 1u) != 0;
    places[k] = place[is_pair ? k : 0], tools[k] = tool[is_pair ? k : 0];
    one_tool = one_tool && tools[k] == tools[0];
  }
  const D3 c = Metres({Gather(base, places), Gather(base + 8, places), Gather(base + 16, places)});
  Pairs pairs;
  pairs.r = D(1e-3) * ToD(Gather(base + 24, places));
  if (one_tool) {
    const unsigned t = tools[0];
    pairs.R = D(p.tool.r[t]);
    pairs.from_bone = ExactlyAt(p.at, t) - c;
    pairs.center_T = {D(p.tool.tx[t]), D(p.tool.ty[t]), D(p.tool.tz[t])};
    return pairs;
  }
  pairs.R = Gather(p.tool.r, tools);
  pairs.from_bone = D3{Gather(p.at.x, tools), Gather(p.at.y, tools), Gather(p.at.z, tools)} - c;
  pairs.center_T = {Gather(p.tool.tx, tools), Gather(p.tool.ty, tools), Gather(p.tool.tz, tools)};
  return pairs;
}

// ---- the nearest pair of each bin: FindBin and Nearer of contact_law.h, to the same bits

// The result of FindBin for eight directions: axis, sign, and thirds of the cube's face.
struct ExactBins {
  D8 cutting_off, shaft_off;  // of a bin's middle, for balls that cut and that do not
  unsigned x, y, negative, low1, high1, low2, high2;

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
HWY_INLINE ExactBins FindExactBins(const D3& u) {
  const D8 size_x = Abs(u.x), size_y = Abs(u.y), size_z = Abs(u.z), zero = D(0.0), three = D(3.0);
  const MD x = (size_x >= size_y) & (size_x >= size_z), y = (!x) & (size_y >= size_z);
  const D8 main = Select(x, u.x, Select(y, u.y, u.z)), b = Select(x, u.y, Select(y, u.z, u.x)),
           c = Select(x, u.z, Select(y, u.x, u.y));
  const D8 edge = Abs(main), minus_edge = Negative(edge);
  const MD low1 = three * b < minus_edge, high1 = (!low1) & (three * b > edge);
  const MD low2 = three * c < minus_edge, high2 = (!low2) & (three * c > edge);
  // (i - 1) b + (j - 1) c
  const D8 side =
      Select(low1, zero - b, Select(high1, b, zero)) + Select(low2, zero - c, Select(high2, c, zero));
  const D8 along = edge + D(2.0 / 3.0) * side;
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

HWY_INLINE D8 AlongAxis(const NearFieldPass& p, int c, const D3& n) {
  return (D(p.axes[3 * c]) * n.x + D(p.axes[3 * c + 1]) * n.y) + D(p.axes[3 * c + 2]) * n.z;
}

inline void FindNearestPairs(NearFieldPass& p, std::size_t count) {
  for (std::size_t i = 0; i < count; i += 8) {
    const unsigned valid = FirstBits(count - i);
    const Pairs pairs = LoadPairs(p, p.near_place + i, p.near_tool + i, valid);
    const D8 d = Sqrt(Dot(pairs.from_bone, pairs.from_bone)), gap = d - pairs.R - pairs.r, zero = D(0.0);
    unsigned bits = Bits((pairs.r > zero) & (d > zero) & (gap < D(p.enlargement_m))) & valid;
    if (bits == 0) continue;
    const Divisor by(d);
    const D3 n{by.Of(pairs.from_bone.x), by.Of(pairs.from_bone.y), by.Of(pairs.from_bone.z)};
    const ExactBins bins = FindExactBins({AlongAxis(p, 0, n), AlongAxis(p, 1, n), AlongAxis(p, 2, n)});
    double gaps[8], cutting_off[8], shaft_off[8];
    Store(gaps, gap), Store(cutting_off, bins.cutting_off), Store(shaft_off, bins.shaft_off);
    for (; bits != 0; bits &= bits - 1) {
      const unsigned k = Lowest(bits);
      const std::uint32_t place = p.near_place[i + k];
      const std::uint16_t tool = p.near_tool[i + k];
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

// ---- sums about a face's normal: LensVolume and FaceSums::Add, to the same bits

HWY_INLINE D8 LensOf(const NearFieldPass& p, const D8& r1, const D8& r2, const D8& d) {
  const D8 dr = r1 - r2, sum = r1 + r2, over = sum - d;
  D8 v = D(std::numbers::pi) * over * over * (d * d + D(2.0) * d * sum - D(3.0) * dr * dr) / (D(12.0) * d);
  unsigned swallowed = Bits(d <= Abs(dr));
  if (swallowed != 0) {
    double value[8], lesser[8];
    Store(value, v), Store(lesser, Select(r2 < r1, r2, r1));
    for (; swallowed != 0; swallowed &= swallowed - 1) {
      const unsigned k = Lowest(swallowed);
      value[k] = 4.0 / 3.0 * std::numbers::pi * std::pow(lesser[k], 3);
    }
    v = Load(value);
  }
  v = Select(d >= sum, D(0.0), v);
  return Select(D(p.max_lens_m3) < v, D(p.max_lens_m3), v);
}

// The sums' bits hang on their order: pairs one after the other, by rising ball, then tool ball. A pair
// outside the cone has the weight zero, which changes no sum.
inline void AddToFaces(NearFieldPass& p, std::size_t count) {
  for (std::size_t i = 0; i < count; i += 8) {
    const unsigned valid = FirstBits(count - i);
    const Pairs pair = LoadPairs(p, p.cone_place + i, p.cone_tool + i, valid);
    const D8 d = Sqrt(Dot(pair.from_bone, pair.from_bone)), gap = d - pair.R - pair.r, zero = D(0.0);
    const MD counts = MaskD(valid) & (d > zero) & (gap < D(p.enlargement_m));
    const Divisor by(d);
    const D3 n{by.Of(pair.from_bone.x), by.Of(pair.from_bone.y), by.Of(pair.from_bone.z)};
    const D8 lens = LensOf(p, pair.R + D(p.enlargement_m), pair.r, d);
    for (int f = 0; f < p.face_count; ++f) {
      const D3 face{D(p.face_n[f][0]), D(p.face_n[f][1]), D(p.face_n[f][2])};
      const D8 inside = Dot(n, face) - D(p.face_cosine);
      const MD in = counts & (inside > zero);
      if (Bits(in) == 0) continue;
      const D8 w = lens * inside * inside;
      const D8 terms[8] = {
          w,         w * n.x, w * n.y, w * n.z, w * pair.center_T.x, w * pair.center_T.y, w * pair.center_T.z,
          w * pair.R};
      alignas(64) double of[8][8];
      for (int c = 0; c < 8; ++c) Store(of[c], Select(in, terms[c], zero));
      double* sum = p.sums[f];
      for (unsigned k = 0; k < 8; ++k)
        for (int c = 0; c < 8; ++c) sum[c] += of[c][k];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
