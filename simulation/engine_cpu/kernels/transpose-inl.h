// Transposes eight vectors of eight doubles.
#if defined(OSTEON_CPU_TRANSPOSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_TRANSPOSE_INL_H
#undef OSTEON_CPU_TRANSPOSE_INL_H
#else
#define OSTEON_CPU_TRANSPOSE_INL_H
#endif

#include <utility>

#include "simulation/engine_cpu/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
// Transposes N vectors of N doubles: pairs of lanes first, then pairs of 128-bit blocks, then halves.
template <std::size_t N>
HWY_INLINE void TransposeSquare(One<double, N>* const (&r)[N]) {
  const hn::CappedTag<double, N> tag;
  hn::Vec<decltype(tag)> low[N / 2], high[N / 2];
  for (std::size_t i = 0; i < N / 2; ++i) {
    low[i] = hn::InterleaveLower(tag, r[2 * i]->v, r[2 * i + 1]->v);
    high[i] = hn::InterleaveUpper(tag, r[2 * i]->v, r[2 * i + 1]->v);
  }
  if constexpr (N == 2) {
    r[0]->v = low[0], r[1]->v = high[0];
  } else if constexpr (N == 4) {
    r[0]->v = hn::ConcatLowerLower(tag, low[1], low[0]),
    r[1]->v = hn::ConcatLowerLower(tag, high[1], high[0]);
    r[2]->v = hn::ConcatUpperUpper(tag, low[1], low[0]),
    r[3]->v = hn::ConcatUpperUpper(tag, high[1], high[0]);
  } else {
    static_assert(N == 8);
    for (std::size_t odd = 0; odd < 2; ++odd) {
      const auto& t = odd == 0 ? low : high;
      const auto a = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(t[1]), t[0]);
      const auto b = hn::OddEvenBlocks(t[1], hn::SwapAdjacentBlocks(t[0]));
      const auto c = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(t[3]), t[2]);
      const auto d = hn::OddEvenBlocks(t[3], hn::SwapAdjacentBlocks(t[2]));
      r[odd]->v = hn::ConcatLowerLower(tag, c, a), r[odd + 2]->v = hn::ConcatLowerLower(tag, d, b);
      r[odd + 4]->v = hn::ConcatUpperUpper(tag, c, a), r[odd + 6]->v = hn::ConcatUpperUpper(tag, d, b);
    }
  }
}

template <std::size_t N>
HWY_INLINE void Transpose(One<double, N>* const (&r)[N]) {
  TransposeSquare(r);
}
#else
HWY_INLINE void Transpose(One<double, 1>* const (&)[1]) {}
#endif
// Transposes a matrix whose rows are wider than a vector. Transposes each quarter of the matrix, then swaps
// the two quarters off the diagonal.
template <class H>
HWY_INLINE void Transpose(Two<H>* const (&r)[2 * Traits<H>::kSize]) {
  constexpr std::size_t kHalf = Traits<H>::kSize;
  H *top_left[kHalf], *top_right[kHalf], *low_left[kHalf], *low_right[kHalf];
  for (std::size_t i = 0; i < kHalf; ++i) {
    top_left[i] = &r[i]->a, top_right[i] = &r[i]->b;
    low_left[i] = &r[kHalf + i]->a, low_right[i] = &r[kHalf + i]->b;
  }
  Transpose(top_left), Transpose(top_right), Transpose(low_left), Transpose(low_right);
  for (std::size_t i = 0; i < kHalf; ++i) std::swap(*top_right[i], *low_left[i]);
}
HWY_INLINE void Transpose(D8 (&rows)[8]) {
  D8* each[8];
  for (int i = 0; i < 8; ++i) each[i] = &rows[i];
  Transpose(each);
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
