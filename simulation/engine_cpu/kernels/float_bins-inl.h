// Bins of direction in floats, and how sure of them floats are.
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

// FindBin of contact_law.h in floats, of as many directions as V has lanes.
template <class V>
struct FloatBins {
  V number;      // a whole number
  V off_centre;  // 1 - cosine
  V inside;      // how far the direction is from where another bin begins: what comparisons differ by
};

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
  // 1 / √(1 + 4/9 n) for n thirds off the middle
  const V per_length =
      Select(off1 & off2, Like(ux, 0.72760688f), Select(off1 | off2, Like(ux, 0.83205029f), one));
  const V number = MulAdd(Like(ux, 9.0f), face, MulAdd(Like(ux, 3.0f), i, j));
  return {number, one - along * per_length, Min(to_face, Min(Abs(three1 - edge), Abs(three2 - edge)))};
}

// Comparisons of bins are of components, and of three times a component with another: off by four times what
// is off in a direction (rounding.h), and by their own rounding.
constexpr float kBinRounding = 4.0f * kDirectionRounding + 0x1p-21f;
// A cosine of two unit vectors: both are off in length and direction, the face's normal by √3 u.
constexpr float kConeRounding = 2.0f * kDirectionRounding;

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
