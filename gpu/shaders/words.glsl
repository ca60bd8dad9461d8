// 64-bit integers of keys and of exact sums: the device's own or, with OSTEON_NO_INT64, two words of 32 bits (x: lower). Both
// give the same bits.
//
// A minimum over keys of two words takes two dispatches of a pass: the first finds the smallest upper word, the second the
// smallest lower word among the keys that have it. If the upper word is zero, the first dispatch also finds the lower word, for
// the key of a fraction of zero: in the second dispatch the float tests would pass no pair.
#ifdef OSTEON_NO_INT64
layout(constant_id = 10) const bool kLowerWords = true;  // false: the first of the two dispatches
const Key64 kNoKey = Key64(0xffffffffu);

// Lowers a buffer's key to `key`, or in the first of two dispatches its upper word.
#define MIN_KEY(target, key)                                                                     \
  {                                                                                              \
    Key64 own_key = key;                                                                         \
    if (!kLowerWords) atomicMin(target.y, own_key.y);                                            \
    if (kLowerWords ? own_key.y == target.y : own_key.y == 0u) atomicMin(target.x, own_key.x);   \
  }
Key64 Smaller(Key64 a, Key64 b) { return a.y < b.y || (a.y == b.y && a.x < b.x) ? a : b; }

// Adds to a buffer's sum. The carry follows from the old value of the lower word.
#define ADD_SUM(target, sum)                                            \
  {                                                                     \
    Sum64 own_sum = sum;                                                \
    uint carry = atomicAdd(target.x, own_sum.x) > ~own_sum.x ? 1u : 0u; \
    if (own_sum.y + carry != 0u) atomicAdd(target.y, own_sum.y + carry); \
  }
Sum64 Plus(Sum64 a, Sum64 b) {
  uint carry, lower = uaddCarry(a.x, b.x, carry);
  return Sum64(lower, a.y + b.y + carry);
}
// Returns part * 2^bits.
Sum64 Shifted(int part, uint bits) {
  return bits == 0u ? Sum64(part, part >> 31)
                    : bits < 32u ? Sum64(part << bits, part >> (32u - bits)) : Sum64(0u, part << (bits - 32u));
}
// Returns the bits of a sum from `first` on, with the sign. They must fit in 32 bits.
int BitsFrom(Sum64 sum, uint first) {
  return first == 0u ? int(sum.x) : first < 32u ? int(sum.y << (32u - first) | sum.x >> first) : int(sum.y) >> (first - 32u);
}
Sum64 SumOf(uint whole) { return Sum64(whole, 0u); }
const Sum64 kNoSum = Sum64(0u);
// WordsOf: the words of a key or a sum. KeyOf: the key that has these words.
uvec2 WordsOf(uvec2 key) { return key; }
Key64 KeyOf(uvec2 words) { return words; }
#else
const bool kLowerWords = true;
const Key64 kNoKey = 0xfffffffffffffffful;
#define MIN_KEY(target, key) atomicMin(target, key);
Key64 Smaller(Key64 a, Key64 b) { return min(a, b); }

#define ADD_SUM(target, sum) atomicAdd(target, sum);
Sum64 Plus(Sum64 a, Sum64 b) { return a + b; }
Sum64 Shifted(int part, uint bits) { return Sum64(part) << bits; }
int BitsFrom(Sum64 sum, uint first) { return int(sum >> first); }
Sum64 SumOf(uint whole) { return Sum64(whole); }
const Sum64 kNoSum = 0L;
uvec2 WordsOf(Key64 key) { return unpackUint2x32(key); }
uvec2 WordsOf(Sum64 sum) { return unpackUint2x32(Key64(sum)); }
Key64 KeyOf(uvec2 words) { return packUint2x32(words); }
#endif

// SumOf: an integer below 2^63 as a sum. NumberOf: a sum as the nearest double.
#if defined(OSTEON_NO_INT64) || defined(OSTEON_NO_FLOAT64)
// Converts by integers of 32 bits, which words and double_single.glsl have. Only signed integers are used: llvmpipe converts
// doubles from 2^31 on wrongly to unsigned integers.
const double kHalfWord = 2147483648.0lf;
Sum64 SumOf(double whole) {
  double upper = floor(whole * (1.0lf / kHalfWord));
  return Plus(Shifted(int(upper), 31u), Shifted(int(whole - upper * kHalfWord), 0u));
}
double NumberOf(Sum64 sum) {
  uvec2 words = WordsOf(sum);
  return double(int(words.y)) * (2.0lf * kHalfWord) + (double(int(words.x >> 1)) * 2.0lf + double(int(words.x & 1u)));
}
#else
Sum64 SumOf(double whole) { return Sum64(whole); }
double NumberOf(Sum64 sum) { return double(sum); }
#endif
