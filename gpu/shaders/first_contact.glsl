// Pass 1, one pair (equation 3, corrected; equivalent to simulation/contact/cutting_math.h FirstContactFraction), in floats. The result
// is never later than the contact, for errors of the balls' positions up to `rounding`.
float EarliestContact(vec3 D, vec3 m, float R, float rounding) {
  R += rounding;
  float Dm = dot(D, m) + rounding * R;
  float gap = dot(D, D) - R * R;
  float discriminant = Dm * Dm - dot(m, m) * gap;
  float s = gap <= 0.0 ? 0.0 : gap / (Dm + sqrt(max(discriminant, 0.0)));
  bool misses = Dm <= 0.0 || (discriminant < 0.0 && gap > 0.0) || s > 1.0;
  return misses ? 2.0 : s;
}
