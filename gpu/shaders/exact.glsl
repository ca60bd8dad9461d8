// Decisions that need double precision: which pair is met first, which is nearest, how far the tool goes, how much a ball
// shrinks. A float test with a margin for its rounding (frame.rounding_mm) comes first and rejects nearly all pairs, so that
// few are tested twice. Equivalent to simulation/contact/cutting_math.h and reference_engine.cpp.

// Converts fractions of a path to keys and back.
#ifdef OSTEON_NO_FLOAT64
// The key of a double-single: the upper word has the bits of its first float, the lower word those of the remainder, in an
// order that counts the sign. A lower word of all ones means that only the upper word is known yet: a remainder as large as any.
Key64 ToKey(double s) {
  uvec2 parts = unpackDouble2x32(s);
  return KeyOf(uvec2(parts.y >> 31u != 0u ? ~parts.y : parts.y | 0x80000000u, parts.x));
}
double FromKey(Key64 key) {
  uvec2 words = WordsOf(key);
  uint rest = words.x == 0xffffffffu ? floatBitsToUint(uintBitsToFloat(words.y) * 5.9604645e-8)  // 2^-24
                                     : words.x >> 31u != 0u ? words.x & 0x7fffffffu : ~words.x;
  return packDouble2x32(uvec2(words.y, rest));
}
#else
Key64 ToKey(double s) { return KeyOf(unpackDouble2x32(s)); }
double FromKey(Key64 key) { return packDouble2x32(WordsOf(key)); }
#endif

// Returns a float that is not less than s.
float AtLeast(double s) { return float(s) * 1.0000003; }

// Converts all four components. In two steps: NVIDIA's driver 580.159 returns the floats' own bits for a single conversion.
dvec4 Exactly(vec4 v) { return dvec4(dvec3(v.xyz), double(v.w)); }
vec4 InFloats(dvec4 v) { return vec4(vec3(v.xyz), float(v.w)); }

// Tool ball t in double precision: floats plus their remainders.
dvec4 ExactStart(uint t) {
  return Exactly(texelFetch(tool_texels, int(2u * t))) + Exactly(texelFetch(tool_texels, int(kToolRemainder + 2u * t)));
}
dvec3 ExactGoal(uint t) {
  return dvec3(texelFetch(tool_texels, int(2u * t + 1u)).xyz) +
         dvec3(texelFetch(tool_texels, int(kToolRemainder + 2u * t + 1u)).xyz);
}
double ExactFraction() { return min(1.0lf, FromKey(frame.contact_key)); }
dvec4 ExactAtContact(uint t, double s) {
  dvec4 start = ExactStart(t);
  return dvec4(start.xyz + s * (ExactGoal(t) - start.xyz), start.w);
}

#ifdef OSTEON_NO_FLOAT64
dvec2 Rounded(dvec2 x) { return floor(x + 0.5lf); }
#else
// Rounds to integers, as additions do: |x| < 2^51.
dvec2 Rounded(dvec2 x) {
  precise dvec2 up = x + 6755399441055744.0lf, whole = up - 6755399441055744.0lf;
  return whole;
}
#endif
dvec4 Rounded(dvec4 x) { return dvec4(Rounded(x.xy), Rounded(x.zw)); }

// Pass 1, one pair.
double ExactFirstContact(dvec3 D, dvec3 m, double R) {
  double Dm = dot(D, m);
  double gap = dot(D, D) - R * R;
  double discriminant = Dm * Dm - dot(m, m) * gap;
  double s = gap <= 0.0lf ? 0.0lf : gap / (Dm + sqrt(max(discriminant, 0.0lf)));
  bool misses = Dm <= 0.0lf || (discriminant < 0.0lf && gap > 0.0lf) || s > 1.0lf;
  return misses ? 2.0lf : s;
}

// The slide to perform: with the turn, or straight where bone keeps the tool from turning (equivalent to
// ReferenceEngine::Frame).
const double kRotationBias_mm = 1e3 * kRotationBias_m;
struct Slide {
  bool turns;
  double share;  // fraction of the way to the target
  double way_mm;  // travel of the tool point that moves farthest
  dvec3 move;  // from the tool's pose to the target; straight: from first contact to the target
};
Slide ChosenSlide() {
  double met = FromKey(frame.slide_key), limit = frame.exact.slide_limit, full = min(limit, met);
  double straight = min(frame.exact.straight_limit, FromKey(frame.straight_key));
  double full_way = full * frame.exact.way, straight_way = straight * frame.exact.straight_way;
  uint turning = frame.turning;
  dvec3 delta = frame.exact.delta, shift = frame.exact.shift;
  bool turns = turning == 0u || SlidesTurning(met < limit, full_way, straight_way, kRotationBias_mm);
  return Slide(turns, turns ? full : straight, turns ? full_way : straight_way, turns ? delta : shift);
}
// Position of a tool ball after the slide, from its position at first contact.
dvec3 AfterSlide(Slide slide, dvec3 at_contact, dvec3 goal) {
  dvec3 target = (slide.turns ? goal : at_contact) + slide.move;
  return at_contact + slide.share * (target - at_contact);
}
