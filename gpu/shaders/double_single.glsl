// Doubles for a device without shaderFloat64: a double-single is the sum of two floats (x: the nearest float; y: the remainder),
// about 48 bits instead of 53, with a float's range. spirv_array (gpu/lowering) replaces each operation on doubles by a call of
// one of these functions, by name, and forbids the driver to contract or reorder their operations.
// Source: Dekker, A Floating-Point Technique for Extending the Available Precision, Numer. Math. 18, 1971; the sums after Joldes,
// Muller, Popescu, Tight and Rigorous Error Bounds for Basic Building Blocks of Double-Word Arithmetic, ACM TOMS 44, 2017.

layout(constant_id = 11) const bool kFusedFma = false;  // the device's fma() rounds once (context/fused_fma.h)

// The exact sum of two floats. DsFastTwoSum requires that the first one is not smaller in size.
vec2 DsTwoSum(const in float a, const in float b) {
  float sum = a + b, of_b = sum - a;
  return vec2(sum, (a - (sum - of_b)) + (b - of_b));
}
vec2 DsFastTwoSum(const in float a, const in float b) {
  float sum = a + b;
  return vec2(sum, b - (sum - a));
}
// Splits a float into its upper 12 bits and its lower bits.
vec2 DsSplit(const in float a) {
  float shifted = 4097.0 * a, upper = shifted - (shifted - a);
  return vec2(upper, a - upper);
}
// The exact product of two floats. With or without fma(), the result has the same bits.
vec2 DsTwoProduct(const in float a, const in float b) {
  float product = a * b;
  if (kFusedFma) return vec2(product, fma(a, b, -product));
  vec2 p = DsSplit(a), q = DsSplit(b);
  return vec2(product, ((p.x * q.x - product) + p.x * q.y + p.y * q.x) + p.y * q.y);
}

vec2 DsAdd(const in vec2 a, const in vec2 b) {
  vec2 s = DsTwoSum(a.x, b.x), t = DsTwoSum(a.y, b.y);
  vec2 v = DsFastTwoSum(s.x, s.y + t.x);
  return DsFastTwoSum(v.x, t.y + v.y);
}
vec2 DsSub(const in vec2 a, const in vec2 b) { return DsAdd(a, -b); }
vec2 DsMul(const in vec2 a, const in vec2 b) {
  vec2 p = DsTwoProduct(a.x, b.x);
  return DsFastTwoSum(p.x, p.y + (a.x * b.y + a.y * b.x));
}
// Sum and product with a float as the second operand, which takes half of the operations.
vec2 DsAddFloat(const in vec2 a, const in float b) {
  vec2 s = DsTwoSum(a.x, b);
  return DsFastTwoSum(s.x, a.y + s.y);
}
vec2 DsMulFloat(const in vec2 a, const in float b) {
  vec2 p = DsTwoProduct(a.x, b);
  return DsFastTwoSum(p.x, p.y + a.y * b);
}
// A scalar product whose remainders are rounded once. Its error is relative to the sum of the products' sizes, as if each
// product and sum were rounded separately, which takes twice the operations.
vec2 DsDot(const in vec2 a, const in vec2 b, const in vec2 c, const in vec2 u, const in vec2 v, const in vec2 w) {
  vec2 p = DsTwoProduct(a.x, u.x), q = DsTwoProduct(b.x, v.x), r = DsTwoProduct(c.x, w.x);
  vec2 s = DsTwoSum(p.x, q.x), t = DsTwoSum(s.x, r.x);
  float mixed = (a.x * u.y + a.y * u.x) + (b.x * v.y + b.y * v.x) + (c.x * w.y + c.y * w.x);
  return DsTwoSum(t.x, ((p.y + q.y) + (r.y + mixed)) + (s.y + t.y));
}
// The quotient of the floats, plus the quotient of its remainder: about 44 bits, since Vulkan allows a division an error of 2.5
// units in the last place.
vec2 DsDiv(const in vec2 a, const in vec2 b) {
  float quotient = a.x / b.x;
  vec2 product = DsMulFloat(b, quotient);
  float rest = (a.x - product.x) + (a.y - product.y);
  return DsFastTwoSum(quotient, rest / b.x);
}
// The root of the float, and one step of Newton's method: about 44 bits.
vec2 DsSqrt(const in vec2 a) {
  float root = sqrt(a.x);
  vec2 square = DsTwoProduct(root, root);
  float rest = (a.x - square.x) + (a.y - square.y);
  vec2 better = DsFastTwoSum(root, rest / (2.0 * root));
  return a.x > 0.0 ? better : vec2(0.0);
}

bool DsLess(const in vec2 a, const in vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }
bool DsLessEqual(const in vec2 a, const in vec2 b) { return a.x < b.x || (a.x == b.x && a.y <= b.y); }
bool DsEqual(const in vec2 a, const in vec2 b) { return a.x == b.x && a.y == b.y; }
vec2 DsMin(const in vec2 a, const in vec2 b) { return DsLess(b, a) ? b : a; }
vec2 DsMax(const in vec2 a, const in vec2 b) { return DsLess(a, b) ? b : a; }
vec2 DsAbs(const in vec2 a) { return a.x < 0.0 || (a.x == 0.0 && a.y < 0.0) ? -a : a; }

// DsFloor: the largest integer that is not larger than a.
vec2 DsFloor(const in vec2 a) {
  float whole = floor(a.x);
  return whole == a.x ? DsFastTwoSum(whole, floor(a.y)) : vec2(whole, 0.0);
}

// Integers in two halves, since a float holds 24 bits. Conversions back drop the fraction.
vec2 DsFromInt(const in int i) { return DsFastTwoSum(float(i >> 16) * 65536.0, float(i & 0xffff)); }
vec2 DsFromUint(const in uint i) { return DsFastTwoSum(float(i >> 16u) * 65536.0, float(i & 0xffffu)); }
int DsToInt(const in vec2 a) {
  vec2 whole = DsFloor(DsAbs(a));
  float upper = floor(whole.x * (1.0 / 65536.0));
  int size = (int(upper) << 16) + int(whole.x - upper * 65536.0) + int(whole.y);
  return a.x < 0.0 ? -size : size;
}
uint DsToUint(const in vec2 a) { return uint(DsToInt(a)); }

// Minimum over a subgroup: the float decides, then the remainder among the invocations that have this float.
vec2 DsSubgroupMin(const in vec2 a) {
  float first = subgroupMin(a.x);
  return vec2(first, subgroupMin(a.x == first ? a.y : 1e30));
}
vec2 DsSubgroupMax(const in vec2 a) {
  float first = subgroupMax(a.x);
  return vec2(first, subgroupMax(a.x == first ? a.y : -1e30));
}
