// Pass 2, first half (twin of ReferenceEngine::FindNearField): the nearest pair in each bin of direction, as the least of
// whole-number keys, and lens-weighted sums (equation 4, corrected) around the normals of the faces that pressed the frame
// before. Row 0: live balls and the balls that cut; row 1: pairs with those that do not.
//
// Software drivers skip no branch, so what few pairs need (a sum, a key) stands behind the loop over them, which all lanes leave
// as soon as one of them has such a pair.
#include "pairs.glsl"

const float kPi = 3.14159265358979;
const float kLargestLens = 0.5;   // mm^3, simulation::kLargestLensVolume
const float kFaceCosine = 0.866;  // simulation::kFaceCosine
const float kMiddleWorth_mm = 0.05;  // simulation::kMiddleWorth_m

float LensVolume(float r1, float r2, float d, float per_d) {
  float dr = r1 - r2, least = min(r1, r2), over = r1 + r2 - d;
  float lens = kPi / 12.0 * over * over * (d * d + 2.0 * d * (r1 + r2) - 3.0 * dr * dr) * per_d;
  float v = d <= abs(dr) ? 4.0 / 3.0 * kPi * least * least * least : lens;
  return over <= 0.0 ? 0.0 : v;
}

// Twin of simulation::FindBin; u in T.
struct Bin {
  uint number;
  float off_middle;
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
  return cutting ? Bin(9u * face + 3u * a + b, 1.0 - along * per_length) : Bin(kCuttingBinCount + face, 1.0 - edge);
}

// What all pairs of an invocation share.
struct Near {
  vec3 axis_x, axis_y, axis_z, origin;  // T at the tool's pose
  vec3 face_0, face_1, face_2, face_3;
  float enlargement, face_scale, face_point_scale;
};

vec3 InTool(Near near, vec3 v) { return vec3(dot(v, near.axis_x), dot(v, near.axis_y), dot(v, near.axis_z)); }

// What every pair is asked.
struct Pair {
  vec3 n;
  float d, per_d;
  uint bin, units;  // of the key: its gap, and what its direction costs
  bool near, nearest, in_face;
};
Pair Touch(Near near, vec4 ball, vec4 at, bool cutting) {
  vec3 from_bone = at.xyz - ball.xyz;
  Pair pair;
  pair.d = length(from_bone);
  pair.per_d = 1.0 / max(pair.d, 1e-20);
  pair.n = from_bone * pair.per_d;
  float gap = pair.d - at.w - ball.w;
  pair.near = ball.w > 0.0 && pair.d > 0.0 && gap < near.enlargement;
  Bin bin = FindBin(InTool(near, pair.n), cutting);
  pair.bin = bin.number;
  pair.units = uint(clamp(gap + kMiddleWorth_mm * bin.off_middle + 1.0, 0.0, 1.999) / kGapUnit);
  // the least key so far, or an older one: the upper half of its 64 bits begins with the units
  pair.nearest = pair.near && pair.units <= frame_halves[2u * bin.number + 1u] >> (kBoneBits + kToolBits - 32u);
  float most = max(max(dot(pair.n, near.face_0), dot(pair.n, near.face_1)),
                   max(dot(pair.n, near.face_2), dot(pair.n, near.face_3)));
  pair.in_face = pair.near && most > kFaceCosine;
  return pair;
}
void TakeKey(Pair pair, uint bone, uint t) {
  if (!pair.nearest) return;
  uint64_t key = (uint64_t(pair.units) << (kBoneBits + kToolBits)) | (uint64_t(bone) << kToolBits) | uint64_t(t);
  atomicMin(frame.bin_keys[pair.bin], key);
}

// Sums of one face over this invocation's pairs, in whole units: weight and weight·n, weight·centre and weight·radius. Of 256
// pairs, since no summand reaches 2^23.
const uint kMostSummands = 256u;
struct Part {
  ivec4 n, c;
};
struct Parts {
  Part part_0, part_1, part_2, part_3;
};
const Part kNone = Part(ivec4(0), ivec4(0));
const Parts kNoParts = Parts(kNone, kNone, kNone, kNone);

// `lens`: 0 for a pair that does not count; `alone`: the only cutter's, whose centre is known.
void Gather(inout Part part, Near near, vec3 face, vec3 n, float lens, vec4 center, bool alone) {
  float inside = max(0.0, dot(n, face) - kFaceCosine);
  float w = lens * inside * inside;
  part.n += ivec4(round(vec4(w, w * n) * near.face_scale));
  if (!alone) part.c += ivec4(round(w * center * near.face_point_scale));
}
void GatherAll(inout Parts parts, Near near, Pair pair, float r_b, float r_t, vec3 center, bool alone) {
  float lens = pair.near ? min(LensVolume(r_t + near.enlargement, r_b, pair.d, pair.per_d), kLargestLens) : 0.0;
  Gather(parts.part_0, near, near.face_0, pair.n, lens, vec4(center, r_t), alone);
  Gather(parts.part_1, near, near.face_1, pair.n, lens, vec4(center, r_t), alone);
  Gather(parts.part_2, near, near.face_2, pair.n, lens, vec4(center, r_t), alone);
  Gather(parts.part_3, near, near.face_3, pair.n, lens, vec4(center, r_t), alone);
}

#define FLUSH(part, number)                                       \
  {                                                               \
    uint place = ((shaft ? kFaces : 0u) + number) * kFaceColumns; \
    ADD_TO(frame.face_sums[place], part.n.x)                                   \
    ADD_TO(frame.face_sums[place + 1], part.n.y)                               \
    ADD_TO(frame.face_sums[place + 2], part.n.z)                               \
    ADD_TO(frame.face_sums[place + 3], part.n.w)                               \
    if (!alone) {                                                 \
      ADD_TO(frame.face_sums[place + 4], part.c.x)                             \
      ADD_TO(frame.face_sums[place + 5], part.c.y)                             \
      ADD_TO(frame.face_sums[place + 6], part.c.z)                             \
      ADD_TO(frame.face_sums[place + 7], part.c.w)                             \
    }                                                             \
  }

void AddParts(Parts parts, bool shaft, bool alone) {
  FLUSH(parts.part_0, 0)
  FLUSH(parts.part_1, 1)
  FLUSH(parts.part_2, 2)
  FLUSH(parts.part_3, 3)
}

void FindNearField(uint row) {
  float s = ContactFraction();
  bool go = !IsVoid();
  Near near = Near(frame.axis_x.xyz, frame.axis_y.xyz, frame.axis_z.xyz, frame.goal.xyz, frame.face_n[0].xyz,
                   frame.face_n[1].xyz, frame.face_n[2].xyz, frame.face_n[3].xyz, frame.enlargement_mm, frame.face_scale, frame.face_point_scale);
  if (kOneCutter) {
    vec4 only = AtContact(0, s);
    uint slot = ChunkBegin(), end = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
    while (slot < end) {
      Parts parts = kNoParts;
      for (uint summands = 0u; summands < kMostSummands && slot < end; ++summands) {
        Pair pair;
        vec4 ball;
        uint own = slot;
        bool counts = false;
        while (slot < end && !counts) {
          ball = LiveBall(slot);
          pair = Touch(near, ball, only, true);
          own = slot;
          slot += ChunkStep();
          counts = subgroupAny(pair.nearest || pair.in_face);
        }
        TakeKey(pair, LiveEntry(own).index, 0u);
        GatherAll(parts, near, pair, ball.w, only.w, vec3(0.0), true);
      }
      AddParts(parts, false, true);
    }
  }
  for (uint list = FirstList(row, 1u); list <= LastList(row, 1u); ++list) {
    uint farthest = WordGap(Drift(list == kCutting, s) + near.enlargement);
    Walk walk = BeginWalk(list, 1u, go);
    for (bool more = true; more;) {
      Parts parts = kNoParts;
      for (uint summands = 0u; summands < kMostSummands && more; ++summands) {
        Pair pair;
        vec4 ball, at;
        bool counts = false;
        while (!counts) {
          more = NextPair(walk, farthest);
          if (!more) break;
          ball = LiveBall(walk.slot);
          at = AtContact(ToolOf(walk.word), s);
          pair = Touch(near, ball, at, list == kCutting);
          counts = subgroupAny(pair.nearest || pair.in_face);
        }
        if (!more) break;
        TakeKey(pair, LiveEntry(walk.slot).index, ToolOf(walk.word));
        GatherAll(parts, near, pair, ball.w, at.w, InTool(near, Goal(ToolOf(walk.word)) - near.origin), false);
      }
      AddParts(parts, list == kShaft, false);
    }
  }
}
