#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, first half (equivalent to ReferenceEngine::FindNearField): the nearest pair in each bin of direction, as the smallest
// integer key, and lens-weighted sums (equation 4, corrected) around the normals of the faces that pressed in the frame before.
// Row 0: listed balls with the cutting balls; row 1: pairs with balls that do not cut.
//
// Software drivers execute both sides of a branch. Work that few pairs need (a sum, a key) therefore follows the loop over the
// pairs, which all lanes leave as soon as one of them has such a pair. On a GPU a workgroup combines its keys and sums first,
// and the last workgroup solves.
#include "common.glsl"
#include "pairs.glsl"
#include "solve.glsl"

const double kPi = 3.14159265358979323846lf;
const double kMaxLens_mm3 = 1e9 * kMaxLensVolume;
const double kBinCentreBias_mm = 1e3 * kBinCentreBias_m;
const float kDirectionRounding = 1e-5;  // rounding of a cosine in floats: nearer to a bin's edge, floats cannot decide the side

// Equivalent to simulation::LensVolume, up to the largest volume that counts.
double LensVolume(double r1, double r2, double d) {
  double dr = r1 - r2, min_radius = min(r1, r2), over = r1 + r2 - d;
  double lens = kPi / 12.0lf * over * over * (d * d + 2.0lf * d * (r1 + r2) - 3.0lf * dr * dr) / max(d, 1e-20lf);
  double v = d <= abs(dr) ? 4.0lf / 3.0lf * kPi * min_radius * min_radius * min_radius : lens;
  return over <= 0.0lf ? 0.0lf : min(v, kMaxLens_mm3);
}

// FindBin and FindExactBin are equivalent to simulation::FindBin; u in T. FindBin computes in floats, and gives the approximate
// distance of the direction from another bin. FindExactBin computes in double precision.
struct Bin {
  uint number;
  float off_centre, inside;
};
Bin FindBin(vec3 u, bool cutting) {
  vec3 size = abs(u);
  bool x = size.x >= size.y && size.x >= size.z, y = !x && size.y >= size.z;
  uint axis = x ? 0u : y ? 1u : 2u;
  vec3 v = x ? u : y ? u.yzx : u.zxy;  // the main axis first, then the next ones in cyclic order
  uint face = 2u * axis + (v.x < 0.0 ? 1u : 0u);
  float edge = abs(v.x), to_face = edge - max(abs(v.y), abs(v.z));
  uint a = 3.0 * v.y < -edge ? 0u : 3.0 * v.y > edge ? 2u : 1u;
  uint b = 3.0 * v.z < -edge ? 0u : 3.0 * v.z > edge ? 2u : 1u;
  float to_third = min(abs(3.0 * abs(v.y) - edge), abs(3.0 * abs(v.z) - edge));
  float along = edge + 2.0 / 3.0 * ((float(a) - 1.0) * v.y + (float(b) - 1.0) * v.z);
  // 1 / sqrt(1 + 4/9 times the number of thirds off the centre)
  float per_length = a == 1u && b == 1u ? 1.0 : a == 1u || b == 1u ? 0.83205029 : 0.72760688;
  return cutting ? Bin(9u * face + 3u * a + b, 1.0 - along * per_length, min(to_face, to_third))
                 : Bin(kCuttingBinCount + face, 1.0 - edge, to_face);
}
struct ExactBin {
  uint number;
  double off_centre;
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
  // 1 / sqrt(1 + 4/9 times the number of thirds off the centre)
  double per_length = a == 1u && b == 1u   ? 1.0lf
                      : a == 1u || b == 1u ? 0.83205029433784368302lf
                                           : 0.72760687510899891329lf;
  return cutting ? ExactBin(9u * face + 3u * a + b, 1.0lf - along * per_length)
                 : ExactBin(kCuttingBinCount + face, 1.0lf - edge);
}

// Values shared by all pairs of an invocation.
struct Near {
  vec3 axis_x, axis_y, axis_z, origin;  // frame T at the tool's pose
  vec3 face_0, face_1, face_2, face_3;
  float enlargement, face_point_scale, rounding;
  // in double precision
  double exact_enlargement, face_scale;
  dvec3 exact_x, exact_y, exact_z, exact_face_0, exact_face_1, exact_face_2, exact_face_3;
};

vec3 InTool(Near near, vec3 v) { return vec3(dot(v, near.axis_x), dot(v, near.axis_y), dot(v, near.axis_z)); }

// Result of the float test of a pair: whether it may be the nearest of its bin, or in a face's cone.
struct Pair {
  bool nearest, in_face;
};
Pair TestPair(Near near, vec4 ball, vec4 at, bool cutting) {
  vec3 from_bone = at.xyz - ball.xyz;
  float d = length(from_bone), gap = d - at.w - ball.w;
  vec3 n = from_bone * (1.0 / max(d, 1e-20));
  bool is_near = ball.w > 0.0 && gap < near.enlargement + near.rounding;
  Bin bin = FindBin(InTool(near, n), cutting);
  float score = gap + float(kBinCentreBias_mm) * bin.off_centre - near.rounding;
  uint units = KeptUnits(ScoreUnits(score), kBoneBits);
  float max_cosine = max(max(dot(n, near.face_0), dot(n, near.face_1)), max(dot(n, near.face_2), dot(n, near.face_3)));
  // the smallest key so far, or an older one: the upper half of its 64 bits begins with the units
  return Pair(is_near && (bin.inside < kDirectionRounding ||
                          units <= UnitsOfHalf(frame_halves[2u * bin.number + 1u], kBoneBits)),
              kLowerWords && is_near && max_cosine > float(kFaceCosine) - kDirectionRounding);
}

// A pair in double precision.
struct ExactPair {
  dvec3 n;
  double d, gap;
};
ExactPair MeasurePair(vec4 ball, dvec4 at) {
  dvec3 from_bone = at.xyz - dvec3(ball.xyz);
  double d = length(from_bone);
  return ExactPair((1.0lf / max(d, 1e-20lf)) * from_bone, d, d - at.w - double(ball.w));
}
// On a processor, where both sides of a branch are executed, keys are written in a loop after the one that finds the pairs.
const bool kKeysApart = !kOnGpu;
// On a GPU an invocation keeps its last key until the workgroup combines its keys, since atomic operations on one address are
// serialised.
struct Waiting {
  uint bin;
  Key64 key;
} waiting;
void AtomicMinKey(Near near, ExactPair exact, bool cutting, uint bone, uint t) {
  if (exact.d <= 0.0lf || exact.gap >= near.exact_enlargement) return;
  ExactBin bin =
      FindExactBin(dvec3(dot(exact.n, near.exact_x), dot(exact.n, near.exact_y), dot(exact.n, near.exact_z)), cutting);
  uint units = ScoreUnits(exact.gap + kBinCentreBias_mm * bin.off_centre);
  // other invocations may have found nearer pairs since
  if (kKeysApart && KeptUnits(units, kBoneBits) > UnitsOfHalf(frame_halves[2u * bin.number + 1u], kBoneBits)) return;
  Key64 key = BinKey(units, bone, t, kBoneBits);
  if (!kOnGpu) {
    MIN_KEY(frame.bin_keys[bin.number], key)
  } else if (bin.number == waiting.bin) {
    waiting.key = Smaller(waiting.key, key);
  } else {
    if (waiting.bin < kBins) MIN_KEY(frame.bin_keys[waiting.bin], waiting.key)
    waiting = Waiting(bin.number, key);
  }
}
// Writes the smallest key of a workgroup per bin: the units decide first. Called by all its invocations.
shared uint min_units[kBins];
void ReduceKeys() {
  if (gl_LocalInvocationID.x < kBins) min_units[gl_LocalInvocationID.x] = 0xffffffffu;
  barrier();
  bool waits = waiting.bin < kBins;
  uint units = UnitsOfKey(waiting.key, kBoneBits);
  if (waits) atomicMin(min_units[waiting.bin], units);
  barrier();
  if (waits && units == min_units[waiting.bin]) MIN_KEY(frame.bin_keys[waiting.bin], waiting.key)
}

// Sums of one face over this invocation's pairs, as integers: weight and weight·n (doubles hold integers up to 2^53),
// weight·centre and weight·radius. At most 256 pairs, since every summand is below 2^44 or 2^23.
const uint kMaxSummands = 256u;
struct Part {
  dvec4 n;
  ivec4 c;
};
struct Parts {
  Part part_0, part_1, part_2, part_3;
};
const Part kNone = Part(dvec4(0.0lf), ivec4(0));
const Parts kNoParts = Parts(kNone, kNone, kNone, kNone);

// Whether a face did not press. Only on a GPU, where the branch is uniform and can be skipped.
bool IsIdle(vec3 face) { return kOnGpu && face == vec3(0.0); }

// Adds a pair to a face's sums. `lens`: 0 for a pair that does not count; `alone`: the only cutting ball's pair, whose centre
// is known.
void AddToPart(inout Part part, Near near, dvec3 face, dvec3 n, double lens, vec4 center, bool alone) {
  double inside = max(0.0lf, dot(n, face) - kFaceCosine);
  double w = lens * inside * inside;
  part.n += Rounded(dvec4(w, w * n) * near.face_scale);
  if (!alone) part.c += ivec4(round(float(w) * center * near.face_point_scale));
}
void AddToFaces(inout Parts parts, Near near, ExactPair exact, float r_b, double r_t, vec3 center, bool alone) {
  double lens = LensVolume(r_t + near.exact_enlargement, double(r_b), exact.d);
  if (!IsIdle(near.face_0)) AddToPart(parts.part_0, near, near.exact_face_0, exact.n, lens, vec4(center, r_t), alone);
  if (!IsIdle(near.face_1)) AddToPart(parts.part_1, near, near.exact_face_1, exact.n, lens, vec4(center, r_t), alone);
  if (!IsIdle(near.face_2)) AddToPart(parts.part_2, near, near.exact_face_2, exact.n, lens, vec4(center, r_t), alone);
  if (!IsIdle(near.face_3)) AddToPart(parts.part_3, near, near.exact_face_3, exact.n, lens, vec4(center, r_t), alone);
}

#define FLUSH(part, number)                                                  \
  {                                                                          \
    uint face = (shaft ? kFaces : 0u) + number, place = face * kFaceColumns; \
    ADD_FINE(frame.exact.face_sums[4 * face], SumOf(part.n.x))             \
    ADD_FINE(frame.exact.face_sums[4 * face + 1], SumOf(part.n.y))         \
    ADD_FINE(frame.exact.face_sums[4 * face + 2], SumOf(part.n.z))         \
    ADD_FINE(frame.exact.face_sums[4 * face + 3], SumOf(part.n.w))         \
    if (!alone) {                                                            \
      ADD_TO(frame.face_sums[place], part.c.x)                               \
      ADD_TO(frame.face_sums[place + 1], part.c.y)                           \
      ADD_TO(frame.face_sums[place + 2], part.c.z)                           \
      ADD_TO(frame.face_sums[place + 3], part.c.w)                           \
    }                                                                        \
  }

void AddParts(Parts parts, bool shaft, bool alone) {
  FLUSH(parts.part_0, 0)
  FLUSH(parts.part_1, 1)
  FLUSH(parts.part_2, 2)
  FLUSH(parts.part_3, 3)
}

// AddPartsOfGroup adds the parts on a GPU, called by a whole workgroup. Few of its invocations have a contribution; these are
// noted in shared memory and added up, so that one atomic addition serves all. (Atomic additions of each subgroup to one address
// are serialised and take 8 us.)
const uint kNotes = 64u;  // number of contributions that are noted at a time
shared double part_notes[kNotes][4u * kFaces];
shared uint note_count;
shared double part_totals[16][4u * kFaces];
void NoteAll(uint place, dvec4 a, dvec4 b, dvec4 c, dvec4 d) {
  double all[4u * kFaces] = double[](a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w, d.x, d.y, d.z, d.w);
  for (uint i = 0u; i < 4u * kFaces; ++i) part_notes[place][i] = all[i];
}
// Total of column lane % 16, in the first 16 invocations. Integers: their order does not matter.
double NotesTotal(uint count) {
  uint lane = gl_LocalInvocationID.x, column = lane % 16u, row = lane / 16u;
  double sum = 0.0lf;
  for (uint i = row; i < count; i += kLanes / 16u) sum += part_notes[i][column];
  part_totals[row][column] = sum;
  barrier();
  double total = 0.0lf;
  for (uint i = 0u; i < kLanes / 16u; ++i) total += part_totals[i][column];
  return total;
}
void AddPartsOfGroup(Parts parts, bool shaft, bool alone) {
  uint lane = gl_LocalInvocationID.x, place = (shaft ? 4u * kFaces : 0u) + lane;
  bool any = parts.part_0.n.x + parts.part_1.n.x + parts.part_2.n.x + parts.part_3.n.x > 0.0lf;
  if (lane == 0u) note_count = 0u;
  barrier();
  uint own = any ? atomicAdd(note_count, 1u) : 0u;
  barrier();
  uint count = note_count;
  for (uint first = 0u; first < count; first += kNotes) {
    uint here = min(count - first, kNotes);
    bool notes = any && own >= first && own < first + kNotes;
    if (notes) NoteAll(own - first, parts.part_0.n, parts.part_1.n, parts.part_2.n, parts.part_3.n);
    barrier();
    double total = NotesTotal(here);
    if (lane < 4u * kFaces && total != 0.0lf) ADD_SUM(frame.exact.face_sums[place], SumOf(total))
    if (!alone) {
      barrier();
      if (notes)
        NoteAll(own - first, dvec4(parts.part_0.c), dvec4(parts.part_1.c), dvec4(parts.part_2.c), dvec4(parts.part_3.c));
      barrier();
      Sum64 c = SumOf(NotesTotal(here));
      if (lane < 4u * kFaces && c != kNoSum) {
        atomicAdd(frame.face_sums[place].high, BitsFrom(c, 16u));
        atomicAdd(frame.face_sums[place].low, uint(BitsFrom(c, 0u)) & 0xffffu);
      }
    }
    barrier();
  }
}

// Notes a pair; marked where it may be the nearest of its bin.
void NoteIf(Pair pair, uint slot, uint t) {
  if (pair.nearest || pair.in_face) Note(slot, t, pair.nearest);
}

void main() {
  uint row = Row();
  double exact_s = ExactFraction();
  float s = float(exact_s);
  bool go = !NeedsRebuild();
  Near near;
  near.axis_x = frame.axis_x.xyz;
  near.axis_y = frame.axis_y.xyz;
  near.axis_z = frame.axis_z.xyz;
  near.origin = frame.goal.xyz;
  near.face_0 = frame.face_n[0].xyz;
  near.face_1 = frame.face_n[1].xyz;
  near.face_2 = frame.face_n[2].xyz;
  near.face_3 = frame.face_n[3].xyz;
  near.enlargement = frame.enlargement_mm;
  near.face_point_scale = frame.face_point_scale;
  near.rounding = frame.rounding_mm;
  near.exact_enlargement = frame.exact.enlargement;
  near.face_scale = kUnitSubdivision * double(frame.face_scale);
  near.exact_x = dvec3(near.axis_x);  // the bins' axes are defined by the floats
  near.exact_y = dvec3(near.axis_y);
  near.exact_z = dvec3(near.axis_z);
  near.exact_face_0 = frame.exact.face_n[0];
  near.exact_face_1 = frame.exact.face_n[1];
  near.exact_face_2 = frame.exact.face_n[2];
  near.exact_face_3 = frame.exact.face_n[3];
  Parts parts = kNoParts;
  waiting = Waiting(kBins, kNoKey);
  if (kOneCutter) {
    vec4 only = AtContact(0, s);
    dvec4 exact_only = ExactAtContact(0, exact_s);
    uint slot = FirstEntry(), end = row == 0u && go ? frame.live_ball_count : 0u;
    while (slot < end) {
      for (uint summands = 0u; summands < kMaxSummands && slot < end; summands += kRoom) {
        found.count = 0u;
        for (; found.count < kRoom && slot < end; slot += EntryStep())
          NoteIf(TestPair(near, LiveBall(slot), only, true), slot, 0u);
        for (uint i = 0u; kKeysApart && NextMarked(i); ++i)
          AtomicMinKey(near, MeasurePair(LiveBall(found.slot[InRoom(i)]), exact_only), true, LiveEntry(found.slot[InRoom(i)]).index, 0u);
        for (uint i = 0u; i < found.count; ++i) {
          vec4 ball = LiveBall(found.slot[InRoom(i)]);
          ExactPair exact = MeasurePair(ball, exact_only);
          if (!kKeysApart && IsMarked(i)) AtomicMinKey(near, exact, true, LiveEntry(found.slot[InRoom(i)]).index, 0u);
          if (kLowerWords) AddToFaces(parts, near, exact, ball.w, exact_only.w, vec3(0.0), true);
        }
      }
      if (kOnGpu && slot >= end) break;
      AddParts(parts, false, true);
      parts = kNoParts;
    }
  }
  for (uint list = FirstList(row, 1u); list <= LastList(row, 1u); ++list) {
    uint farthest = PackedGapLimit(Displacement(list == kCutting, s) + near.enlargement);
    Walk walk = BeginWalk(list, go);
    for (bool more = true; more;) {
      for (uint summands = 0u; summands < kMaxSummands && more; summands += kRoom) {
        found.count = 0u;
        while (found.count < kRoom) {
          more = NextPair(walk, farthest);
          if (!more) break;
          uint t = ToolOf(walk.pair);
          NoteIf(TestPair(near, LiveBall(walk.slot), AtContact(t, s), list == kCutting), walk.slot, t);
        }
        for (uint i = 0u; kKeysApart && NextMarked(i); ++i) {
          uint t = ToolOf(found.what[InRoom(i)]);
          AtomicMinKey(near, MeasurePair(LiveBall(found.slot[InRoom(i)]), ExactAtContact(t, exact_s)), list == kCutting,
                  LiveEntry(found.slot[InRoom(i)]).index, t);
        }
        for (uint i = 0u; i < found.count; ++i) {
          uint t = ToolOf(found.what[InRoom(i)]);
          vec4 ball = LiveBall(found.slot[InRoom(i)]);
          dvec4 exact_at = ExactAtContact(t, exact_s);
          ExactPair exact = MeasurePair(ball, exact_at);
          if (!kKeysApart && IsMarked(i)) AtomicMinKey(near, exact, list == kCutting, LiveEntry(found.slot[InRoom(i)]).index, t);
          if (kLowerWords) AddToFaces(parts, near, exact, ball.w, exact_at.w, InTool(near, Goal(t) - near.origin), false);
        }
      }
      if (kOnGpu && !more) break;
      AddParts(parts, list == kShaft, false);
      parts = kNoParts;
    }
  }
  if (!kOnGpu) return;
  ReduceKeys();
  if (!kLowerWords) return;
  AddPartsOfGroup(parts, row == 1u, kOneCutter && row == 0u);
  if (IsLastGroup()) Solve();
}
