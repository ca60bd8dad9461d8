// Pass 2, the sums about each face's normal: pairs in a face's cone are found in floats and added up in
// doubles.
#if defined(OSTEON_CPU_FACE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_FACE_SUMS_INL_H
#undef OSTEON_CPU_FACE_SUMS_INL_H
#else
#define OSTEON_CPU_FACE_SUMS_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/engine_cpu/kernels/divisor-inl.h"
#include "simulation/engine_cpu/kernels/pairs-inl.h"
#include "simulation/engine_cpu/kernels/transpose-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Returns LensVolume of cutting_math.h, limited to max_lens_m3, with the same bits.
HWY_INLINE D8 LensOf(const NearFieldPass& p, const D8& r1, const D8& r2, const D8& d) {
  const D8 dr = r1 - r2, sum = r1 + r2, overlap = sum - d;
  D8 v =
      D(std::numbers::pi) * overlap * overlap * (d * d + D(2.0) * d * sum - D(3.0) * dr * dr) / (D(12.0) * d);
  // if one ball lies within the other, the lens is the whole smaller ball
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

// The list of pairs that may lie in a cone, and their sums. The pairs are added by rising bone ball, then by
// rising tool ball, because the bits of a sum depend on the order.
class FaceSums {
 public:
  explicit FaceSums(NearFieldPass& pass)
      : p_(pass), in_order_(pass.rows.first[pass.rows.block_count] == pass.rows.block_count) {
    for (std::size_t f = 0; f < kFaceCount; ++f) sums_[f] = Load(p_.sums[f]);
  }
  // Adds the pairs of sixteen lanes. They must arrive by rising block, then by rising tool ball, then by
  // rising ball.
  HWY_INLINE void Add(const std::uint32_t* place, const std::uint32_t* tool, unsigned lanes) {
    using V = Vector<std::uint32_t, 16>;
    if (count_ >= kConeCapacity) AddUp(SortBlocks(BeginOfLastBlock()));
    const auto mask = FromBits<MaskOf<std::uint32_t, 16>>::Of(lanes);
    Pack(p_.cone_place + count_, Make<V>::From(place), mask);
    count_ += Pack(p_.cone_tool + count_, Make<V>::From(tool), mask);
  }
  // Adds up the remaining pairs, and stores the sums in the pass.
  void Finish() {
    AddUp(SortBlocks(count_));
    for (std::size_t f = 0; f < kFaceCount; ++f) Store(p_.sums[f], sums_[f]);
  }

 private:
  // Eight pairs, with the results that one step of AddUp passes to the next.
  struct alignas(64) Group {
    double x[8], y[8], z[8], d[8], r[8], R[8];  // vector from bone to tool, later made unit; distance; radii
    double center_x[8], center_y[8], center_z[8], lens[8], weight[kFaceCount][8];
    unsigned counts, in_face;
  };
  static constexpr std::size_t kGroups = 8;  // number of groups that AddUp computes together

  // A place is 32 · block + lane (BallAtPlace).
  std::size_t BeginOfLastBlock() const;
  std::size_t SortBlocks(std::size_t end);
  void SortBlock(std::size_t begin, std::size_t end);
  void AddUp(std::size_t end);
  void Measure(std::size_t first, std::size_t end, Group* groups);
  void Weigh(Group& g) const;
  void Sum(const Group& g);

  NearFieldPass& p_;
  bool in_order_;  // true: every block has a single row, so the pairs arrive in order
  std::size_t count_{0};
  D8 sums_[kFaceCount];  // for each face: sums of weight, n, centre in T, radius
};

// Index in the list of the first pair of the last pair's block: this block may not be complete yet.
inline std::size_t FaceSums::BeginOfLastBlock() const {
  std::size_t begin = count_;
  while (begin > 0 && p_.cone_place[begin - 1] / 32 == p_.cone_place[count_ - 1] / 32) --begin;
  return begin;
}

// Sorts the pairs before `end` by ball, then tool ball. @returns end
inline std::size_t FaceSums::SortBlocks(std::size_t end) {
  if (in_order_) return end;
  for (std::size_t begin = 0, next = 0; begin < end; begin = next) {
    const std::uint32_t block = p_.cone_place[begin] / 32;
    for (next = begin + 1; next < end && p_.cone_place[next] / 32 == block;) ++next;
    if (p_.cone_tool[begin] != p_.cone_tool[next - 1]) SortBlock(begin, next);
  }
  return end;
}

// Sorts a block's pairs by ball. They arrive by rising tool ball, and pairs of one ball keep that order.
inline void FaceSums::SortBlock(std::size_t begin, std::size_t end) {
  std::size_t at[8] = {}, next = 0;
  for (std::size_t i = begin; i < end; ++i) ++at[p_.cone_place[i] % 32];
  for (std::size_t& first : at) {
    const std::size_t lanes = first;
    first = next, next += lanes;
  }
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t to = at[p_.cone_place[i] % 32]++;
    p_.block_place[to] = p_.cone_place[i], p_.block_tool[to] = p_.cone_tool[i];
  }
  std::copy(p_.block_place, p_.block_place + (end - begin), p_.cone_place + begin);
  std::copy(p_.block_tool, p_.block_tool + (end - begin), p_.cone_tool + begin);
}

// Adds up the pairs before `end`; the pairs from `end` on stay in the list. Each step is a loop over several
// groups, so that their roots and quotients hide each other's latency.
inline void FaceSums::AddUp(std::size_t end) {
  Group groups[kGroups];
  for (std::size_t i = 0; i < end; i += kLanes * kGroups) {
    const std::size_t count = std::min(kGroups, (end - i + kLanes - 1) / kLanes);
    for (std::size_t g = 0; g < count; ++g) Measure(i + kLanes * g, end, groups + g);
    for (std::size_t g = 0; g < count; ++g) Weigh(groups[g]);
    for (std::size_t g = 0; g < count; ++g) Sum(groups[g]);
  }
  std::copy(p_.cone_place + end, p_.cone_place + count_, p_.cone_place);
  std::copy(p_.cone_tool + end, p_.cone_tool + count_, p_.cone_tool);
  count_ -= end;
}

// Loads eight pairs of the list from `first` on, with their distances and whether they are near enough to
// have a weight.
HWY_INLINE void FaceSums::Measure(std::size_t first, std::size_t end, Group* group) {
  const unsigned valid = FirstBits(end - first);
  const Pairs pair = LoadPairs(p_, p_.cone_place + first, p_.cone_tool + first, valid);
  const D8 d = Sqrt(Dot(pair.from_bone, pair.from_bone)), gap = d - pair.R - pair.r;
  Group& g = *group;
  g.counts = Bits((d > D(0.0)) & (gap < D(p_.enlargement_m))) & valid;
  Store(g.x, pair.from_bone.x), Store(g.y, pair.from_bone.y), Store(g.z, pair.from_bone.z), Store(g.d, d);
  Store(g.r, pair.r), Store(g.R, pair.R);
  Store(g.center_x, pair.center_T.x), Store(g.center_y, pair.center_T.y);
  Store(g.center_z, pair.center_T.z);
}

// Makes the directions unit vectors, and computes the weight of each pair for each face. A pair outside the
// face's cone has the weight zero, which changes no sum.
HWY_INLINE void FaceSums::Weigh(Group& g) const {
  const D8 d = Load(g.d), zero = D(0.0);
  const MD counts = MaskD(g.counts);
  const D3 n = Quotients(D3{Load(g.x), Load(g.y), Load(g.z)}, d);
  const D8 lens = LensOf(p_, Load(g.R) + D(p_.enlargement_m), Load(g.r), d);
  g.in_face = 0;
  for (int f = 0; f < p_.face_count; ++f) {
    const D3 face{D(p_.face_n[f][0]), D(p_.face_n[f][1]), D(p_.face_n[f][2])};
    const D8 inside = Dot(n, face) - D(p_.face_cosine);
    const MD in = counts & (inside > zero);
    Store(g.weight[f], Select(in, lens * inside * inside, zero));
    g.in_face |= (Bits(in) != 0 ? 1u : 0u) << f;
  }
  Store(g.x, Select(counts, n.x, zero)), Store(g.y, Select(counts, n.y, zero));
  Store(g.z, Select(counts, n.z, zero));
}

// Does FaceSums::Add of contact_law.h for eight pairs, one after the other, with the same bits.
HWY_INLINE void FaceSums::Sum(const Group& g) {
  if (g.in_face == 0) return;
  D8 terms[8] = {D(1.0),           Load(g.x),        Load(g.y),        Load(g.z),
                 Load(g.center_x), Load(g.center_y), Load(g.center_z), Load(g.R)};
  Transpose(terms);
  for (int f = 0; f < p_.face_count; ++f) {
    if ((g.in_face >> f & 1u) == 0) continue;
    D8 sum = sums_[f];
    for (int k = 0; k < 8; ++k) sum = sum + D(g.weight[f][k]) * terms[k];
    sums_[f] = sum;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
