// Pass 2: examines in floats every pair that may be near. Pairs that may be the nearest of their bin, or may
// lie in a face's cone, are then computed in doubles.
#if defined(OSTEON_CPU_NEAR_FIELD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_NEAR_FIELD_INL_H
#undef OSTEON_CPU_NEAR_FIELD_INL_H
#else
#define OSTEON_CPU_NEAR_FIELD_INL_H
#endif

#include <algorithm>

#include "simulation/engine_cpu/kernels/exact_pairs-inl.h"
#include "simulation/engine_cpu/kernels/face_sums-inl.h"
#include "simulation/engine_cpu/kernels/float_bins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

constexpr std::uint32_t kChunk = 512, kWide = 16;  // most packed pairs; lanes examined at a time
constexpr std::uint8_t kUnsureBin = 255;           // means that floats cannot decide the bin

// Near pairs, packed without gaps. Either all of their tool balls cut, or none does.
struct NearChunk {
  alignas(64) float x[kChunk + kWide], y[kChunk + kWide], z[kChunk + kWide];  // vector from bone to tool
  alignas(64) float gap[kChunk + kWide];
  std::uint32_t place[kChunk + kWide], tool[kChunk + kWide];
  std::uint32_t count{0};
  bool cutting{true};
  float rounding_mm{0.0f};
};

// The state of the pass: for each bin an upper bound of its smallest score, and the lists of pairs that
// doubles examine.
class NearFieldSearch {
 public:
  explicit NearFieldSearch(NearFieldPass& pass);
  // Lowers the bounds of the bins by the scores of pairs that are probably near.
  void BoundBy(const std::uint32_t* place, const std::uint32_t* tool, std::size_t count);
  // Examines the rows of the list and computes the pass's results.
  void Run();

 private:
  // Examines the eight pairs of a row in floats, and packs the near ones into the chunk.
  void ExamineRow(const NearFieldPass& p, std::uint32_t block, const F3& c, const F8& r, std::uint32_t row);
  // TakeChunk examines all pairs of the chunk; TakeLanes examines kWide of them, from i on. AddNear and
  // FaceSums list the pairs that need doubles.
  void TakeChunk();
  void TakeLanes(std::uint32_t i);
  // Lists a pair for doubles, if it may be the nearest of its bin. @param number  the bin's number
  // @param inside, edge  distance to the bin's border, and the largest error of this distance
  void AddNear(std::uint32_t place, std::uint32_t tool, float score, float number, float inside, float error,
               float edge);
  void SumNear();
  // Largest error of a score: the gap's rounding error, plus the direction's rounding error times
  // kBinCentreBias_m (0.05 mm; with the slope of the cosine, less than 0.1 mm).
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
  alignas(64) float best_[64];  // for each bin, an upper bound of the nearest pair's score
  std::size_t near_count_{0};
  FaceSums face_sums_;
  NearChunk chunk_;
};

inline NearFieldSearch::NearFieldSearch(NearFieldPass& pass)
    : p_(pass),
      worth_mm_(static_cast<float>(1e3 * pass.middle_worth_m)),
      face_cosine_(static_cast<float>(pass.face_cosine)),
      face_sums_(pass) {
  for (int i = 0; i < 9; ++i) axes_[i] = static_cast<float>(pass.axes[i]);
  for (int f = 0; f < pass.face_count; ++f)
    for (int a = 0; a < 3; ++a) faces_[f][a] = static_cast<float>(pass.face_n[f][a]);
  std::fill(std::begin(best_), std::end(best_), kNever);
  for (auto* lanes : {chunk_.x, chunk_.y, chunk_.z, chunk_.gap})
    std::fill(lanes, lanes + kChunk + kWide, 0.0f);
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
  // copy the data, so that they stay in registers: the compiler assumes that stores of vectors may change p_
  const NearFieldPass p = p_;
  const float limit = LimitOf(p.every_row, p.displacement_mm + p.enlargement_mm + p.rounding_mm);
  std::uint32_t b = 0, row = 0;
  for (BoundCursor blocks = BlocksOf(p.rows); blocks.Next(limit, b);) {
    PrefetchAhead(p.rows, p.balls, b);
    const std::uint32_t block = p.rows.block[b], first = p.rows.first[b], last = p.rows.first[b + 1];
    const F3 c = CentersOf(p.balls[block]);
    const F8 r = Load(p.balls[block].r);
    if (last == first + 1) {
      ExamineRow(p, block, c, r, first);
      p.rows.block_bound[b] = p.rows.bound[first];
      continue;
    }
    for (BoundCursor rows(p.rows.bound, first, last); rows.Next(limit, row);) ExamineRow(p, block, c, r, row);
    UpdateBlockBound(p.rows, b);
  }
  TakeChunk();
  SumNear();
  face_sums_.Finish();
}

HWY_INLINE void NearFieldSearch::ExamineRow(const NearFieldPass& p, std::uint32_t block, const F3& c,
                                            const F8& r, std::uint32_t row) {
  const std::uint32_t t = p.rows.tool[row];
  const F3 from = At(p.at, t) - c;
  const F8 gap = Sqrt(Dot(from, from)) - F(p.tool.r_mm[t]) - r;
  const MF live = r > F(0.0f);
  p.rows.bound[row] = Least(Select(live, gap, F(kNever))) + (p.displacement_mm - p.rounding_mm);
  const float rounding_mm = p.tool.rounding_mm[t];
  const MF near = live & (gap < F(p.enlargement_mm + rounding_mm));
  // no branch here, because it is hard to predict whether a row has a near pair
  NearChunk& to = chunk_;
  const bool cutting = p.tool.cutting[t] != 0;
  if (to.count > kChunk - kLanes || to.cutting != cutting) {
    TakeChunk();
    to.cutting = cutting;
  }
  const std::uint32_t i = to.count;
  Pack(to.x + i, from.x, near), Pack(to.y + i, from.y, near), Pack(to.z + i, from.z, near);
  Pack(to.gap + i, gap, near), Store(to.tool + i, U(t));
  to.count = i + static_cast<std::uint32_t>(Pack(to.place + i, LaneNumbers(block * 32), near));
  to.rounding_mm = std::max(to.rounding_mm, rounding_mm);
}

inline void NearFieldSearch::TakeChunk() {
  for (std::uint32_t i = 0; i < chunk_.count; i += kWide) TakeLanes(i);
  chunk_.count = 0;
  chunk_.rounding_mm = 0.0f;
}

HWY_INLINE void NearFieldSearch::TakeLanes(std::uint32_t i) {
  using V = F16;
  const NearChunk& c = chunk_;
  V x = Make<V>::From(c.x + i), y = Make<V>::From(c.y + i), z = Make<V>::From(c.z + i);
  const V square = MulAdd(z, z, MulAdd(y, y, x * x));
  const V per = Like(x, 1.0f) / Max(Sqrt(square), Like(x, 1e-20f));
  x = x * per, y = y * per, z = z * per;
  const unsigned valid = c.count - i >= kWide ? (1u << kWide) - 1u : (1u << (c.count - i)) - 1u;
  V cosine = Like(x, -2.0f);
  for (int f = 0; f < p_.face_count; ++f) cosine = Max(cosine, DotWith(faces_[f], x, y, z));
  const V least = NegMulAdd(Like(x, 2.0f * c.rounding_mm), per, Like(x, face_cosine_ - kConeRounding));
  face_sums_.Add(c.place + i, c.tool + i, valid & Bits(cosine > least));

  const FloatBins<V> bins = FindFloatBins(DotWith(axes_, x, y, z), DotWith(axes_ + 3, x, y, z),
                                          DotWith(axes_ + 6, x, y, z), c.cutting);
  const V score = MulAdd(Like(x, worth_mm_), bins.off_centre, Make<V>::From(c.gap + i));
  const V error = ScoreError(per, c.rounding_mm),
          edge = MulAdd(Like(x, 4.0f * c.rounding_mm), per, Like(x, kBinRounding));
  // doubles also have to examine a pair whose bin floats cannot decide
  unsigned bits = valid & Bits((score - error <= BinTable(best_).At(bins.number)) | (bins.inside <= edge));
  if (bits == 0) return;
  float scores[kWide], numbers[kWide], inside[kWide], errors[kWide], edges[kWide];
  Store(scores, score), Store(numbers, bins.number), Store(inside, bins.inside);
  Store(errors, error), Store(edges, edge);
  for (; bits != 0; bits &= bits - 1) {
    const unsigned k = Lowest(bits);
    AddNear(c.place[i + k], c.tool[i + k], scores[k], numbers[k], inside[k], errors[k], edges[k]);
  }
}

inline void NearFieldSearch::AddNear(std::uint32_t place, std::uint32_t tool, float score, float number,
                                     float inside, float error, float edge) {
  const auto bin = static_cast<unsigned>(number);
  const bool sure = inside > edge;
  if (sure && score - error > best_[bin]) return;
  if (near_count_ == kNearCapacity) SumNear();
  const std::size_t to = near_count_++;
  p_.near_place[to] = place, p_.near_tool[to] = tool;
  p_.near_score[to] = score - error;
  p_.near_bin[to] = sure ? static_cast<std::uint8_t>(bin) : kUnsureBin;
  // only a pair whose gap is surely below the enlargement may exclude other pairs
  if (sure && score < p_.enlargement_mm - 2.0f * error) best_[bin] = LesserOf(best_[bin], score + error);
}

// Computes in doubles those listed pairs that later pairs have not excluded.
inline void NearFieldSearch::SumNear() {
  std::size_t few = 0;
  for (std::size_t i = 0; i < near_count_; ++i) {
    if (p_.near_bin[i] != kUnsureBin && p_.near_score[i] > best_[p_.near_bin[i]]) continue;
    p_.near_place[few] = p_.near_place[i], p_.near_tool[few++] = p_.near_tool[i];
  }
  FindNearestPairs(p_, few);
  near_count_ = 0;
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
