#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, first half: sums of the lens-weighted normals (equation 4, corrected) by group. Row 0: live balls and the balls
// that cut, in seven groups; row 1: pairs with those that do not, in one.
#include "common.glsl"

const float kPi = 3.14159265358979;
const float kCapCosine = 0.766;
const float kLargestLens = 0.5;  // mm^3, simulation::kLargestLensVolume

float LensVolume(float r1, float r2, float d) {
  float dr = r1 - r2, least = min(r1, r2), over = r1 + r2 - d;
  float lens = kPi * over * over * (d * d + 2.0 * d * (r1 + r2) - 3.0 * dr * dr) / (12.0 * d);
  float v = d <= abs(dr) ? 4.0 / 3.0 * kPi * least * least * least : lens;
  return over <= 0.0 ? 0.0 : v;
}

// Twin of simulation::PlaneGroup; u in T.
uint PlaneGroup(vec3 u) {
  float x = -u.x, y = -u.y;
  const float root3 = 1.7320508075688772;
  bool above = y >= 0.0, left_of_60 = y >= root3 * x, left_of_120 = y >= -root3 * x;
  uint sector = above ? (left_of_60 ? (left_of_120 ? 2u : 3u) : 1u) : (left_of_120 ? 6u : (left_of_60 ? 4u : 5u));
  return -u.z > kCapCosine ? 0u : sector;
}

// Sums of one group over this invocation's pairs, in whole units: weight and weight·u in `w`, weight·point in `p`, each as
// high * 2^16 + low.
struct Part {
  ivec4 w_high, w_low;
  ivec3 p_high, p_low;
  uint gap;
};
const Part kNone = Part(ivec4(0), ivec4(0), ivec3(0), ivec3(0), 0xffffffffu);

// One pair's share.
struct Pair {
  ivec4 w;
  ivec3 p;
  uint gap;
  uint group;
};
Pair Touch(vec4 ball, vec3 at, float r_t, vec3 origin, mat3 axes, float enlargement, bool shaft) {
  vec3 from_bone = at - ball.xyz;
  float d = length(from_bone);
  float w = min(LensVolume(r_t + enlargement, ball.w, d), kLargestLens);
  vec3 u = from_bone / max(d, 1e-20);
  Pair pair;
  pair.w = ivec4(round(vec4(w, w * u) * kNormalScale));
  pair.p = ivec3(0);
  if (!kOneCutter || shaft) pair.p = ivec3(round(w * (at - r_t * u - origin) * frame.point_scale));
  pair.gap = OrderedBits(d - r_t - ball.w);
  pair.group = shaft ? kShaft : PlaneGroup(u * axes);
  if (w <= 0.0 || d <= 0.0 || ball.w <= 0.0) pair.group = kPlanes;
  return pair;
}

// Adds the pair to a part where it is of that group; by masks, since a software driver executes both sides of a branch.
// With one cutter an invocation looks at 128 pairs at most, whose sum fits 32 bits.
#define GATHER(part, number, pair)                             \
  {                                                            \
    int mask = pair.group == number ? -1 : 0;                  \
    if (kOneCutter && number != kShaft) {                      \
      part.w_low += pair.w & mask;                             \
    } else {                                                   \
      part.w_high += (pair.w >> 16) & mask;                    \
      part.w_low += (pair.w & 0xffff) & mask;                  \
      part.p_high += (pair.p >> 16) & mask;                    \
      part.p_low += (pair.p & 0xffff) & mask;                  \
    }                                                          \
    part.gap = min(part.gap, pair.gap | uint(~mask));          \
  }
#define GATHER_ALL(pair)                                                                                         \
  GATHER(part_0, 0, pair) GATHER(part_1, 1, pair) GATHER(part_2, 2, pair) GATHER(part_3, 3, pair)                \
  GATHER(part_4, 4, pair) GATHER(part_5, 5, pair) GATHER(part_6, 6, pair)

#define ADD_COLUMN(row, column, high_part, low_part) \
  {                                                  \
    int high_sum = subgroupAdd(high_part + (low_part >> 16)); \
    int low_sum = subgroupAdd(low_part & 0xffff);    \
    if (subgroupElect() && (high_sum | low_sum) != 0) { \
      atomicAdd(frame.plane_sums[row + column].high, high_sum);    \
      atomicAdd(frame.plane_sums[row + column].low, uint(low_sum)); \
    }                                                \
  }
#define FLUSH(part, number)                                                   \
  {                                                                           \
    uint gap = subgroupMin(part.gap);                                         \
    for (uint once = gap == 0xffffffffu ? 1 : 0; once < 1; ++once) {          \
      const uint row = number * kPlaneColumns;                                \
      ADD_COLUMN(row, 0, part.w_high.x, part.w_low.x)                         \
      ADD_COLUMN(row, 1, part.w_high.y, part.w_low.y)                         \
      ADD_COLUMN(row, 2, part.w_high.z, part.w_low.z)                         \
      ADD_COLUMN(row, 3, part.w_high.w, part.w_low.w)                         \
      if (!kOneCutter || number == kShaft) {                                  \
        ADD_COLUMN(row, 4, part.p_high.x, part.p_low.x)                       \
        ADD_COLUMN(row, 5, part.p_high.y, part.p_low.y)                       \
        ADD_COLUMN(row, 6, part.p_high.z, part.p_low.z)                       \
      }                                                                       \
      if (subgroupElect()) atomicMin(frame.plane_gap_bits[number], gap);      \
    }                                                                         \
  }

void main() {
  uint row = gl_WorkGroupID.y;
  uint end = row == 0u ? ChunkEnd(frame.live_ball_count) : ChunkEnd(frame.shaft_count);
  // nothing to do: a loop, since software drivers execute a branch that nobody takes
  for (uint once = ChunkBegin() < end ? 0 : 1; once < 1; ++once) {
    float s = ContactFraction(), enlargement = frame.enlargement_mm;
    end = IsVoid() ? 0u : end;
    vec3 origin = OriginAtContact(s);
    mat3 axes = mat3(frame.axis_x.xyz, frame.axis_y.xyz, frame.axis_z.xyz);
    uint end_balls = row == 0u ? end : 0u, end_shaft = row == 1u ? end : 0u;

    Part part_0 = kNone, part_1 = kNone, part_2 = kNone, part_3 = kNone, part_4 = kNone, part_5 = kNone, part_6 = kNone;
    vec4 only = AtContact(0, s);
    for (uint slot = ChunkBegin(); slot < end_balls; slot += kLanes) {
      vec4 ball = LiveBall(slot);
      if (kOneCutter) {
        Pair pair = Touch(ball, only.xyz, only.w, origin, axes, enlargement, false);
        GATHER_ALL(pair)
      } else {
        Live entry = live_entries[slot];
        uint last = entry.first + entry.count;
        for (uint k = entry.first; k < last; ++k) {
          vec4 at = AtContact(spans[k], s);
          Pair pair = Touch(ball, at.xyz, at.w, origin, axes, enlargement, false);
          GATHER_ALL(pair)
        }
      }
    }
    FLUSH(part_0, 0)
    FLUSH(part_1, 1)
    FLUSH(part_2, 2)
    FLUSH(part_3, 3)
    FLUSH(part_4, 4)
    FLUSH(part_5, 5)
    FLUSH(part_6, 6)

    Part part_7 = kNone;
    for (uint slot = ChunkBegin(); slot < end_shaft; slot += kLanes) {
      ShaftPair mine = shaft_pairs[slot];
      vec4 ball = LiveBall(mine.slot);
      uint last = mine.first + mine.count;
      for (uint k = mine.first; k < last; ++k) {
        vec4 at = AtContact(spans[k], s);
        Pair pair = Touch(ball, at.xyz, at.w, origin, axes, enlargement, true);
        GATHER(part_7, kShaft, pair)
      }
    }
    FLUSH(part_7, kShaft)
  }
}
