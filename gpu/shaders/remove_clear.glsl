// Pass 3: every cutting ball's capsules (first contact to slid, slid to end of the advance) take their share of each live ball
// (row 0; equation 5, corrected; twin of simulation::ShrinkBall), one invocation a ball, and clear the mass points in them
// (row 1), each once and booked in whole units of volume: the result does not depend on scheduling. The list's copies are the
// balls from here on, until flush.comp writes them back.
//
// Software drivers skip no branch: what few balls and points need stands behind the loop over them, which all lanes leave as soon
// as one of them needs it.
#include "pairs.glsl"
#include "rate_law.glsl"

const float kLeastBallRadius = 1e-3;  // mm
const float kOnAxis = 1e-3;           // simulation::kOnAxis

// One piece of a cutting ball's path.
struct Capsule {
  vec3 a, m;  // from a to a + m
  float per_mm2;  // 1 / m²; 0 where nothing moves
  float r;
};
Capsule MakeCapsule(vec3 a, vec3 b, float r) {
  vec3 m = b - a;
  float mm = dot(m, m);
  return Capsule(a, m, mm > 0.0 ? 1.0 / mm : 0.0, r);
}
vec3 Away(Capsule c, vec3 p) {
  vec3 out_of_a = p - c.a;
  return out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0, 1.0) * c.m;
}
bool Inside(Capsule c, vec3 p) {
  vec3 away = Away(c, p);
  return dot(away, away) < c.r * c.r;
}

// The direction in which a ball gives way whose centre lies on the axis: what rounding has left would count.
vec3 OnAxis(Capsule c, vec3 p, vec3 away, float d) {
  vec3 u = away;
  float along = dot(p - c.a, c.m) * c.per_mm2;
  if (along > 0.0 && along < 1.0) u -= dot(u, c.m) * c.per_mm2 * c.m;
  vec3 s = abs(c.m);
  vec3 pick = s.x <= s.y && s.x <= s.z ? vec3(1, 0, 0) : s.y <= s.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
  return length(u) > kOnAxis * d ? normalize(u) : normalize(pick - dot(pick, c.m) * c.per_mm2 * c.m);
}

bool Swallows(Capsule c, vec4 ball) { return ball.w + c.r - length(Away(c, ball.xyz)) >= 2.0 * ball.w; }

// `on_axis` is set where the ball's centre is so near the axis that the direction has to be looked for, which is only done
// where `exactly`.
vec4 Shrunk(vec4 ball, Capsule c, bool exactly, inout bool on_axis) {
  vec3 away = Away(c, ball.xyz);
  float d = length(away);
  float p = ball.w > 0.0 ? ball.w + c.r - d : 0.0;
  float half_p = 0.5 * max(p, 0.0);
  bool gone = p > 0.0 && (p >= 2.0 * ball.w || ball.w - half_p < kLeastBallRadius);
  vec3 u = away * (1.0 / max(d, 1e-20));
  bool rare = p > 0.0 && d < kOnAxis * c.r && !gone;
  on_axis = on_axis || rare;
  if (exactly && rare) u = OnAxis(c, ball.xyz, away, d);
  return gone ? vec4(ball.xyz, 0.0) : vec4(ball.xyz + half_p * u, ball.w - half_p);
}

// The way of the frame.
struct Way {
  float at_contact, travel;  // the farthest that any tool ball goes
  Slide slid_by;
  vec3 step_mm;
  uint farthest;         // in a word of a pair that may meet on it
  Capsule slide, give;   // the only cutter's, where there is but one
};
Capsule Piece(Way way, uint t, uint part) {
  vec4 contact = AtContact(t, way.at_contact);
  vec3 slid = AfterSlide(way.slid_by, contact.xyz, Goal(t));
  return MakeCapsule(part == 0u ? contact.xyz : slid, part == 0u ? slid : slid + way.step_mm, contact.w);
}

// A ball after the frame; false where that has to be done `exactly`.
bool Shrink(Way way, uint slot, bool exactly, inout vec4 ball) {
  bool on_axis = false;
  if (kOneCutter) {
    ball = Shrunk(Shrunk(ball, way.slide, exactly, on_axis), way.give, exactly, on_axis);
    return exactly || !on_axis;
  }
  Live entry = LiveEntry(slot);
  uint last = entry.first + (ball.w > 0.0 && entry.more <= way.farthest ? entry.count : 0u);
  // first which of 32 words may meet, then all those: in their order, one piece of the way after the other
  uint may_meet = 0u;
  for (uint part = 0; part < 2; ++part)
    for (uint base = entry.first; base < last; base += 32u) {
      uint end = part == 0u || entry.count > 32u ? min(base + 32u, last) : base;
      may_meet = end > base ? 0u : may_meet;
      for (uint k = base; k < end; ++k) may_meet |= (SpanWord(k) >> kToolBits) <= way.farthest ? 1u << (k - base) : 0u;
      for (uint left = may_meet; left != 0u; left &= left - 1u)
        ball = Shrunk(ball, Piece(way, ToolOf(SpanWord(base + uint(findLSB(left)))), part), exactly, on_axis);
    }
  return exactly || !on_axis;
}

// Whether one piece of the way swallows the ball as it was.
bool IsSwallowed(Way way, uint slot, vec4 whole) {
  bool swallowed = false;
  if (kOneCutter) return Swallows(way.slide, whole) || Swallows(way.give, whole);
  Live entry = LiveEntry(slot);
  for (uint k = entry.first; k < entry.first + entry.count; ++k) {
    uint t = ToolOf(SpanWord(k));
    swallowed = swallowed || Swallows(Piece(way, t, 0u), whole) || Swallows(Piece(way, t, 1u), whole);
  }
  return swallowed;
}

// The ball's new state to where it lies; a large one is noted for the host to split, a small child dropped.
void Keep(Way way, uint slot, vec4 whole, vec4 ball) {
  if (ball.w == whole.w) return;
  if (kSplit) {
    uint index = LiveEntry(slot).index;
    bool child = index >= frame.first_child;
    if (!child && whole.w > frame.split_radius_mm && !IsSwallowed(way, slot, whole)) {
      uint place = atomicAdd(frame.request_count, 1u);
      if (place < frame.request_capacity) requests[place] = SplitRequest(index, whole, ball);
    }
    if (child) {
      uint block = (index - frame.first_child) / kGroupSize;
      if (ball.w < blocks[block].least_mm) ball.w = 0.0;
      if (ball.w == 0.0) atomicAdd(blocks[block].live, 0xffffffffu);
    }
  }
  live_balls[slot] = ball;
}

// Shrink over this invocation's balls, pair by pair: a ball's tool balls come in their order, in two turns, one for each piece of
// the way.
void ShrinkAll(Way way, bool go) {
  Walk walk = BeginWalk(kCutting, 2u, go);
  uint slot = 0u;
  vec4 ball = vec4(0.0);
  float before = 0.0;
  for (bool more = true; more;) {
    Capsule piece;
    bool on_axis = false;
    while (!on_axis) {
      more = NextPair(walk, way.farthest);
      if (!more) break;
      if (walk.slot != slot || before == 0.0) {
        if (ball.w != before) live_balls[slot] = ball;
        slot = walk.slot;
        ball = LiveBall(slot);
        before = ball.w;
      }
      piece = Piece(way, ToolOf(walk.word), walk.turn);
      vec4 left = Shrunk(ball, piece, false, on_axis);
      ball = on_axis ? ball : left;
    }
    if (on_axis) ball = Shrunk(ball, piece, true, on_axis);
  }
  if (ball.w != before) live_balls[slot] = ball;
}

void Clear(uint slot, vec4 point) {
  uint i = PointEntry(slot).index;
  uint material = point_states[i];
  live_points[slot].w = -point.w;
  point_states[i] = material | kCleared;
  atomicAdd(frame.removed[material], point_units[i]);
}

void RemoveAndClear(uint row) {
  bool go = frame.is_void == 0u && frame.spindle_rad_per_s != 0.0;
  Way way;
  way.at_contact = ContactFraction();
  way.slid_by = ChosenSlide();
  Advance advance = AdvanceOfFrame(way.at_contact, way.slid_by);
  way.step_mm = advance.step_mm;
  if (Takes(row, 0u) && gl_WorkGroupID.x == 0u && gl_LocalInvocationID.x == 0u) {
    frame.advance_mm = advance.advance_mm;
    frame.edge_work_Nmm = advance.edge_work_Nmm;
    frame.step_mm = vec4(advance.step_mm, 0.0);
    frame.turns = way.slid_by.turns ? 1u : 0u;
    frame.slid_share = way.slid_by.share;
  }
  way.farthest = WordGap(Drift(true, way.at_contact) + way.slid_by.way_mm + length(advance.step_mm));
  way.slide = Piece(way, 0u, 0u);
  way.give = Piece(way, 0u, 1u);

  uint slot = ChunkBegin(), end = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
  if (kOneCutter || kSplit) {
    while (slot < end) {
      vec4 whole, ball;
      bool again = false;
      while (slot < end && !again) {
        whole = ball = LiveBall(slot);
        again = subgroupAny(!Shrink(way, slot, false, ball));
        if (again) break;
        Keep(way, slot, whole, ball);
        slot += ChunkStep();
      }
      if (slot >= end) break;
      ball = whole;
      Shrink(way, slot, true, ball);
      Keep(way, slot, whole, ball);
      slot += ChunkStep();
    }
  } else {
    ShrinkAll(way, Takes(row, 0u) && go);
  }

  if (kOneCutter) {
    slot = ChunkBegin();
    end = Takes(row, 1u) && go ? ChunkEnd(frame.live_point_count) : 0u;
    while (slot < end) {
      vec4 point;
      uint own = slot;
      bool inside = false, any = false;
      while (slot < end && !any) {
        own = slot;
        point = LivePoint(slot);
        inside = point.w > 0.0 && (Inside(way.slide, point.xyz) || Inside(way.give, point.xyz));
        any = subgroupAny(inside);
        slot += ChunkStep();
      }
      if (inside) Clear(own, point);
    }
    return;
  }
  Walk walk = BeginWalk(kPoint, 1u, Takes(row, 1u) && go);
  for (bool more = true; more;) {
    vec4 point;
    bool inside = false;
    while (!inside) {
      more = NextPair(walk, way.farthest);
      if (!more) break;
      point = LivePoint(walk.slot);
      uint t = ToolOf(walk.word);
      inside = point.w > 0.0 && (Inside(Piece(way, t, 0u), point.xyz) || Inside(Piece(way, t, 1u), point.xyz));
    }
    if (!inside) continue;
    Clear(walk.slot, point);
    walk.left = 0u;  // once is enough
    walk.k = walk.last;
  }
}
