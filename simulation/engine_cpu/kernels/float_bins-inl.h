// Computes bins of direction in floats, and how certain the results are.
#if defined(OSTEON_CPU_FLOAT_BINS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_FLOAT_BINS_INL_H
#undef OSTEON_CPU_FLOAT_BINS_INL_H
#else
#define OSTEON_CPU_FLOAT_BINS_INL_H
#endif

#include "simulation/engine_cpu/kernels/rows-inl.h"
#include "simulation/engine_cpu/rounding.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Result of FindBin (contact_law.h) in floats, for as many directions as V has lanes.
template <class V>
struct FloatBins {
  V number;      // a whole number
  V off_centre;  // 1 - cosine of the angle to the bin's centre
  V inside;      // distance to the bin's border: smallest difference in a comparison
};

// Finds the bins of the directions (ux, uy, uz) in T. @param cutting  whether the tool balls cut
template <class V>
HWY_INLINE FloatBins<V> FindFloatBins(V ux, V uy, V uz, bool cutting) {
  const V sx = Abs(ux), sy = Abs(uy), sz = Abs(uz), zero = Like(ux, 0.0f), one = Like(ux, 1.0f);
  const auto x = (sx >= sy) & (sx >= sz), y = (!x) & (sy >= sz);
  const V main = Select(x, ux, Select(y, uy, uz)), b = Select(x, uy, Select(y, uz, ux)),
          c = Select(x, uz, Select(y, ux, uy));
  const V edge = Abs(main), size1 = Abs(b), size2 = Abs(c), to_face = edge - Max(size1, size2);
  const auto negative = main < zero;
  const V face = Select(x, zero, Select(y, Like(ux, 2.0f), Like(ux, 4.0f))) + Select(negative, one, zero);
  if (!cutting) return {face + Like(ux, 54.0f), one - edge, to_face};
  const V three1 = Like(ux, 3.0f) * size1, three2 = Like(ux, 3.0f) * size2;
  const auto off1 = three1 > edge, off2 = three2 > edge;
  const V i = Select(off1, Select(b < zero, zero, Like(ux, 2.0f)), one),
          j = Select(off2, Select(c < zero, zero, Like(ux, 2.0f)), one);
  const V along = MulAdd(Like(ux, 2.0f / 3.0f), Select(off1, size1, zero) + Select(off2, size2, zero), edge);
  // 1 / √(1 + 4/9 n), with n the number of directions on the face in which the bin is an outer third
  const V per_length =
      Select(off1 & off2, Like(ux, 0.72760688f), Select(off1 | off2, Like(ux, 0.83205029f), one));
  const V number = MulAdd(Like(ux, 9.0f), face, MulAdd(Like(ux, 3.0f), i, j));
  return {number, one - along * per_length, Min(to_face, Min(Abs(three1 - edge), Abs(three2 - edge)))};
}

// Holds a float for each of 64 bins, which At looks up by the bins' numbers. The table is kept in registers
// if these are wide enough, because gathering sixteen floats from memory takes as long as finding the bins
// (Zen 4).
class BinTable {
 public:
#if HWY_TARGET == HWY_AVX3
  HWY_INLINE explicit BinTable(const float* of)
      : a_(_mm512_loadu_ps(of)),
        b_(_mm512_loadu_ps(of + 16)),
        c_(_mm512_loadu_ps(of + 32)),
        d_(_mm512_loadu_ps(of + 48)) {}
  HWY_INLINE F16 At(F16 number) const {
    F16 found;
    found.v.raw = Find(_mm512_cvtps_epi32(number.v.raw));
    return found;
  }
  HWY_INLINE F8 At(F8 number) const {
    F8 found;
    found.v.raw = _mm512_castps512_ps256(Find(_mm512_castsi256_si512(_mm256_cvtps_epi32(number.v.raw))));
    return found;
  }

 private:
  HWY_INLINE __m512 Find(__m512i at) const {
    const __m512 low = _mm512_permutex2var_ps(a_, at, b_), high = _mm512_permutex2var_ps(c_, at, d_);
    return _mm512_mask_blend_ps(_mm512_test_epi32_mask(at, _mm512_set1_epi32(32)), low, high);
  }
  __m512 a_, b_, c_, d_;
#else
  HWY_INLINE explicit BinTable(const float* of) : of_(of) {}
  template <std::size_t N>
  HWY_INLINE One<float, N> At(One<float, N> number) const {
    const hn::CappedTag<float, N> tag;
    return {hn::GatherIndex(tag, of_, hn::ConvertTo(hn::Rebind<std::int32_t, decltype(tag)>(), number.v))};
  }
  template <class H>
  HWY_INLINE Two<H> At(Two<H> number) const {
    return {At(number.a), At(number.b)};
  }

 private:
  const float* of_;
#endif
};

// FindFloatBins compares components with each other, and three times a component with another one. The error
// of such a difference is at most four times a direction's error (rounding.h), plus its own rounding.
constexpr float kBinRounding = 4.0f * kDirectionRounding + 0x1p-21f;
// Largest error of the cosine between a pair's direction and a face's normal. Both have errors in length and
// direction; that of the normal is √3 u (u = 2^-24).
constexpr float kConeRounding = 2.0f * kDirectionRounding;

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
