// Selects the rows of a neighbour list that a pass has to examine.
#if defined(OSTEON_CPU_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_ROWS_INL_H
#undef OSTEON_CPU_ROWS_INL_H
#else
#define OSTEON_CPU_ROWS_INL_H
#endif

#include <hwy/cache_control.h>

#include <bit>

#include "simulation/engine_cpu/kernels/lanes-inl.h"
#include "simulation/engine_cpu/pass_data.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Returns eight bits of which the lowest `count` are set.
HWY_INLINE unsigned FirstBits(std::size_t count) { return count >= 8 ? 0xffu : (1u << count) - 1u; }
// Returns the position of the lowest set bit.
HWY_INLINE unsigned Lowest(unsigned bits) { return static_cast<unsigned>(std::countr_zero(bits)); }
HWY_INLINE std::size_t CountOf(unsigned bits) { return static_cast<std::size_t>(std::popcount(bits)); }
HWY_INLINE float LesserOf(float a, float b) { return a < b ? a : b; }

HWY_INLINE F3 CentersOf(const BallBlock& b) { return {Load(b.x), Load(b.y), Load(b.z)}; }
HWY_INLINE F3 CentersOf(const PointBlock& b) { return {Load(b.x), Load(b.y), Load(b.z)}; }
// Returns the centre of tool ball t in all lanes: At rounded [mm], ExactlyAt exact [m].
HWY_INLINE F3 At(const Places& p, unsigned t) { return {F(p.x_mm[t]), F(p.y_mm[t]), F(p.z_mm[t])}; }
HWY_INLINE D3 ExactlyAt(const Places& p, unsigned t) { return {D(p.x[t]), D(p.y[t]), D(p.z[t])}; }

// Iterates over the bounds of a range that are at most a limit. The limit may fall during the iteration.
class BoundCursor {
 public:
  HWY_INLINE BoundCursor(const float* bound, std::uint32_t first, std::uint32_t last)
      : bound_(bound), group_(first), next_(first), last_(last) {}
  HWY_INLINE bool Next(float limit, std::uint32_t& at) {
    while (bits_ == 0) {
      if (next_ >= last_) return false;
      bits_ = Bits(Load(bound_ + next_) <= F(limit)) & FirstBits(last_ - next_);
      group_ = next_;
      next_ += 8;
    }
    at = group_ + Lowest(bits_);
    bits_ &= bits_ - 1;
    return true;
  }

 private:
  const float* bound_;
  std::uint32_t group_, next_, last_;
  unsigned bits_{0};
};
HWY_INLINE BoundCursor BlocksOf(const PairRows& rows) { return {rows.block_bound, 0, rows.block_count}; }
HWY_INLINE BoundCursor RowsOf(const PairRows& rows, std::uint32_t b) {
  return {rows.bound, rows.first[b], rows.first[b + 1]};
}

// Prefetches a block that is needed some iterations later, because listed blocks are not contiguous in
// memory.
template <class Block>
HWY_INLINE void PrefetchAhead(const PairRows& rows, const Block* blocks, std::uint32_t b) {
  constexpr std::uint32_t kAhead = 16;  // number of blocks to prefetch ahead
  const Block& later = blocks[rows.block[b + kAhead < rows.block_count ? b + kAhead : b]];
  hwy::Prefetch(&later), hwy::Prefetch(&later.z);
}

// Sets the block's bound to the smallest bound of its rows.
HWY_INLINE void UpdateBlockBound(const PairRows& rows, std::uint32_t b) {
  const std::uint32_t first = rows.first[b], last = rows.first[b + 1];
  if (last == first + 1) {
    rows.block_bound[b] = rows.bound[first];
    return;
  }
  F8 least = F(kNever);
  for (std::uint32_t k = first; k < last; k += 8)
    least = Min(least, Select(MaskF(FirstBits(last - k)), Load(rows.bound + k), F(kNever)));
  rows.block_bound[b] = Least(least);
}

// Returns the limit with which a pass compares bounds: the largest gap that matters or, for brute force, a
// limit that excludes nothing.
HWY_INLINE float LimitOf(bool every_row, float gap_mm) { return every_row ? kNever : gap_mm; }

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
