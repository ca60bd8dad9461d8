// Pass 1, one pair (equation 3, corrected; twin of simulation/cutting_math.h FirstContactFraction).
float FirstContactFraction(vec3 D, vec3 m, float R) {
  float Dm = dot(D, m);
  if (Dm <= 0.0) return 2.0;
  float gap = dot(D, D) - R * R;
  if (gap <= 0.0) return 0.0;
  float discriminant = Dm * Dm - dot(m, m) * gap;
  if (discriminant < 0.0) return 2.0;
  float s = gap / (Dm + sqrt(discriminant));
  return s <= 1.0 ? s : 2.0;
}
