// Eight floats or eight doubles and their masks, made of Highway's vectors: one vector with AVX-512, two or
// four if vectors are narrower. Compiled once for each instruction set (kernels.cpp).
#if defined(OSTEON_CPU_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_LANES_INL_H
#undef OSTEON_CPU_LANES_INL_H
#else
#define OSTEON_CPU_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A single vector of N lanes, for instruction sets that have such a vector.
template <class T, std::size_t N>
struct One {
  using Tag = hn::CappedTag<T, N>;
  hn::Vec<Tag> v;
};
template <class T, std::size_t N>
struct OneMask {
  using Tag = hn::CappedTag<T, N>;
  hn::Mask<Tag> m;
};
// A vector made of two halves. Each half is one vector, or again two halves.
template <class Half>
struct Two {
  Half a, b;
};

// Whether the instruction set has a vector of N lanes. If not, Choose halves N until it has one.
template <class T, std::size_t N>
inline constexpr bool kFits = hn::MaxLanes(hn::CappedTag<T, N>()) >= N;
template <class T, std::size_t N, bool fits>
struct Choose {
  using Vector = One<T, N>;
  using Mask = OneMask<T, N>;
};
template <class T, std::size_t N>
struct Choose<T, N, false> {
  using Vector = Two<typename Choose<T, N / 2, kFits<T, N / 2>>::Vector>;
  using Mask = Two<typename Choose<T, N / 2, kFits<T, N / 2>>::Mask>;
};
template <class T, std::size_t N>
using Vector = typename Choose<T, N, kFits<T, N>>::Vector;
template <class T, std::size_t N>
using MaskOf = typename Choose<T, N, kFits<T, N>>::Mask;

using F8 = Vector<float, 8>;
using F16 = Vector<float, 16>;
using D8 = Vector<double, 8>;
using U8 = Vector<std::uint32_t, 8>;
// masks of eight floats, integers, doubles
using MF = MaskOf<float, 8>;
using MU = MaskOf<std::uint32_t, 8>;
using MD = MaskOf<double, 8>;

// Number of lanes and mask type of a vector type.
template <class V>
struct Traits;
template <class T, std::size_t N>
struct Traits<One<T, N>> {
  static constexpr std::size_t kSize = N;
  using Scalar = T;
  using Mask = OneMask<T, N>;
};
template <class H>
struct Traits<Two<H>> {
  static constexpr std::size_t kSize = 2 * Traits<H>::kSize;
  using Scalar = typename Traits<H>::Scalar;
  using Mask = Two<typename Traits<H>::Mask>;
};
template <class M>
struct MaskTraits;
template <class T, std::size_t N>
struct MaskTraits<OneMask<T, N>> {
  static constexpr std::size_t kSize = N;
};
template <class H>
struct MaskTraits<Two<H>> {
  static constexpr std::size_t kSize = 2 * MaskTraits<H>::kSize;
};

// ---- making, loading and storing vectors

// Make<V>::Of sets all lanes to the value x; Make<V>::From loads the lanes from memory.
template <class V>
struct Make;
template <class T, std::size_t N>
struct Make<One<T, N>> {
  using Tag = hn::CappedTag<T, N>;
  static HWY_INLINE One<T, N> Of(T x) { return {hn::Set(Tag(), x)}; }
  static HWY_INLINE One<T, N> From(const T* p) { return {hn::LoadU(Tag(), p)}; }
};
template <class H>
struct Make<Two<H>> {
  using T = typename Traits<H>::Scalar;
  static HWY_INLINE Two<H> Of(T x) { return {Make<H>::Of(x), Make<H>::Of(x)}; }
  static HWY_INLINE Two<H> From(const T* p) {
    return {Make<H>::From(p), Make<H>::From(p + Traits<H>::kSize)};
  }
};
// Type of the single vectors of which a wider vector consists.
template <class V>
struct PieceOf {
  using Type = V;
};
template <class H>
struct PieceOf<Two<H>> : PieceOf<H> {};
using DPiece = PieceOf<D8>::Type;
inline constexpr unsigned kPiece = Traits<DPiece>::kSize;

HWY_INLINE F8 F(float x) { return Make<F8>::Of(x); }
HWY_INLINE D8 D(double x) { return Make<D8>::Of(x); }
HWY_INLINE U8 U(std::uint32_t x) { return Make<U8>::Of(x); }
HWY_INLINE F8 Load(const float* p) { return Make<F8>::From(p); }
HWY_INLINE D8 Load(const double* p) { return Make<D8>::From(p); }
HWY_INLINE U8 Load(const std::uint32_t* p) { return Make<U8>::From(p); }
// Makes a vector with as many lanes as another one.
template <class V>
HWY_INLINE V Like(V, float x) {
  return Make<V>::Of(x);
}

template <class T, std::size_t N>
HWY_INLINE void Store(T* p, One<T, N> a) {
  hn::StoreU(a.v, hn::CappedTag<T, N>(), p);
}
template <class H>
HWY_INLINE void Store(typename Traits<H>::Scalar* p, Two<H> a) {
  Store(p, a.a), Store(p + Traits<H>::kSize, a.b);
}

// ---- arithmetic: each operation rounds once

#define OSTEON_BINARY(name, highway)                    \
  template <class T, std::size_t N>                     \
  HWY_INLINE One<T, N> name(One<T, N> a, One<T, N> b) { \
    return {hn::highway(a.v, b.v)};                     \
  }                                                     \
  template <class H>                                    \
  HWY_INLINE Two<H> name(Two<H> a, Two<H> b) {          \
    return {name(a.a, b.a), name(a.b, b.b)};            \
  }
OSTEON_BINARY(operator+, Add)
OSTEON_BINARY(operator-, Sub)
OSTEON_BINARY(operator*, Mul)
OSTEON_BINARY(operator/, Div)
OSTEON_BINARY(Min, Min)
OSTEON_BINARY(Max, Max)
#undef OSTEON_BINARY

#define OSTEON_UNARY(name, highway)        \
  template <class T, std::size_t N>        \
  HWY_INLINE One<T, N> name(One<T, N> a) { \
    return {hn::highway(a.v)};             \
  }                                        \
  template <class H>                       \
  HWY_INLINE Two<H> name(Two<H> a) {       \
    return {name(a.a), name(a.b)};         \
  }
OSTEON_UNARY(Sqrt, Sqrt)
OSTEON_UNARY(Abs, Abs)
OSTEON_UNARY(Negative, Neg)
#undef OSTEON_UNARY

// Fused multiply-add, if the processor has it. It is used only for floats, which only exclude pairs, and for
// quotients, which get the same bits with and without it.
#define OSTEON_FUSED(name, highway)                                  \
  template <class T, std::size_t N>                                  \
  HWY_INLINE One<T, N> name(One<T, N> a, One<T, N> b, One<T, N> c) { \
    return {hn::highway(a.v, b.v, c.v)};                             \
  }                                                                  \
  template <class H>                                                 \
  HWY_INLINE Two<H> name(Two<H> a, Two<H> b, Two<H> c) {             \
    return {name(a.a, b.a, c.a), name(a.b, b.b, c.b)};               \
  }
OSTEON_FUSED(MulAdd, MulAdd)
OSTEON_FUSED(NegMulAdd, NegMulAdd)
OSTEON_FUSED(MulSub, MulSub)
#undef OSTEON_FUSED

// ---- comparisons and masks

#define OSTEON_COMPARE(op, highway)                                          \
  template <class T, std::size_t N>                                          \
  HWY_INLINE OneMask<T, N> operator op(One<T, N> a, One<T, N> b) {           \
    return {hn::highway(a.v, b.v)};                                          \
  }                                                                          \
  template <class H>                                                         \
  HWY_INLINE typename Traits<Two<H>>::Mask operator op(Two<H> a, Two<H> b) { \
    return {a.a op b.a, a.b op b.b};                                         \
  }
OSTEON_COMPARE(<, Lt)
OSTEON_COMPARE(<=, Le)
OSTEON_COMPARE(>, Gt)
OSTEON_COMPARE(>=, Ge)
OSTEON_COMPARE(==, Eq)
#undef OSTEON_COMPARE

#define OSTEON_LOGIC(op, highway)                                          \
  template <class T, std::size_t N>                                        \
  HWY_INLINE OneMask<T, N> operator op(OneMask<T, N> a, OneMask<T, N> b) { \
    return {hn::highway(a.m, b.m)};                                        \
  }
OSTEON_LOGIC(&, And)
OSTEON_LOGIC(|, Or)
#undef OSTEON_LOGIC
template <class T, std::size_t N>
HWY_INLINE OneMask<T, N> operator!(OneMask<T, N> a) {
  return {hn::Not(a.m)};
}
// Returns a bit for each lane of a mask.
template <class T, std::size_t N>
HWY_INLINE unsigned Bits(OneMask<T, N> a) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(hn::CappedTag<T, N>(), a.m, bytes);
  return N > 8 ? bytes[0] | unsigned{bytes[1]} << 8 : bytes[0];
}
template <class T, std::size_t N>
HWY_INLINE One<T, N> operator&(One<T, N> a, One<T, N> b) {
  return {hn::And(a.v, b.v)};
}
template <class H>
HWY_INLINE Two<H> operator&(Two<H> a, Two<H> b) {
  return {a.a & b.a, a.b & b.b};
}
template <class H>
HWY_INLINE Two<H> operator|(Two<H> a, Two<H> b) {
  return {a.a | b.a, a.b | b.b};
}
template <class H>
HWY_INLINE Two<H> operator!(Two<H> a) {
  return {!a.a, !a.b};
}
template <class H>
HWY_INLINE unsigned Bits(Two<H> a) {
  return Bits(a.a) | Bits(a.b) << MaskTraits<H>::kSize;
}

// Makes the mask with these bits, one for each lane.
template <class M>
struct FromBits;
template <class T, std::size_t N>
struct FromBits<OneMask<T, N>> {
  static HWY_INLINE OneMask<T, N> Of(unsigned bits) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
    return {hn::LoadMaskBits(hn::CappedTag<T, N>(), bytes)};
  }
};
template <class H>
struct FromBits<Two<H>> {
  static HWY_INLINE Two<H> Of(unsigned bits) {
    constexpr unsigned kLow = (1u << MaskTraits<H>::kSize) - 1u;
    return {FromBits<H>::Of(bits & kLow), FromBits<H>::Of(bits >> MaskTraits<H>::kSize)};
  }
};
HWY_INLINE MD MaskD(unsigned bits) { return FromBits<MD>::Of(bits); }
HWY_INLINE MF MaskF(unsigned bits) { return FromBits<MF>::Of(bits); }

template <class T, std::size_t N>
HWY_INLINE One<T, N> Select(OneMask<T, N> m, One<T, N> yes, One<T, N> no) {
  return {hn::IfThenElse(m.m, yes.v, no.v)};
}
template <class H>
HWY_INLINE Two<H> Select(typename Traits<Two<H>>::Mask m, Two<H> yes, Two<H> no) {
  return {Select(m.a, yes.a, no.a), Select(m.b, yes.b, no.b)};
}

// Returns the smallest lane.
template <std::size_t N>
HWY_INLINE float Least(One<float, N> a) {
  return hn::GetLane(hn::MinOfLanes(hn::CappedTag<float, N>(), a.v));
}
template <class H>
HWY_INLINE float Least(Two<H> a) {
  return Least(Min(a.a, a.b));
}

// ---- between floats and doubles

template <class To>
struct Convert;
template <std::size_t N>
struct Convert<One<double, N>> {
  static HWY_INLINE One<double, N> Of(One<float, N> a) {
    return {hn::PromoteTo(hn::CappedTag<double, N>(), a.v)};
  }
};
template <std::size_t N>
struct Convert<One<float, N>> {
  static HWY_INLINE One<float, N> Of(One<double, N> a) {
    return {hn::DemoteTo(hn::CappedTag<float, N>(), a.v)};
  }
#if HWY_TARGET != HWY_SCALAR  // one vector of floats from two of doubles
  template <class Half>
  static HWY_INLINE One<float, N> Of(Two<Half> a) {
    using To = Convert<One<float, N / 2>>;
    return {hn::Combine(hn::CappedTag<float, N>(), To::Of(a.b).v, To::Of(a.a).v)};
  }
#endif
};
template <class H>
struct Convert<Two<H>> {
  template <class Half>
  static HWY_INLINE Two<H> Of(Two<Half> a) {
    return {Convert<H>::Of(a.a), Convert<H>::Of(a.b)};
  }
#if HWY_TARGET != HWY_SCALAR  // two vectors of doubles from one of floats
  template <std::size_t N>
  static HWY_INLINE Two<H> Of(One<float, N> a) {
    const hn::CappedTag<float, N / 2> half;
    return {Convert<H>::Of(One<float, N / 2>{hn::LowerHalf(half, a.v)}),
            Convert<H>::Of(One<float, N / 2>{hn::UpperHalf(half, a.v)})};
  }
#endif
};
// ToD converts floats to doubles exactly; ToF rounds doubles to floats
HWY_INLINE D8 ToD(F8 a) { return Convert<D8>::Of(a); }
HWY_INLINE F8 ToF(D8 a) { return Convert<F8>::Of(a); }

// ---- gathering lanes from a table, and packing lanes

// Loads base[index[k]] into each lane k. With AVX2 and AVX-512, each lane is loaded separately, because the
// processor's gather instructions take longer: on Zen 4, the near field of a seated reamer takes 133 us with
// them and 117 us without.
template <class T, std::size_t N>
HWY_INLINE void GatherInto(One<T, N>& to, const T* base, const std::uint32_t* index) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  using Raw = decltype(to.v.raw);
  if constexpr (N == 4) {
    to.v.raw = Raw{base[index[0]], base[index[1]], base[index[2]], base[index[3]]};
  } else {
    static_assert(N == 8);
    to.v.raw = Raw{base[index[0]], base[index[1]], base[index[2]], base[index[3]],
                   base[index[4]], base[index[5]], base[index[6]], base[index[7]]};
  }
#else
  const hn::CappedTag<T, N> tag;
  const hn::Rebind<hwy::MakeSigned<T>, decltype(tag)> places;
  if constexpr (sizeof(T) == 4) {
    to.v = hn::GatherIndex(tag, base, hn::LoadU(places, reinterpret_cast<const std::int32_t*>(index)));
  } else {
    const hn::Rebind<std::int32_t, decltype(tag)> narrow;
    to.v = hn::GatherIndex(
        tag, base, hn::PromoteTo(places, hn::LoadU(narrow, reinterpret_cast<const std::int32_t*>(index))));
  }
#endif
}
template <class T, class H>
HWY_INLINE void GatherInto(Two<H>& to, const T* base, const std::uint32_t* index) {
  GatherInto(to.a, base, index), GatherInto(to.b, base, index + Traits<H>::kSize);
}
HWY_INLINE F8 Gather(const float* base, const std::uint32_t* index) {
  F8 to;
  GatherInto(to, base, index);
  return to;
}
HWY_INLINE D8 Gather(const double* base, const std::uint32_t* index) {
  D8 to;
  GatherInto(to, base, index);
  return to;
}

// Returns the lanes first, first + 1, …
HWY_INLINE U8 LaneNumbers(std::uint32_t first) {
  constexpr std::uint32_t kNumbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  return Load(kNumbers) + U(first);
}

// For each mask of N lanes, the numbers of its set lanes one after the other. Highway's own tables are local
// to its functions (1.0.3), and GCC 12 copies such a table to the stack at every use: 1 KiB with AVX2.
#if HWY_TARGET == HWY_AVX2
struct PackedLanes {  // four bits for each lane's number
  std::uint32_t of[256];
  constexpr PackedLanes() : of{} {
    for (unsigned mask = 0; mask < 256; ++mask)
      for (unsigned k = 0, to = 0; k < 8; ++k)
        if ((mask >> k & 1u) != 0) of[mask] |= k << 4 * to++;
  }
};
inline constexpr PackedLanes kPackedLanes;
alignas(32) inline constexpr std::uint32_t kPackShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
#elif HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON
struct PackedLanes {  // the numbers of the four bytes of each lane
  alignas(16) std::uint8_t of[16][16];
  constexpr PackedLanes() : of{} {
    for (unsigned mask = 0; mask < 16; ++mask)
      for (unsigned k = 0, to = 0; k < 4; ++k)
        if ((mask >> k & 1u) != 0)
          for (unsigned byte = 0; byte < 4; ++byte) of[mask][to++] = static_cast<std::uint8_t>(4 * k + byte);
  }
};
inline constexpr PackedLanes kPackedLanes;
#endif
// Moves the lanes that are set in a mask to the front, in their order. The lanes behind them are undefined.
template <class T, std::size_t N>
HWY_INLINE One<T, N> Packed(One<T, N> a, OneMask<T, N> m) {
#if HWY_TARGET == HWY_AVX2
  static_assert(sizeof(T) == 4 && N == 8);
  const hn::CappedTag<float, 8> floats;
  // the permutation uses only the lowest three bits of a lane
  const __m256i lanes = _mm256_srlv_epi32(_mm256_set1_epi32(static_cast<int>(kPackedLanes.of[Bits(m)])),
                                          _mm256_load_si256(reinterpret_cast<const __m256i*>(kPackShifts)));
  const hn::Vec<decltype(floats)> packed{_mm256_permutevar8x32_ps(hn::BitCast(floats, a.v).raw, lanes)};
  return {hn::BitCast(hn::CappedTag<T, N>(), packed)};
#elif HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON
  static_assert(sizeof(T) == 4 && N == 4);
  const hn::CappedTag<std::uint8_t, 16> bytes;
  return {
      hn::BitCast(hn::CappedTag<T, N>(),
                  hn::TableLookupBytes(hn::BitCast(bytes, a.v), hn::Load(bytes, kPackedLanes.of[Bits(m)])))};
#else
  return {hn::Compress(a.v, m.m)};
#endif
}

// Writes the lanes that are set in a mask one behind the other. It always writes eight elements; those behind
// the set lanes are undefined.
template <class T, class M, std::size_t N>
HWY_INLINE std::size_t Pack(T* to, One<T, N> a, OneMask<M, N> m) {
  const hn::CappedTag<T, N> tag;
  const OneMask<T, N> lanes{hn::RebindMask(tag, m.m)};
  hn::StoreU(Packed(a, lanes).v, tag, to);
  return hn::CountTrue(tag, lanes.m);
}
template <class H, class M>
HWY_INLINE std::size_t Pack(typename Traits<H>::Scalar* to, Two<H> a, Two<M> m) {
  const std::size_t first = Pack(to, a.a, m.a);
  return first + Pack(to + first, a.b, m.b);
}

// ---- vectors for the three coordinates x, y, z

template <class V>
struct Three {
  V x, y, z;
};
using F3 = Three<F8>;
using D3 = Three<D8>;
template <class V>
HWY_INLINE Three<V> operator-(const Three<V>& a, const Three<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE F8 Dot(const F3& a, const F3& b) { return MulAdd(a.z, b.z, MulAdd(a.y, b.y, a.x * b.x)); }
// Dot product, added up in the order in which Eigen does it for a Vector3.
template <class V>
HWY_INLINE V ExactDot(const Three<V>& a, const Three<V>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
HWY_INLINE D8 Dot(const D3& a, const D3& b) { return ExactDot(a, b); }
HWY_INLINE D3 Metres(const F3& mm) { return {D(1e-3) * ToD(mm.x), D(1e-3) * ToD(mm.y), D(1e-3) * ToD(mm.z)}; }

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
