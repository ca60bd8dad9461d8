#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3. Row 0: shrinks each listed ball by every cutting ball's capsules (first contact to slid, slid to end of the advance),
// one invocation per ball (equation 5, corrected; equivalent to simulation::ShrinkBall). Row 1: clears the mass points in the
// capsules, each once and booked in integer units of volume, so the result does not depend on scheduling. From here on the
// list's copies are the valid balls, until flush.comp writes them back. On a GPU the last workgroup reports the frame.
//
// Software drivers execute both sides of a branch: work that few balls and points need follows the loop over them, which each
// lane leaves at the first one that needs it.
#include "common.glsl"
#include "pairs.glsl"
#include "rate_law.glsl"

shared uint readback_sum;

const double kMinBallRadius_mm = 1e3 * kMinBallRadius;

// One piece of a cutting ball's path in floats, to test whether it may touch.
struct CapsuleF32 {
  vec3 a, m;  // from a to a + m
  float per_mm2;  // 1 / m²; 0 where nothing moves
};
CapsuleF32 MakeCapsuleF32(vec3 a, vec3 b) {
  vec3 m = b - a;
  float mm = dot(m, m);
  return CapsuleF32(a, m, mm > 0.0 ? 1.0 / mm : 0.0);
}
float SquaredDistance(CapsuleF32 c, vec3 p) {
  vec3 out_of_a = p - c.a, away = out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0, 1.0) * c.m;
  return dot(away, away);
}

// One piece of a cutting ball's path in double precision.
struct Capsule {
  dvec3 a, m;
  double per_mm2, r;
};
Capsule MakeCapsule(dvec3 a, dvec3 b, double r) {
  dvec3 m = b - a;
  double mm = dot(m, m);
  return Capsule(a, m, mm > 0.0lf ? 1.0lf / mm : 0.0lf, r);
}
dvec3 Away(Capsule c, dvec3 p) {
  dvec3 out_of_a = p - c.a;
  return out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0lf, 1.0lf) * c.m;
}
bool Inside(Capsule c, dvec3 p) { return length(Away(c, p)) < c.r; }

// Direction in which a ball moves if its centre lies on the axis. The rounding error of `away` must not decide it.
dvec3 OnAxis(Capsule c, dvec3 p, dvec3 away, double d) {
  dvec3 u = away;
  double along = dot(p - c.a, c.m) * c.per_mm2;
  if (along > 0.0lf && along < 1.0lf) u -= dot(u, c.m) * c.per_mm2 * c.m;
  dvec3 s = abs(c.m);
  dvec3 pick = s.x <= s.y && s.x <= s.z ? dvec3(1, 0, 0) : s.y <= s.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  double length_of_u = length(u);
  return length_of_u > kOnAxis * d ? u / length_of_u : normalize(pick - dot(pick, c.m) * c.per_mm2 * c.m);
}

bool Swallows(Capsule c, dvec4 ball) { return ball.w + c.r - length(Away(c, ball.xyz)) >= 2.0lf * ball.w; }

// A ball after one capsule. `on_axis` is set where its centre lies on the axis. Without `all_cases` that case is left to a
// second call after the loop over many balls, since software drivers execute a branch even if no lane takes it.
dvec4 Shrunk(dvec4 ball, Capsule c, bool all_cases, inout bool on_axis) {
  dvec3 away = Away(c, ball.xyz);
  double d = length(away), p = ball.w > 0.0lf ? max(0.0lf, ball.w + c.r - d) : 0.0lf, half_p = 0.5lf * p;
  dvec3 u = (1.0lf / max(d, 1e-20lf)) * away;
  bool here = p > 0.0lf && d < kOnAxis * c.r;
  if (all_cases && here) u = OnAxis(c, ball.xyz, away, d);
  on_axis = on_axis || here;
  bool gone = p > 0.0lf && (p >= 2.0lf * ball.w || ball.w - half_p < kMinBallRadius_mm);
  return gone ? dvec4(ball.xyz, 0.0lf) : dvec4(ball.xyz + half_p * u, ball.w - half_p);
}

// The path of the tool in a frame.
struct SweptPath {
  double at_contact;
  Slide slid_by;
  dvec3 step_mm;
  float rounding;
  uint farthest;  // largest packed gap of a pair that may meet on it
  uint cutter;  // with kContactSphere, the only cutting ball
  // in floats
  float contact_f32, share_f32;
  vec3 move_f32, step_f32;
};
bool IsCutter(SweptPath way, uint t) { return !kContactSphere || t == way.cutter; }
// Both pieces of a tool ball's path: the slide and the advance.
struct CapsulePair {
  Capsule slide, advance;
};
CapsulePair CapsulesOf(SweptPath way, uint t) {
  dvec4 contact = ExactAtContact(t, way.at_contact);
  dvec3 slid = AfterSlide(way.slid_by, contact.xyz, ExactGoal(t));
  return CapsulePair(MakeCapsule(contact.xyz, slid, contact.w), MakeCapsule(slid, slid + way.step_mm, contact.w));
}
dvec4 Shrunk(dvec4 ball, CapsulePair capsules, bool all_cases, out bool on_axis) {
  on_axis = false;
  return Shrunk(Shrunk(ball, capsules.slide, all_cases, on_axis), capsules.advance, all_cases, on_axis);
}
bool Inside(CapsulePair capsules, dvec3 p) { return Inside(capsules.slide, p) || Inside(capsules.advance, p); }
// Both pieces of a tool ball's path in floats.
struct CapsulePairF32 {
  CapsuleF32 slide, advance;
  float r;
};
CapsulePairF32 CapsulesF32Of(SweptPath way, uint t) {
  vec4 contact = AtContact(t, way.contact_f32);
  vec3 target = (way.slid_by.turns ? Goal(t) : contact.xyz) + way.move_f32,
       slid = mix(contact.xyz, target, way.share_f32);
  return CapsulePairF32(MakeCapsuleF32(contact.xyz, slid), MakeCapsuleF32(slid, slid + way.step_f32), contact.w);
}
// Whether the capsules may touch a ball, or a point (radius 0).
bool MayTouch(SweptPath way, CapsulePairF32 capsules, vec3 p, float radius) {
  float reach = capsules.r + radius + way.rounding;
  return min(SquaredDistance(capsules.slide, p), SquaredDistance(capsules.advance, p)) < reach * reach;
}

// Returns a ball after the frame. The packed pairs of its entry count in order, each with both pieces of the tool ball's path.
vec4 Shrink(SweptPath way, uint slot, vec4 ball) {
  ListEntry entry = LiveEntry(slot);
  uint last = entry.first + (ball.w > 0.0 && entry.more <= way.farthest ? entry.count : 0u);
  dvec4 exact_ball = Exactly(ball);
  for (uint k = entry.first; k < last; ++k) {
    uint pair = PackedPairAt(k);
    bool may = (pair >> kToolBits) <= way.farthest && IsCutter(way, ToolOf(pair)) &&
               MayTouch(way, CapsulesF32Of(way, ToolOf(pair)), ball.xyz, ball.w);
    for (uint once = may ? 0 : 1; once < 1; ++once) {
      bool on_axis;
      exact_ball = Shrunk(exact_ball, CapsulesOf(way, ToolOf(pair)), true, on_axis);
      ball = InFloats(exact_ball);
    }
  }
  return ball;
}

// Whether one piece of a tool ball's path removes the whole original ball.
bool IsSwallowed(SweptPath way, uint slot, dvec4 whole) {
  bool swallowed = false;
  ListEntry entry = LiveEntry(slot);
  uint last = kOneCutter ? entry.first + 1u : entry.first + entry.count;
  for (uint k = entry.first; k < last; ++k) {
    uint t = kOneCutter ? 0u : ToolOf(PackedPairAt(k));
    CapsulePair capsules = CapsulesOf(way, t);
    swallowed = swallowed || (IsCutter(way, t) && (Swallows(capsules.slide, whole) || Swallows(capsules.advance, whole)));
  }
  return swallowed;
}

// Notes an event for the host's record of split balls.
void NoteSplit(uint index, vec4 before, vec4 after) {
  uint place = atomicAdd(frame.split_event_count, 1u);
  if (place < frame.split_event_capacity) split_events[place] = SplitEvent(index, before, after);
}

// Stores the ball's new state. A large ball is noted for the host to split, a small child is dropped, and a block's last child
// is noted for the host to free the block.
void StoreBall(SweptPath way, uint slot, vec4 whole, vec4 ball) {
  if (ball.w == whole.w) return;
  if (kSplit) {
    uint index = LiveEntry(slot).index;
    bool child = index >= frame.first_child;
    if (!child && whole.w > frame.split_radius_mm && !IsSwallowed(way, slot, Exactly(whole))) NoteSplit(index, whole, ball);
    if (child) {
      uint block = (index - frame.first_child) / kGroupSize;
      if (ball.w < blocks[block].min_mm) ball.w = 0.0;
      if (ball.w == 0.0 && atomicAdd(blocks[block].live, 0xffffffffu) == 1u)
        NoteSplit(kEmptiedBlock + block, vec4(0.0), vec4(0.0));
    }
  }
  live_balls[slot] = ball;
}

// Removes with the only cutting ball, over this invocation's balls.
void RemoveOnce(SweptPath way, CapsulePairF32 only_f32, CapsulePair only, uint end) {
  uint slot = FirstEntry();
  while (slot < end) {
    found.count = 0u;
    for (; found.count < kRoom && slot < end; slot += EntryStep()) {
      vec4 ball = LiveBall(slot);
      if (ball.w > 0.0 && MayTouch(way, only_f32, ball.xyz, ball.w)) Note(slot, 0u, false);
    }
    for (uint i = 0u; i < found.count;) {
      bool on_axis = false;
      for (; i < found.count; ++i) {
        vec4 ball = LiveBall(found.slot[InRoom(i)]);
        vec4 shrunk = InFloats(Shrunk(Exactly(ball), only, false, on_axis));
        if (on_axis) break;
        StoreBall(way, found.slot[InRoom(i)], ball, shrunk);
      }
      if (!on_axis) break;
      vec4 ball = LiveBall(found.slot[InRoom(i)]);
      StoreBall(way, found.slot[InRoom(i)], ball, InFloats(Shrunk(Exactly(ball), only, true, on_axis)));
      ++i;
    }
  }
}

// Removes with all cutting balls, over this invocation's balls: the tool balls of a ball in order, one after the other.
void RemovePairs(SweptPath way, bool go) {
  const uint kNoSlot = 0xffffffffu;
  Walk walk = BeginWalk(kCutting, go);
  uint slot = kNoSlot;
  dvec4 ball = dvec4(0.0lf);
  float before = 0.0;
  for (bool more = true; more;) {
    found.count = 0u;
    while (found.count < kRoom) {
      more = NextPair(walk, way.farthest);
      if (!more) break;
      vec4 whole = LiveBall(walk.slot);
      uint t = ToolOf(walk.pair);
      if (whole.w > 0.0 && IsCutter(way, t) && MayTouch(way, CapsulesF32Of(way, t), whole.xyz, whole.w)) Note(walk.slot, t, false);
    }
    for (uint i = 0u; i < found.count;) {
      bool on_axis = false;
      for (; i < found.count; ++i) {
        if (found.slot[InRoom(i)] != slot) {
          if (float(ball.w) != before) live_balls[slot] = InFloats(ball);
          slot = found.slot[InRoom(i)];
          ball = Exactly(LiveBall(slot));
          before = float(ball.w);
        }
        dvec4 shrunk = Shrunk(ball, CapsulesOf(way, found.what[InRoom(i)]), false, on_axis);
        if (on_axis) break;
        ball = shrunk;
      }
      if (!on_axis) break;
      ball = Shrunk(ball, CapsulesOf(way, found.what[InRoom(i)]), true, on_axis);
      ++i;
    }
  }
  if (float(ball.w) != before) live_balls[slot] = InFloats(ball);
}

void Clear(uint slot, vec4 point) {
  uint i = PointEntry(slot).index;
  uint material = point_states[i];
  live_points[slot].w = -point.w;
  point_states[i] = material | kCleared;
  ADD_SUM(frame.exact.removed[material], SumOf(point_units[i]))
}

// A workgroup's share of the listed balls (row 0) or points (row 1).
void Remove(SweptPath way) {
  uint row = Row();
  bool go = frame.needs_rebuild == 0u && frame.spindle_rad_per_s != 0.0;
  if (kContactSphere) go = go && way.cutter < frame.cutter_count;  // a shaft cuts nothing
  // capsules of the only cutting ball, if there is only one
  CapsulePair only = CapsulesOf(way, 0u);
  CapsulePairF32 only_f32 = CapsulesF32Of(way, 0u);

  uint slot = FirstEntry(), end = row == 0u && go ? frame.live_ball_count : 0u;
  if (kOneCutter) {
    RemoveOnce(way, only_f32, only, end);
  } else if (kSplit) {
    for (; slot < end; slot += EntryStep()) {
      vec4 ball = LiveBall(slot);
      StoreBall(way, slot, ball, Shrink(way, slot, ball));
    }
  } else {
    RemovePairs(way, row == 0u && go);
  }

  if (kOneCutter) {
    slot = FirstEntry();
    end = row == 1u && go ? frame.live_point_count : 0u;
    while (slot < end) {
      vec4 point;
      uint own = slot;
      bool touched = false;
      while (slot < end && !touched) {
        own = slot;
        point = LivePoint(slot);
        touched = point.w > 0.0 && MayTouch(way, only_f32, point.xyz, 0.0);
        slot += EntryStep();
      }
      if (touched && Inside(only, dvec3(point.xyz))) Clear(own, point);
    }
    return;
  }
  Walk walk = BeginWalk(kPoint, row == 1u && go);
  for (bool more = true; more;) {
    vec4 point;
    bool touched = false;
    while (!touched) {
      more = NextPair(walk, way.farthest);
      if (!more) break;
      point = LivePoint(walk.slot);
      touched = point.w > 0.0 && IsCutter(way, ToolOf(walk.pair)) &&
                MayTouch(way, CapsulesF32Of(way, ToolOf(walk.pair)), point.xyz, 0.0);
    }
    if (!touched || !Inside(CapsulesOf(way, ToolOf(walk.pair)), dvec3(point.xyz))) continue;
    Clear(walk.slot, point);
    walk.left = 0u;  // the point is cleared: skip its other pairs
    walk.k = walk.last;
  }
}

// Writes the frame to where the host reads it; a copy command takes four times as long on a GPU. The host polls the number and
// then compares the checksum, so the words may arrive in any order.
void WriteReadback() {
  const uint count = kFrameBytes / 16u;
  if (gl_LocalInvocationID.x == 0u) readback_sum = 0u;
  barrier();
  uint sum = 0u;
  for (uint i = gl_LocalInvocationID.x; i < count; i += kLanes) {
    uvec4 words = frame_words[i];
    readback_words[i] = words;
    sum += words.x + words.y + words.z + words.w;
  }
  sum = subgroupAdd(sum);
  if (subgroupElect()) atomicAdd(readback_sum, sum);
  barrier();
  if (gl_LocalInvocationID.x == 0u) readback_words[count] = uvec4(readback_sum, frame.sequence, 0u, 0u);
}

void main() {
  SweptPath way;
  way.cutter = ToolOf(frame.touching);
  way.at_contact = ExactFraction();
  way.slid_by = ChosenSlide();
  Advance advance = ComputeAdvance(way.at_contact, way.slid_by);
  way.step_mm = advance.step_mm;
  way.rounding = frame.rounding_mm;
  way.contact_f32 = float(way.at_contact);
  way.share_f32 = float(way.slid_by.share);
  way.move_f32 = vec3(way.slid_by.move);
  way.step_f32 = vec3(way.step_mm);
  way.farthest = PackedGapLimit(Displacement(true, way.contact_f32) + float(way.slid_by.way_mm + length(advance.step_mm)));
  Remove(way);
  if (GroupNumber() == 0u && gl_LocalInvocationID.x == 0u) {
    frame.exact.advance = advance.advance_mm;
    frame.exact.edge_work = advance.edge_work_Nmm;
    frame.exact.step = advance.step_mm;
    frame.turns = way.slid_by.turns ? 1u : 0u;
    frame.exact.slid_share = way.slid_by.share;
  }
  if (kOnGpu && IsLastGroup()) WriteReadback();
}
