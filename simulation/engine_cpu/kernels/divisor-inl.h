// Quotients with one common divisor, without a division for each quotient.
#if defined(OSTEON_CPU_DIVISOR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_DIVISOR_INL_H
#undef OSTEON_CPU_DIVISOR_INL_H
#else
#define OSTEON_CPU_DIVISOR_INL_H
#endif

#include "simulation/engine_cpu/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Computes correctly rounded quotients a / b with one common divisor b > 0, without a division for each.
//
// RN(x) is x rounded to the nearest double, and one ulp is the distance between neighbouring doubles. With y
// = RN(1/b) and q = RN(a y), the error is |q - a/b| <= 1.5 ulp. A first correction, q - y RN(b q - a), leaves
// an error below one ulp, so q is then a faithful quotient. Markstein's theorem holds for a faithful quotient
// (Muller et al., Handbook of Floating-Point Arithmetic, section 4.7): b q - a is exact in one fused
// operation, and a second correction gives RN(a/b). The quotient keeps the sign of a, even if a is -0: b q -
// a is then +0, and q - y 0 is q. The form q + y RN(a - b q) would turn -0 into +0. The operands of this
// model are far from overflow, and so large that the remainders b q - a are not subnormal.
//
// These are free functions, not a class with vectors as members: GCC 12 copies a member that consists of two
// vectors by half vectors, and the next load of a whole vector waits for both stores. With AVX2, the removal
// would then take 164 us instead of 117 us.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_NEON
// Returns q, an approximation of a / b, after one correction.
template <std::size_t N>
HWY_INLINE One<double, N> Corrected(One<double, N> q, One<double, N> a, One<double, N> b,
                                    One<double, N> reciprocal) {
  return NegMulAdd(MulSub(b, q, a), reciprocal, q);
}
// Returns a / b, correctly rounded. @param reciprocal  1 / b, rounded
template <std::size_t N>
HWY_INLINE One<double, N> Quotient(One<double, N> a, One<double, N> b, One<double, N> reciprocal) {
  return Corrected(Corrected(a * reciprocal, a, b, reciprocal), a, b, reciprocal);
}
template <class H>
HWY_INLINE Two<H> Quotient(const Two<H>& a, const Two<H>& b, const Two<H>& reciprocal) {
  return {Quotient(a.a, b.a, reciprocal.a), Quotient(a.b, b.b, reciprocal.b)};
}
// Divides the three coordinates of a by b.
template <class V>
HWY_INLINE Three<V> Quotients(const Three<V>& a, const V& b) {
  const V reciprocal = Make<V>::Of(1.0) / b;
  return {Quotient(a.x, b, reciprocal), Quotient(a.y, b, reciprocal), Quotient(a.z, b, reciprocal)};
}
#else  // for sets without fused multiply-adds, and AVX-512, whose divisions are faster on Zen 4 (removal 78
       // us, not 85)
template <class V>
HWY_INLINE Three<V> Quotients(const Three<V>& a, const V& b) {
  return {a.x / b, a.y / b, a.z / b};
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
