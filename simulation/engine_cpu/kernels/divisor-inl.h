// Quotients by one divisor, without a division each.
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

// Correctly rounded quotients by one divisor b > 0, without a division each.
//
// With y = RN(1/b) and q = RN(a y): |q - a/b| <= 1.5 ulp. One correction q + y RN(a - b q) leaves less than
// an ulp (its own error is 2^-51 of the first one's), so q is then a faithful quotient. For such a one
// Markstein's theorem holds (Muller et al., Handbook of Floating-Point Arithmetic, section 4.7): a - b q is
// exact in one fused operation, and the next correction gives RN(a/b). The sign is a's, also where a is a
// zero. Operands of this model are far from overflow, and from where their quotients' rests would be
// subnormal.
class Divisor {
 public:
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_NEON
  HWY_INLINE explicit Divisor(const D8& b) : b_(b), reciprocal_(D(1.0) / b) {}
  HWY_INLINE D8 Of(const D8& a) const {
    D8 q = a * reciprocal_;
    q = MulAdd(NegMulAdd(b_, q, a), reciprocal_, q);
    q = MulAdd(NegMulAdd(b_, q, a), reciprocal_, q);
    return CopySignOf(q, a);
  }

 private:
  D8 b_, reciprocal_;
#else  // without fused multiply-adds; and with AVX-512, whose quotients take less on Zen 4 (removal 78 us,
       // not 85)
  HWY_INLINE explicit Divisor(const D8& b) : b_(b) {}
  HWY_INLINE D8 Of(const D8& a) const { return a / b_; }

 private:
  D8 b_;
#endif
};

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
