// Pass 2, first half (twin of ReferenceEngine::FindNearField): the nearest pair in each bin of direction, as the least of
// whole-number keys, and lens-weighted sums (equation 4, corrected) around the normals of the faces that pressed the frame
// before. Row 0: live balls and the balls that cut; row 1: pairs with those that do not.

const double kPi = 3.14159265358979323846lf;
const double kLargestLens = 0.5lf;   // mm^3, simulation::kLargestLensVolume
const float kFaceCosine = 0.866;  // simulation::kFaceCosine
const double kMiddleWorth_mm = 0.05lf;  // simulation::kMiddleWorth_m
const double kExactFaceCosine = 0.866lf;
const float kBinEdge = 1e-5;  // so near to a bin's edge, floats do not tell the side

// Twin of simulation::LensVolume, up to the largest that counts.
double ExactLensVolume(double r1, double r2, double d, double per_d) {
  double dr = r1 - r2, least = min(r1, r2), over = r1 + r2 - d;
  double lens = kPi / 12.0lf * over * over * (d * d + 2.0lf * d * (r1 + r2) - 3.0lf * dr * dr) * per_d;
  double v = d <= abs(dr) ? 4.0lf / 3.0lf * kPi * least * least * least : lens;
  return over <= 0.0lf ? 0.0lf : min(v, kLargestLens);
}

// Twin of simulation::FindBin; u in T.
struct Bin {
  uint number;
  float off_middle;
  float inside;  // how far from the bin's edges, about
};
Bin FindBin(vec3 u, bool cutting) {
  vec3 size = abs(u);
  bool x = size.x >= size.y && size.x >= size.z, y = !x && size.y >= size.z;
  uint axis = x ? 0u : y ? 1u : 2u;
  vec3 v = x ? u : y ? u.yzx : u.zxy;  // the axis first, then the next ones around
  uint face = 2u * axis + (v.x < 0.0 ? 1u : 0u);
  float edge = abs(v.x);
  uint a = 3.0 * v.y < -edge ? 0u : 3.0 * v.y > edge ? 2u : 1u;
  uint b = 3.0 * v.z < -edge ? 0u : 3.0 * v.z > edge ? 2u : 1u;
  float along = edge + 2.0 / 3.0 * ((float(a) - 1.0) * v.y + (float(b) - 1.0) * v.z);
  // 1 / sqrt(1 + 4/9 of the thirds that are off the middle)
  float per_length = a == 1u && b == 1u ? 1.0 : a == 1u || b == 1u ? 0.83205029 : 0.72760688;
  float to_third = min(abs(3.0 * abs(v.y) - edge), abs(3.0 * abs(v.z) - edge)), to_face = edge - max(abs(v.y), abs(v.z));
  return cutting ? Bin(9u * face + 3u * a + b, 1.0 - along * per_length, min(to_third, to_face))
                 : Bin(kCuttingBinCount + face, 1.0 - edge, to_face);
}
struct ExactBin {
  uint number;
  double off_middle;
};
ExactBin FindExactBin(dvec3 u, bool cutting) {
  dvec3 size = abs(u);
  bool x = size.x >= size.y && size.x >= size.z, y = !x && size.y >= size.z;
  uint axis = x ? 0u : y ? 1u : 2u;
  dvec3 v = x ? u : y ? u.yzx : u.zxy;
  uint face = 2u * axis + (v.x < 0.0lf ? 1u : 0u);
  double edge = abs(v.x);
  uint a = 3.0lf * v.y < -edge ? 0u : 3.0lf * v.y > edge ? 2u : 1u;
  uint b = 3.0lf * v.z < -edge ? 0u : 3.0lf * v.z > edge ? 2u : 1u;
  double along = edge + 2.0lf / 3.0lf * ((double(a) - 1.0lf) * v.y + (double(b) - 1.0lf) * v.z);
  double per_length = a == 1u && b == 1u ? 1.0lf : 1.0lf / sqrt(1.0lf + 4.0lf / 9.0lf * (double(a != 1u) + double(b != 1u)));
  return cutting ? ExactBin(9u * face + 3u * a + b, 1.0lf - along * per_length)
                 : ExactBin(kCuttingBinCount + face, 1.0lf - edge);
}

// Sums of one face over this invocation's pairs, in whole units as high * 2^16 + low: weight and weight·n, weight·centre
// and weight·radius.
struct Part {
  dvec4 n;  // whole numbers below 2^53: their sums are exact
  ivec4 c_high, c_low;
};
const Part kNone = Part(dvec4(0.0lf), ivec4(0), ivec4(0));

struct Pair {
  vec3 n;
  bool near;
};

// What all pairs of an invocation share.
struct Near {
  vec3 axis_x, axis_y, axis_z, face_0, face_1, face_2, face_3;
  float enlargement, face_scale, face_point_scale;
  uint faces;
  float rounding;
  // the same exactly, and the only cutter, where there is but one
  double exact_s, exact_enlargement, exact_face_scale;
  dvec3 exact_face_0, exact_face_1, exact_face_2, exact_face_3;
  dvec4 exact_only;
};

// The pair, its key taken to its bin. `bone` is the ball's number, or that of its entry in the list where it is not known yet.
Pair Touch(Near near, vec4 ball, uint bone, bool is_slot, vec3 at, float r_t, uint t, bool cutting) {
  vec3 from_bone = at - ball.xyz;
  float d = length(from_bone), per_d = 1.0 / max(d, 1e-20), gap = d - r_t - ball.w;
  Pair pair = Pair(from_bone * per_d, ball.w > 0.0 && gap < near.enlargement + near.rounding);
  vec3 u = vec3(dot(pair.n, near.axis_x), dot(pair.n, near.axis_y), dot(pair.n, near.axis_z));
  Bin bin = FindBin(u, cutting);
  float least = clamp(gap + float(kMiddleWorth_mm) * bin.off_middle + 1.0 - near.rounding, 0.0, 1.999) / kGapUnit;
  // a loop, since software drivers execute a branch that nobody takes
  bool may = pair.near && (bin.inside < kBinEdge || uint(least) <= uint(frame.bin_keys[bin.number] >> (kBoneBits + kToolBits)));
  for (uint better = may ? 0 : 1; better < 1; ++better) {
    uint own = bone;
    if (is_slot) own = LiveEntry(bone).index;
    dvec4 exact_at = near.exact_only;
    if (!kOneCutter || !cutting) exact_at = ExactAtContact(t, near.exact_s);
    dvec3 exact_from = exact_at.xyz - dvec3(ball.xyz);
    double exact_dd = dot(exact_from, exact_from), per_exact_d = InverseRoot(max(exact_dd, 1e-30lf)), exact_d = exact_dd * per_exact_d, exact_gap = exact_d - exact_at.w - double(ball.w);
    if (exact_d <= 0.0lf || exact_gap >= near.exact_enlargement) continue;
    dvec3 n = exact_from * per_exact_d;
    ExactBin exact_bin = FindExactBin(dvec3(dot(n, dvec3(near.axis_x)), dot(n, dvec3(near.axis_y)), dot(n, dvec3(near.axis_z))), cutting);
    uint units = uint(clamp(exact_gap + kMiddleWorth_mm * exact_bin.off_middle + 1.0lf, 0.0lf, 1.999lf) / double(kGapUnit));
    atomicMin(frame.bin_keys[exact_bin.number],
              (uint64_t(units) << (kBoneBits + kToolBits)) | (uint64_t(own) << kToolBits) | uint64_t(t));
  }
  return pair;
}

// The pair's share of a face's sums.
#define GATHER(part, number, t)                                                                    \
  {                                                                                                \
    double inside = max(0.0lf, dot(n, near.exact_face_##number) - kExactFaceCosine);             \
    double w = lens * inside * inside;                                                             \
    part.n += Rounded(dvec4(w, w * n) * near.exact_face_scale);                       \
    if (!kOneCutter || shaft) {                                                                    \
      ivec4 own = ivec4(round(float(w) * vec4(CenterInTool(t), float(from.w)) * near.face_point_scale)); \
      part.c_high += own >> 16;                                                                    \
      part.c_low += own & 0xffff;                                                                  \
    }                                                                                              \
  }
// Of the pairs near the tool, few are in a face's cone.
#define GATHER_ALL(pair, ball, t)                                                                              \
  {                                                                                                            \
    float inside = max(dot(pair.n, near.face_0), max(dot(pair.n, near.face_1), max(dot(pair.n, near.face_2), dot(pair.n, near.face_3)))); \
    for (uint some = pair.near && inside > kFaceCosine - kBinEdge ? 0 : 1; some < 1; ++some) {                 \
      dvec4 from = near.exact_only;                                                                            \
      if (!kOneCutter || shaft) from = ExactAtContact(t, near.exact_s);                                        \
      dvec3 n = from.xyz - dvec3(ball.xyz);                                                                    \
      double dd = dot(n, n), per_d = InverseRoot(max(dd, 1e-30lf)), d = dd * per_d;                            \
      double lens = ExactLensVolume(from.w + near.exact_enlargement, double(ball.w), d, per_d);              \
      n *= per_d;                                                                            \
      GATHER(part_0, 0, t)                                                                                        \
      for (uint more = near.faces > 1u ? 0 : 1; more < 1; ++more) {                                            \
        GATHER(part_1, 1, t)                                                                                      \
        GATHER(part_2, 2, t)                                                                                      \
        GATHER(part_3, 3, t)                                                                                      \
      }                                                                                                        \
    }                                                                                                          \
  }

#define ADD_COLUMN(place, high_part, low_part)                    \
  {                                                               \
    int high_sum = subgroupAdd(high_part + (low_part >> 16));     \
    int low_sum = subgroupAdd(low_part & 0xffff);                 \
    if (subgroupElect() && (high_sum | low_sum) != 0) {           \
      atomicAdd(frame.face_sums[place].high, high_sum);           \
      atomicAdd(frame.face_sums[place].low, uint(low_sum));       \
    }                                                             \
  }
#define FLUSH(part, number)                                                  \
  {                                                                          \
    uint face = (shaft ? kFaces : 0u) + number, place = face * kFaceColumns; \
    for (uint some = subgroupAny(part.n.x != 0.0lf) ? 0 : 1; some < 1; ++some) {     \
      ADD_FINE(frame.exact.face_sums[4 * face], int64_t(part.n.x))                    \
      ADD_FINE(frame.exact.face_sums[4 * face + 1], int64_t(part.n.y))                \
      ADD_FINE(frame.exact.face_sums[4 * face + 2], int64_t(part.n.z))                \
      ADD_FINE(frame.exact.face_sums[4 * face + 3], int64_t(part.n.w))                \
      if (!kOneCutter || shaft) {                                            \
        ADD_COLUMN(place, part.c_high.x, part.c_low.x)                       \
        ADD_COLUMN(place + 1, part.c_high.y, part.c_low.y)                   \
        ADD_COLUMN(place + 2, part.c_high.z, part.c_low.z)                   \
        ADD_COLUMN(place + 3, part.c_high.w, part.c_low.w)                   \
      }                                                                      \
    }                                                                        \
  }
#define FLUSH_ALL FLUSH(part_0, 0) FLUSH(part_1, 1) FLUSH(part_2, 2) FLUSH(part_3, 3)

void FindNearField(uint row) {
  uint end_balls = Takes(row, 0u) ? ChunkEnd(frame.live_ball_count) : 0u;
  uint end_shaft = Takes(row, 1u) ? ChunkEnd(frame.shaft_count) : 0u;
  // nothing to do: a loop, since software drivers execute a branch that nobody takes
  for (uint once = ChunkBegin() < max(end_balls, end_shaft) && !IsVoid() ? 0 : 1; once < 1; ++once) {
    float s = ContactFraction();
    Near near = Near(frame.axis_x.xyz, frame.axis_y.xyz, frame.axis_z.xyz, frame.face_n[0].xyz, frame.face_n[1].xyz,
                     frame.face_n[2].xyz, frame.face_n[3].xyz, frame.enlargement_mm, frame.face_scale,
                     frame.face_point_scale, frame.face_count, frame.rounding_mm, ExactFraction(), frame.exact.enlargement,
                     kFiner * double(frame.face_scale), frame.exact.face_n[0], frame.exact.face_n[1], frame.exact.face_n[2],
                     frame.exact.face_n[3], ExactAtContact(0, ExactFraction()));
    Part part_0 = kNone, part_1 = kNone, part_2 = kNone, part_3 = kNone;
    {
      const bool shaft = false;
      vec4 only = AtContact(0, s);
      for (uint slot = ChunkBegin(); slot < end_balls; slot += ChunkStep()) {
        vec4 ball = LiveBall(slot);
        if (kOneCutter) {
          Pair pair = Touch(near, ball, slot, true, only.xyz, only.w, 0u, true);
          GATHER_ALL(pair, ball, 0u)
        } else {
          Live entry = LiveEntry(slot);
          uint last = entry.first + entry.count;
          for (uint k = entry.first; k < last; ++k) {
            uint t = ToolOfSpan(k);
            vec4 at = AtContact(t, s);
            Pair pair = Touch(near, ball, entry.index, false, at.xyz, at.w, t, true);
            GATHER_ALL(pair, ball, t)
          }
        }
      }
      FLUSH_ALL
    }
    part_0 = part_1 = part_2 = part_3 = kNone;
    {
      const bool shaft = true;
      for (uint slot = ChunkBegin(); slot < end_shaft; slot += ChunkStep()) {
        ShaftPair mine = shaft_pairs[slot];
        vec4 ball = LiveBall(mine.slot);
        uint bone = LiveEntry(mine.slot).index;
        uint last = mine.first + mine.count;
        for (uint k = mine.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 at = AtContact(t, s);
          Pair pair = Touch(near, ball, bone, false, at.xyz, at.w, t, false);
          GATHER_ALL(pair, ball, t)
        }
      }
      FLUSH_ALL
    }
  }
}
