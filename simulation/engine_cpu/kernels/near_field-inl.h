// Pass 2: floats look at every pair that may be near, and leave to doubles those that may be the nearest of
// their bin or lie in a face's cone.
#if defined(OSTEON_CPU_NEAR_FIELD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_NEAR_FIELD_INL_H
#undef OSTEON_CPU_NEAR_FIELD_INL_H
#else
#define OSTEON_CPU_NEAR_FIELD_INL_H
#endif

#include <algorithm>

#include "simulation/engine_cpu/kernels/exact_pairs-inl.h"
#include "simulation/engine_cpu/kernels/float_bins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

constexpr std::uint32_t kChunk = 512, kWide = 16;
constexpr std::uint8_t kUnsureBin = 255;

// Near pairs, moved together so that every lane has one; of one kind, those that cut or those that do not.
struct NearChunk {
  alignas(64) float nx[kChunk + kWide], ny[kChunk + kWide], nz[kChunk + kWide];  // from bone to tool, unit
  alignas(64) float gap[kChunk + kWide], per_mm[kChunk + kWide];                 // 1 / distance
  std::uint32_t place[kChunk + kWide];
  std::uint16_t tool[kChunk + kWide];
  std::uint32_t count{0};
  bool cutting{true};
  float rounding_mm{0.0f};
};

// The state of the pass: an upper bound of each bin's least score, and the lists for doubles.
class NearFieldSearch {
 public:
  explicit NearFieldSearch(NearFieldPass& pass);
  // Scores of pairs that are probably near bound those of all others.
  void BoundBy(const std::uint32_t* place, const std::uint32_t* tool, std::size_t count);
  void Run();

 private:
  struct Axes {
    float x[3], y[3], z[3];
  };
  void AddRow(std::uint32_t block, unsigned t, const F3& from, const F8& d, const F8& gap, const MF& near);
  void TakeChunk();
  void AddNear(std::uint32_t i, unsigned bits, const float* score, const float* error, const float* number,
               const float* inside, const float* edge);
  void AddToCones(std::uint32_t i, unsigned bits);
  void CloseBlock();
  void SumNear();
  void SumCones();
  // Largest error of a score: the gap's rounding error, plus the direction's rounding error times the bin
  // centre's bias (0.05 mm, below 0.1 mm with the cosine's slope).
  template <class V>
  HWY_INLINE V ScoreError(V per_mm, float rounding_mm) const {
    return MulAdd(Like(per_mm, 0.1f * rounding_mm), per_mm, Like(per_mm, rounding_mm + 1e-7f));
  }
  template <class V>
  HWY_INLINE V DotWith(const float* n, V x, V y, V z) const {
    return MulAdd(z, Like(x, n[2]), MulAdd(y, Like(x, n[1]), x * Like(x, n[0])));
  }

  NearFieldPass& p_;
  float axes_[9], faces_[kFaceCount][3];
  float worth_mm_, face_cosine_;
  float best_[64];  // no pair of a bin that is nearest has a higher score
  std::size_t near_count_{0}, cone_count_{0}, block_count_{0};
  std::uint32_t open_block_{0}, lanes_[8]{};
  bool one_row_a_block_;
  NearChunk chunk_;
};

inline NearFieldSearch::NearFieldSearch(NearFieldPass& pass)
    : p_(pass),
      worth_mm_(static_cast<float>(1e3 * pass.middle_worth_m)),
      face_cosine_(static_cast<float>(pass.face_cosine)),
      one_row_a_block_(pass.rows.first[pass.rows.block_count] == pass.rows.block_count) {
  for (int i = 0; i < 9; ++i) axes_[i] = static_cast<float>(pass.axes[i]);
  for (int f = 0; f < pass.face_count; ++f)
    for (int a = 0; a < 3; ++a) faces_[f][a] = static_cast<float>(pass.face_n[f][a]);
  std::fill(std::begin(best_), std::end(best_), kNever);
  std::fill(std::begin(chunk_.nx), std::end(chunk_.nx), 0.0f);
  std::fill(std::begin(chunk_.ny), std::end(chunk_.ny), 0.0f);
  std::fill(std::begin(chunk_.nz), std::end(chunk_.nz), 0.0f);
  std::fill(std::begin(chunk_.gap), std::end(chunk_.gap), 0.0f);
  std::fill(std::begin(chunk_.per_mm), std::end(chunk_.per_mm), 0.0f);
}

inline void NearFieldSearch::BoundBy(const std::uint32_t* place, const std::uint32_t* tool,
                                     std::size_t count) {
  const float* base = p_.balls->x;
  for (std::size_t i = 0; i < count; i += 8) {
    const F3 from{Gather(p_.at.x_mm, tool + i) - Gather(base, place + i),
                  Gather(p_.at.y_mm, tool + i) - Gather(base + 8, place + i),
                  Gather(p_.at.z_mm, tool + i) - Gather(base + 16, place + i)};
    const F8 r = Gather(base + 24, place + i), d = Sqrt(Dot(from, from));
    const F8 gap = d - Gather(p_.tool.r_mm, tool + i) - r, per = F(1.0f) / Max(d, F(1e-20f));
    const F8 nx = from.x * per, ny = from.y * per, nz = from.z * per;
    const F8 ux = DotWith(axes_, nx, ny, nz), uy = DotWith(axes_ + 3, nx, ny, nz),
             uz = DotWith(axes_ + 6, nx, ny, nz);
    const F8 edge = MulAdd(F(4.0f * p_.rounding_mm), per, F(kBinRounding));
    const F8 error = ScoreError(per, p_.rounding_mm);
    for (const bool cutting : {true, false}) {
      const FloatBins<F8> bins = FindFloatBins(ux, uy, uz, cutting);
      float high[8], number[8];
      Store(high, MulAdd(F(worth_mm_), bins.off_centre, gap) + error), Store(number, bins.number);
      unsigned bits =
          Bits((r > F(0.0f)) & (gap < F(p_.enlargement_mm - p_.rounding_mm)) & (bins.inside > edge)) &
          FirstBits(count - i);
      for (; bits != 0; bits &= bits - 1) {
        const unsigned k = Lowest(bits);
        if ((p_.tool.cutting[tool[i + k]] != 0) != cutting) continue;
        float& best = best_[static_cast<unsigned>(number[k])];
        best = LesserOf(best, high[k]);
      }
    }
  }
}

inline void NearFieldSearch::Run() {
  const float limit = LimitOf(p_.every_row, p_.displacement_mm + p_.enlargement_mm + p_.rounding_mm);
  std::uint32_t b = 0, row = 0;
  for (BoundCursor blocks = BlocksOf(p_.rows); blocks.Next(limit, b);) {
    const std::uint32_t block = p_.rows.block[b];
    const F3 c = CentersOf(p_.balls[block]);
    const F8 r = Load(p_.balls[block].r);
    const MF live = r > F(0.0f);
    for (BoundCursor rows = RowsOf(p_.rows, b); rows.Next(limit, row);) {
      const unsigned t = p_.rows.tool[row];
      const F3 from = At(p_.at, t) - c;
      const F8 d = Sqrt(Dot(from, from)), gap = d - F(p_.tool.r_mm[t]) - r;
      p_.rows.bound[row] = Least(Select(live, gap, F(kNever))) + p_.displacement_mm - p_.rounding_mm;
      const MF near = live & (gap < F(p_.enlargement_mm + p_.tool.rounding_mm[t]));
      if (Bits(near) != 0) AddRow(block, t, from, d, gap, near);
    }
    UpdateBlockBound(p_.rows, b);
  }
  TakeChunk();
  CloseBlock();
  SumNear();
  SumCones();
}

HWY_INLINE void NearFieldSearch::AddRow(std::uint32_t block, unsigned t, const F3& from, const F8& d,
                                        const F8& gap, const MF& near) {
  const bool cutting = p_.tool.cutting[t] != 0;
  if (chunk_.count > kChunk - 8 || chunk_.cutting != cutting) {
    TakeChunk();
    chunk_.cutting = cutting;
  }
  const std::uint32_t i = chunk_.count;
  const F8 per = F(1.0f) / Max(d, F(1e-20f));
  Pack(chunk_.nx + i, from.x * per, near), Pack(chunk_.ny + i, from.y * per, near);
  Pack(chunk_.nz + i, from.z * per, near), Pack(chunk_.gap + i, gap, near);
  const std::size_t more = Pack(chunk_.per_mm + i, per, near);
  std::uint32_t to = i;
  for (unsigned bits = Bits(near); bits != 0; bits &= bits - 1)
    chunk_.place[to] = block * 32 + Lowest(bits), chunk_.tool[to++] = static_cast<std::uint16_t>(t);
  chunk_.count += static_cast<std::uint32_t>(more);
  chunk_.rounding_mm = std::max(chunk_.rounding_mm, p_.tool.rounding_mm[t]);
}

inline void NearFieldSearch::TakeChunk() {
  using V = F16;
  NearChunk& c = chunk_;
  for (std::uint32_t i = 0; i < c.count; i += kWide) {
    const V x = Make<V>::From(c.nx + i), y = Make<V>::From(c.ny + i), z = Make<V>::From(c.nz + i);
    const V per = Make<V>::From(c.per_mm + i);
    const FloatBins<V> bins = FindFloatBins(DotWith(axes_, x, y, z), DotWith(axes_ + 3, x, y, z),
                                            DotWith(axes_ + 6, x, y, z), c.cutting);
    const V score = MulAdd(Like(x, worth_mm_), bins.off_centre, Make<V>::From(c.gap + i));
    const V error = ScoreError(per, c.rounding_mm),
            edge = MulAdd(Like(x, 4.0f * c.rounding_mm), per, Like(x, kBinRounding));
    const unsigned valid = c.count - i >= kWide ? (1u << kWide) - 1u : (1u << (c.count - i)) - 1u;
    // where floats do not tell which bin it is, doubles have to look
    const unsigned bits = valid & Bits((score - error <= LookUp(best_, bins.number)) | (bins.inside <= edge));
    if (bits != 0) {
      float scores[kWide], errors[kWide], numbers[kWide], inside[kWide], edges[kWide];
      Store(scores, score), Store(errors, error), Store(numbers, bins.number), Store(inside, bins.inside);
      Store(edges, edge);
      AddNear(i, bits, scores, errors, numbers, inside, edges);
    }
    V cosine = Like(x, -2.0f);
    for (int f = 0; f < p_.face_count; ++f) cosine = Max(cosine, DotWith(faces_[f], x, y, z));
    const V least = Like(x, face_cosine_ - kConeRounding) - Like(x, 2.0f * c.rounding_mm) * per;
    AddToCones(i, valid & Bits(cosine > least));
  }
  c.count = 0;
  c.rounding_mm = 0.0f;
}

HWY_INLINE void NearFieldSearch::AddNear(std::uint32_t i, unsigned bits, const float* score,
                                         const float* error, const float* number, const float* inside,
                                         const float* edge) {
  for (; bits != 0; bits &= bits - 1) {
    const unsigned k = Lowest(bits), bin = static_cast<unsigned>(number[k]);
    const bool sure = inside[k] > edge[k];
    if (sure && score[k] - error[k] > best_[bin]) continue;
    if (near_count_ == kNearCapacity) SumNear();
    const std::size_t to = near_count_++;
    p_.near_place[to] = chunk_.place[i + k], p_.near_tool[to] = chunk_.tool[i + k];
    p_.near_score[to] = score[k] - error[k];
    p_.near_bin[to] = sure ? static_cast<std::uint8_t>(bin) : kUnsureBin;
    // only a pair that is surely within the enlargement bounds the others
    if (sure && score[k] < p_.enlargement_mm - 2.0f * error[k])
      best_[bin] = LesserOf(best_[bin], score[k] + error[k]);
  }
}

// Exactly, those that later pairs have not excluded.
inline void NearFieldSearch::SumNear() {
  std::size_t few = 0;
  for (std::size_t i = 0; i < near_count_; ++i) {
    if (p_.near_bin[i] != kUnsureBin && p_.near_score[i] > best_[p_.near_bin[i]]) continue;
    p_.near_place[few] = p_.near_place[i], p_.near_tool[few++] = p_.near_tool[i];
  }
  FindNearestPairs(p_, few);
  near_count_ = 0;
}

// ---- pairs in cones: summed by rising ball, then tool ball

HWY_INLINE void NearFieldSearch::AddToCones(std::uint32_t i, unsigned bits) {
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t place = chunk_.place[i + Lowest(bits)];
    const std::uint16_t tool = chunk_.tool[i + Lowest(bits)];
    if (one_row_a_block_) {  // in order already
      if (cone_count_ == kConeCapacity) SumCones();
      p_.cone_place[cone_count_] = place, p_.cone_tool[cone_count_++] = tool;
      continue;
    }
    if (block_count_ > 0 && open_block_ != place / 32) CloseBlock();
    open_block_ = place / 32;
    ++lanes_[place % 32];
    p_.block_place[block_count_] = place, p_.block_tool[block_count_++] = tool;
  }
}

// A block's pairs come by rising tool ball, then ball: to the end of the list by ball, then tool ball.
inline void NearFieldSearch::CloseBlock() {
  if (block_count_ == 0) return;
  if (cone_count_ >= kConeCapacity) SumCones();
  std::size_t at[8], next = cone_count_;
  for (int k = 0; k < 8; ++k) at[k] = next, next += lanes_[k], lanes_[k] = 0;
  for (std::size_t i = 0; i < block_count_; ++i) {
    const std::size_t to = at[p_.block_place[i] % 32]++;
    p_.cone_place[to] = p_.block_place[i], p_.cone_tool[to] = p_.block_tool[i];
  }
  cone_count_ = next;
  block_count_ = 0;
}

inline void NearFieldSearch::SumCones() {
  AddToFaces(p_, cone_count_);
  cone_count_ = 0;
}

inline void SearchNearField(NearFieldPass& pass, const std::uint32_t* likely_place,
                            const std::uint32_t* likely_tool, std::size_t likely_count) {
  NearFieldSearch search(pass);
  search.BoundBy(likely_place, likely_tool, likely_count);
  search.Run();
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
