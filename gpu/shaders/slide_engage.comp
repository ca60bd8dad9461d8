#version 460
#extension GL_GOOGLE_include_directive : require
// Rows 0 (cutting balls) and 2 (balls that do not cut), the slide: pass 1 again, from first contact to the constrained target.
// Pairs that overlap by less than the tolerance may move to an overlap of that size; otherwise a tool would catch on every ball
// that protrudes from a smooth wall. Row 1, engaged area: volume of the mass points within a layer of the cutting surface over
// the layer's depth, projected on the plane normal to the force (equivalent to ReferenceEngine::MeasureEngagement).
#include "common.glsl"
#include "first_contact.glsl"
#include "pairs.glsl"

#define GATHER_MATERIAL(number) if (kMaterials > number) sum_##number += material == number ? units : dvec2(0.0lf);
#define FLUSH_MATERIAL(number)                                             \
  if (kMaterials > number) {                                               \
    ADD_FINE(frame.exact.engaged[2 * number], SumOf(sum_##number.x))     \
    ADD_FINE(frame.exact.engaged[2 * number + 1], SumOf(sum_##number.y)) \
  }

// The frame's slide, with the turn and straight, and its first contact, in double precision and as a float that is not less.
struct FirstHit {
  bool turning;
  float turn_tolerance, tolerance, rounding;
  vec3 delta, shift;
  double exact_turn_tolerance, exact_tolerance;
  dvec3 exact_delta, exact_shift;
  double s, straight;
  float first, first_straight;
};
// True where the pair may be met before the first contact found so far.
bool MayHit(FirstHit hit, vec4 ball, vec4 at, vec3 goal) {
  vec3 D = ball.xyz - at.xyz;
  float R = at.w + ball.w;
  return ball.w > 0.0 &&
         (EarliestContact(D, goal + hit.delta - at.xyz, R - hit.turn_tolerance, hit.rounding) < hit.first ||
          (hit.turning && EarliestContact(D, hit.shift, R - hit.tolerance, hit.rounding) < hit.first_straight));
}
void UpdateFirstHit(inout FirstHit hit, vec4 ball, dvec4 at, dvec3 goal) {
  dvec3 D = dvec3(ball.xyz) - at.xyz;
  double R = at.w + double(ball.w);
  hit.s = min(hit.s, ExactFirstContact(D, goal + hit.exact_delta - at.xyz, R - hit.exact_turn_tolerance));
  hit.straight = min(hit.straight, ExactFirstContact(D, hit.exact_shift, R - hit.exact_tolerance));
  hit.first = AtLeast(hit.s);
  hit.first_straight = AtLeast(hit.straight);
}

#define SHARE_MATERIAL(number)                   \
  if (kMaterials > number) {                     \
    SHARE(2u * number, SumOf(sum_##number.x))     \
    SHARE(2u * number + 1u, SumOf(sum_##number.y)) \
  }

// Finds the slide, in rows 0 and 2.
void FindSlide(uint row, bool go, double exact_s) {
  float at_contact = float(exact_s), rounding = frame.rounding_mm;
  vec4 only = AtContact(0, at_contact);  // the only cutting ball, where there is one
  dvec4 exact_only = ExactAtContact(0, exact_s);
  // with a turn, which may use a share of the tolerance; and straight
  FirstHit hit;
  hit.turning = frame.turning != 0u;
  hit.tolerance = frame.tolerance_mm;
  hit.turn_tolerance = hit.turning ? float(kTurnToleranceShare) * hit.tolerance : hit.tolerance;
  hit.rounding = rounding;
  hit.delta = frame.delta.xyz;
  hit.shift = frame.shift_mm.xyz;
  hit.exact_tolerance = frame.exact.tolerance;
  hit.exact_turn_tolerance = hit.turning ? kTurnToleranceShare * hit.exact_tolerance : hit.exact_tolerance;
  hit.exact_delta = frame.exact.delta;
  hit.exact_shift = frame.exact.shift;
  hit.s = hit.straight = 2.0lf;
  hit.first = hit.first_straight = 2.0;
  if (kOneCutter) {
    uint slot = FirstEntry(), end = row == 0u && go ? frame.live_ball_count : 0u;
    vec3 goal = Goal(0);
    dvec3 exact_goal = ExactGoal(0);
    while (slot < end) {
      vec4 ball;
      bool may = false, any = false;
      while (slot < end && !any) {
        ball = LiveBall(slot);
        may = MayHit(hit, ball, only, goal);
        any = subgroupAny(may);
        slot += EntryStep();
      }
      if (may) UpdateFirstHit(hit, ball, exact_only, exact_goal);
    }
  }
  // upper limit of a tool ball's travel
  float way = float(max(frame.exact.slide_limit * frame.exact.way, frame.exact.straight_limit * frame.exact.straight_way));
  for (uint list = FirstList(row, 2u); list <= LastList(row, 2u); ++list) {
    uint farthest = PackedGapLimit(Displacement(list == kCutting, at_contact) + way);
    Walk walk = BeginWalk(list, go && row != 1u);
    for (bool more = true; more;) {
      vec4 ball;
      bool may = false;
      while (!may) {
        more = NextPair(walk, farthest);
        if (!more) break;
        ball = LiveBall(walk.slot);
        may = MayHit(hit, ball, AtContact(ToolOf(walk.pair), at_contact), Goal(ToolOf(walk.pair)));
      }
      if (may) UpdateFirstHit(hit, ball, ExactAtContact(ToolOf(walk.pair), exact_s), ExactGoal(ToolOf(walk.pair)));
    }
  }
  double s = subgroupMin(hit.s), straight = subgroupMin(hit.straight);
  if (subgroupElect()) {
    if (s < 2.0lf) MIN_KEY(frame.slide_key, ToKey(s))
    if (straight < 2.0lf) MIN_KEY(frame.straight_key, ToKey(straight))
  }
}

void main() {
  uint row = Row();
  bool go = frame.needs_rebuild == 0u;
  double exact_s = ExactFraction();
  float at_contact = float(exact_s), rounding = frame.rounding_mm;
  vec4 only = AtContact(0, at_contact);  // the only cutting ball, where there is one
  dvec4 exact_only = ExactAtContact(0, exact_s);
  // a GPU skips the work of other rows
  if (!kOnGpu || row != 1u) FindSlide(row, go, exact_s);
  if ((kOnGpu && row != 1u) || !kLowerWords) return;

  double exact_layer = frame.exact.layer, per_layer = 1.0lf / exact_layer;
  double area_scale = kUnitSubdivision * double(frame.area_scale), moment_scale = kUnitSubdivision * double(frame.moment_scale);
  dvec3 n = frame.exact.n, axis = frame.exact.axis, start = frame.exact.start,
        origin = start + exact_s * (frame.exact.goal - start);
  float layer = frame.layer_mm;
  uint slot = FirstEntry(), end = row == 1u && go && frame.delta.w > 0.0 ? frame.live_point_count : 0u;
  // integers below 2^53: their sums are exact
  dvec2 sum_0 = dvec2(0.0lf), sum_1 = sum_0, sum_2 = sum_0, sum_3 = sum_0, sum_4 = sum_0, sum_5 = sum_0, sum_6 = sum_0,
        sum_7 = sum_0;
  while (slot < end) {
    // the nearest tool ball of each point that may be in the layer; marked where floats cannot decide which one it is
    found.count = 0u;
    for (; found.count < kRoom && slot < end; slot += EntryStep()) {
      vec4 point = LivePoint(slot);
      ListEntry entry = PointEntry(slot);
      float nearest = layer + rounding, next = nearest;
      uint of = 0u, last = entry.first + (kOneCutter ? 1u : entry.count);
      uvec4 pairs = uvec4(0u);
      for (uint k = entry.first; k < last; ++k) {
        vec4 at = only;
        if (!kOneCutter) {
          pairs = k % 4u == 0u ? PackedPairsAt(k) : pairs.yzwx;
          at = AtContact(ToolOf(pairs.x), at_contact);
        }
        float gap = distance(point.xyz, at.xyz) - at.w;
        gap = gap > -layer - rounding ? gap : layer + rounding;
        of = gap < nearest ? ToolOf(pairs.x) : of;
        next = min(next, max(gap, nearest));
        nearest = min(nearest, gap);
      }
      if (point.w > 0.0 && nearest < layer + rounding)  // a negative volume marks a cleared point
        Note(slot, of, next - nearest < 2.0 * rounding || nearest < 2.0 * rounding - layer);
    }
    for (uint i = 0u; !kOneCutter && NextMarked(i); ++i) {
      vec4 point = LivePoint(found.slot[InRoom(i)]);
      ListEntry entry = PointEntry(found.slot[InRoom(i)]);
      double nearest = exact_layer;
      uint of = ToolOf(found.what[InRoom(i)]);
      for (uint k = entry.first; k < entry.first + entry.count; ++k) {
        uint t = ToolOf(PackedPairAt(k));
        dvec4 at = ExactAtContact(t, exact_s);
        double gap = length(dvec3(point.xyz) - at.xyz) - at.w;
        bool nearer = abs(gap) < exact_layer && gap < nearest;
        nearest = nearer ? gap : nearest;
        of = nearer ? t : of;
      }
      found.what[InRoom(i)] = of;
    }
    for (uint i = 0u; i < found.count; ++i) {
      vec4 point = LivePoint(found.slot[InRoom(i)]);
      dvec4 at = exact_only;
      if (!kOneCutter) at = ExactAtContact(found.what[InRoom(i)], exact_s);
      dvec3 away = dvec3(point.xyz) - at.xyz;
      double d = length(away);
      double projection = abs(d - at.w) < exact_layer ? max(0.0lf, -dot(n, away) / max(d, 1e-20lf)) : 0.0lf;
      double area = double(point.w) * per_layer * projection;
      double arm = length(cross(dvec3(point.xyz) - origin, axis));
      dvec2 units = Rounded(area * dvec2(area_scale, arm * moment_scale));
      uint material = PointEntry(found.slot[InRoom(i)]).more;
      GATHER_MATERIAL(0) GATHER_MATERIAL(1) GATHER_MATERIAL(2) GATHER_MATERIAL(3)
      GATHER_MATERIAL(4) GATHER_MATERIAL(5) GATHER_MATERIAL(6) GATHER_MATERIAL(7)
    }
  }
  if (row != 1u) return;
  if (kOnGpu) {
    SHARE_MATERIAL(0) SHARE_MATERIAL(1) SHARE_MATERIAL(2) SHARE_MATERIAL(3)
    SHARE_MATERIAL(4) SHARE_MATERIAL(5) SHARE_MATERIAL(6) SHARE_MATERIAL(7)
    barrier();
    uint place = gl_LocalInvocationID.x;
    Sum64 total = place < 2u * kMaterials ? GroupTotal(place) : kNoSum;
    if (total != kNoSum) ADD_SUM(frame.exact.engaged[place], total)
    return;
  }
  FLUSH_MATERIAL(0) FLUSH_MATERIAL(1) FLUSH_MATERIAL(2) FLUSH_MATERIAL(3)
  FLUSH_MATERIAL(4) FLUSH_MATERIAL(5) FLUSH_MATERIAL(6) FLUSH_MATERIAL(7)
}
