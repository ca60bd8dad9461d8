// Pass 3: shrinks the balls that the sweep touches.
#if defined(OSTEON_CPU_REMOVAL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_REMOVAL_INL_H
#undef OSTEON_CPU_REMOVAL_INL_H
#else
#define OSTEON_CPU_REMOVAL_INL_H
#endif

#include <algorithm>

#include "simulation/engine_cpu/kernels/divisor-inl.h"
#include "simulation/engine_cpu/kernels/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

constexpr std::uint32_t kWorkBlocks = 24;  // number of blocks that are shrunk together

// Shrinks the balls of several blocks at a time, in doubles. A seated reamer touches thousands of balls in
// every frame: roots and quotients of several blocks at once hide each other's latency.
class BallShrinking {
 public:
  explicit BallShrinking(RemovalPass& pass) : p_(pass) {}
  void Run();

 private:
  // Eight balls in doubles [m].
  struct alignas(64) Work {
    double x[8], y[8], z[8], r[8];
  };
  // For eight balls: vector from the tool ball's path to the ball's centre, and its length [m].
  struct alignas(64) Away {
    double x[8], y[8], z[8], distance[8];
  };
  void AddBlock(std::uint32_t b, float limit);
  void FinishWork();
  void ShrinkByRounds();
  void Shrink(const TouchingRow* rows, std::uint32_t count, const Places& a, const Places& b);
  void ShrinkTouched(const TouchingRow& row, unsigned first, const Away& away, const Places& a,
                     const Places& b);
  void DropSmallChildren();
  void WriteBack();

  RemovalPass& p_;
  Work work_[kWorkBlocks];
  std::uint32_t block_[kWorkBlocks];
  std::uint32_t count_{0}, rows_{0}, max_rounds_{0};
};

inline void BallShrinking::Run() {
  const float limit = SweepLimit(p_.sweep);
  std::uint32_t b = 0;
  for (BoundCursor blocks = BlocksOf(p_.rows); blocks.Next(limit, b);) AddBlock(b, limit);
  FinishWork();
}

// Adds block b of the list to the work, with the rows of tool balls that may touch it.
HWY_INLINE void BallShrinking::AddBlock(std::uint32_t b, float limit) {
  const std::uint32_t number = p_.rows.block[b], first = p_.rows.first[b], last = p_.rows.first[b + 1];
  const BallBlock& block = p_.balls[number];
  const F3 c = CentersOf(block);
  const F8 r = Load(block.r);
  if (rows_ + (last - first) > p_.scratch_capacity) FinishWork();
  std::uint32_t rounds = 0;
  if (last == first + 1) {
    // the bound was updated in this frame, so nearly every block below the limit is touched: skip the test in
    // floats
    const unsigned t = p_.rows.tool[first];
    if (!Cuts(p_.sweep, t)) return;
    p_.scratch[rows_++] = {.slot = count_, .tool = t, .lanes = 0xffu};
    rounds = 1;
  } else {
    const F8 reach = F(ReachOf(p_.sweep));
    const MF live = r > F(0.0f);
    std::uint32_t row = 0;
    for (BoundCursor rows = RowsOf(p_.rows, b); rows.Next(limit, row);) {
      const unsigned t = p_.rows.tool[row];
      if (!Cuts(p_.sweep, t)) continue;
      const unsigned lanes = Bits(live & (GapAtContact(p_.sweep, t, c, r) <= reach));
      if (lanes == 0) continue;
      p_.scratch[rows_++] = {.slot = count_, .tool = t, .lanes = lanes};
      ++rounds;
    }
    if (rounds == 0) return;
  }
  max_rounds_ = std::max(max_rounds_, rounds);
  Work& w = work_[count_];
  const D3 center = Metres(c);
  Store(w.x, center.x), Store(w.y, center.y), Store(w.z, center.z), Store(w.r, D(1e-3) * ToD(r));
  block_[count_++] = number;
  if (count_ == kWorkBlocks) FinishWork();
}

// Shrinks the balls of the collected blocks, and stores them.
inline void BallShrinking::FinishWork() {
  if (count_ == 0) return;
  if (max_rounds_ == 1) {
    Shrink(p_.scratch, rows_, p_.sweep.contact, p_.sweep.slid);
    Shrink(p_.scratch, rows_, p_.sweep.slid, p_.sweep.end);
  } else {
    ShrinkByRounds();
  }
  if (p_.touched_children != nullptr) DropSmallChildren();
  WriteBack();
  count_ = rows_ = max_rounds_ = 0;
}

// Shrinks each ball by the tool balls in their order, and for each tool ball by both pieces of its path. The
// rows are stored block after block. Each round processes the next row of every block.
inline void BallShrinking::ShrinkByRounds() {
  TouchingRow round[kWorkBlocks];
  std::uint32_t next[kWorkBlocks], end[kWorkBlocks];
  for (std::uint32_t i = 0, slot = 0; slot < count_; ++slot) {
    next[slot] = i;
    while (i < rows_ && p_.scratch[i].slot == slot) ++i;
    end[slot] = i;
  }
  for (;;) {
    std::uint32_t n = 0;
    for (std::uint32_t slot = 0; slot < count_; ++slot)
      if (next[slot] < end[slot]) round[n++] = p_.scratch[next[slot]++];
    if (n == 0) return;
    Shrink(round, n, p_.sweep.contact, p_.sweep.slid);
    Shrink(round, n, p_.sweep.slid, p_.sweep.end);
  }
}

// Shrinks the block of each row by the capsule of the row's tool ball from a to b. The rows must belong to
// different blocks.
inline void BallShrinking::Shrink(const TouchingRow* rows, std::uint32_t count, const Places& a,
                                  const Places& b) {
  Away away[kWorkBlocks];
  unsigned known = ~0u;
  Segment<DPiece> segment{};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (rows[i].tool != known) segment = SegmentOf<DPiece>(a, b, known = rows[i].tool);
    const Work& w = work_[rows[i].slot];
    Away& to = away[i];
    for (unsigned k = 0; k < 8; k += kPiece) {
      using V = Make<DPiece>;
      const Three<DPiece> out = AwayFrom(segment, {V::From(w.x + k), V::From(w.y + k), V::From(w.z + k)});
      Store(to.x + k, out.x), Store(to.y + k, out.y), Store(to.z + k, out.z);
      Store(to.distance + k, Sqrt(ExactDot(out, out)));
    }
  }
  for (std::uint32_t i = 0; i < count; ++i)
    for (unsigned k = 0; k < 8; k += kPiece) ShrinkTouched(rows[i], k, away[i], a, b);
  p_.pairs_examined += 8 * count;
}

// Does ShrinkBall of cutting_math.h for the lanes of one vector, with the same bits.
HWY_INLINE void BallShrinking::ShrinkTouched(const TouchingRow& row, unsigned first, const Away& from,
                                             const Places& a, const Places& b) {
  using Load = Make<DPiece>;
  Work& w = work_[row.slot];
  const double tool_radius = p_.sweep.tool.r[row.tool];
  const Three<DPiece> away{Load::From(from.x + first), Load::From(from.y + first),
                           Load::From(from.z + first)};
  const DPiece R = Load::Of(tool_radius), r = Load::From(w.r + first), d = Load::From(from.distance + first),
               penetration = r + R - d, zero = Load::Of(0.0);
  const auto hit = FromBits<typename Traits<DPiece>::Mask>::Of(row.lanes >> first & ((1u << kPiece) - 1u)) &
                   (r > zero) & (penetration > zero);
  const DPiece half = Load::Of(0.5) * penetration, left = r - half;
  // this includes a penetration of 2 r or more, which leaves a radius of 0 or less
  const auto gone = hit & (left < Load::Of(p_.min_radius_m));
  // for centres so close to the axis, shrink_on_axis determines the direction
  const auto close = hit & (!gone) & (d < Load::Of(p_.on_axis_share * tool_radius));
  const auto moved = hit & (!gone) & (!close);
  for (unsigned bits = Bits(close); bits != 0; bits &= bits - 1) {
    const unsigned k = first + Lowest(bits), t = row.tool;
    double center[3] = {w.x[k], w.y[k], w.z[k]};
    const double start[3] = {a.x[t], a.y[t], a.z[t]}, end[3] = {b.x[t], b.y[t], b.z[t]};
    p_.shrink_on_axis(center, &w.r[k], start, end, tool_radius);
    w.x[k] = center[0], w.y[k] = center[1], w.z[k] = center[2];
  }
  const Three<DPiece> u = Quotients(away, d);
  const DPiece x = Load::From(w.x + first), y = Load::From(w.y + first), z = Load::From(w.z + first),
               now = Load::From(w.r + first);
  Store(w.x + first, Select(moved, x + half * u.x, x));
  Store(w.y + first, Select(moved, y + half * u.y, y));
  Store(w.z + first, Select(moved, z + half * u.z, z));
  Store(w.r + first, Select(gone, zero, Select(moved, left, now)));
}

// Removes children below their smallest radius, and lists all touched blocks of children.
inline void BallShrinking::DropSmallChildren() {
  for (std::uint32_t slot = 0; slot < count_; ++slot) {
    const std::uint32_t block = block_[slot];
    if (block < p_.first_child) continue;
    const D8 r = Load(work_[slot].r);
    Store(work_[slot].r,
          Select(r < D(p_.min_child_m[(block - p_.first_child) / p_.child_stride]), D(0.0), r));
    p_.touched_children[p_.touched_count++] = block;
  }
}

// Stores the balls, rounded like RoundToStored(); a ball that was not touched keeps its floats.
inline void BallShrinking::WriteBack() {
  for (std::uint32_t slot = 0; slot < count_; ++slot) {
    const Work& w = work_[slot];
    BallBlock& block = p_.balls[block_[slot]];
    const F8 left = ToF(Load(w.r) * D(1e3));
    p_.balls_changed += CountOf(Bits(left < Load(block.r)));
    Store(block.x, ToF(Load(w.x) * D(1e3)));
    Store(block.y, ToF(Load(w.y) * D(1e3)));
    Store(block.z, ToF(Load(w.z) * D(1e3)));
    Store(block.r, left);
  }
}

inline void RemoveBalls(RemovalPass& pass) { BallShrinking(pass).Run(); }

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
