#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, second half, one workgroup (twin of simulation/contact_law.cpp and hold_point.cpp): the pairs that may hold the tool,
// the point in which their planes hold it, friction, and the resultant of the faces that cut. In double precision: a few
// dozen planes, whose active set hangs on small differences.
#include "common.glsl"

const uint kNoPlane = kCandidates;
const double kOppositeCosine = -0.8lf;
const double kHoldSlack = 1e-6lf;
const double kViolated_mm = 1e-5lf, kLeastPivot = 1e-13lf;
const double kFaceCosine = 0.866lf;  // simulation::kFaceCosine
const uint kMostRounds = 200;
const uint kNoFace = 2u * kFaces;

// The planes by the bin of their pair, then those of the remembered pairs. Those that are there, in that order, are
// there[0 … there_count - 1].
shared bool plane_there[kCandidates];
shared uint there[kCandidates], there_count;
shared dvec3 plane_n[kCandidates + 1];
shared double plane_gap[kCandidates], yielding_gap[kCandidates];
shared double opposite_gap[kCandidates];
shared dvec3 plane_motion[kCandidates];
shared double tool_radius[kCandidates];
shared uint bone_ball[kCandidates], tool_ball[kCandidates];
shared uint bin_of[kRemembered];  // of a remembered pair, where a bin has the same
shared uint start_plane[4];       // that held the frame before
// of the hold with the turn, and of that without
shared double plane_offset[2][kCandidates + 1];

// ---- where planes hold a point

// Up to four planes that hold a point, kNoPlane for none.
struct Held {
  uvec4 plane;
  dvec4 m;
  uint size;
  dvec3 point;
  double slack;
};

double Violation(uint hold, Held held, uint i, dvec3 shift) {
  return plane_offset[hold][i] - dot(plane_n[i], shift + held.point) - held.slack;
}

// Multipliers of the nearest point on all planes of a set, by elimination of the Gram matrix; those that are none have a row
// of the unit matrix. False where the planes are parallel or one would pull.
bool SolveSet(uint hold, uvec4 p, dvec3 shift, out Held set) {
  bvec4 is = notEqual(p, uvec4(kNoPlane));
  dvec3 a = plane_n[p.x], b = plane_n[p.y], c = plane_n[p.z], d = plane_n[p.w];
  dvec4 real = dvec4(is.x ? 1.0lf : 0.0lf, is.y ? 1.0lf : 0.0lf, is.z ? 1.0lf : 0.0lf, is.w ? 1.0lf : 0.0lf);
  dvec4 slack = kHoldSlack * real, pad = 1.0lf - real;
  dvec4 row_0 = dvec4(dot(a, a) + slack.x + pad.x, dot(a, b) + slack.x * real.y, dot(a, c) + slack.x * real.z,
                      dot(a, d) + slack.x * real.w);
  dvec4 row_1 = dvec4(row_0.y, dot(b, b) + slack.y + pad.y, dot(b, c) + slack.y * real.z, dot(b, d) + slack.y * real.w);
  dvec4 row_2 = dvec4(row_0.z, row_1.z, dot(c, c) + slack.z + pad.z, dot(c, d) + slack.z * real.w);
  dvec4 row_3 = dvec4(row_0.w, row_1.w, row_2.w, dot(d, d) + slack.w + pad.w);
  dvec4 v = dvec4(plane_offset[hold][p.x] - dot(a, shift), plane_offset[hold][p.y] - dot(b, shift),
                  plane_offset[hold][p.z] - dot(c, shift), plane_offset[hold][p.w] - dot(d, shift)) * real;
  // one division a pivot: they are what takes long
  dvec4 per;
  bool good = row_0.x > kLeastPivot;
  per.x = 1.0lf / row_0.x;
  double f = row_1.x * per.x;
  row_1 -= f * row_0;
  v.y -= f * v.x;
  f = row_2.x * per.x;
  row_2 -= f * row_0;
  v.z -= f * v.x;
  f = row_3.x * per.x;
  row_3 -= f * row_0;
  v.w -= f * v.x;
  good = good && row_1.y > kLeastPivot;
  per.y = 1.0lf / row_1.y;
  f = row_2.y * per.y;
  row_2 -= f * row_1;
  v.z -= f * v.y;
  f = row_3.y * per.y;
  row_3 -= f * row_1;
  v.w -= f * v.y;
  good = good && row_2.z > kLeastPivot;
  per.z = 1.0lf / row_2.z;
  f = row_3.z * per.z;
  row_3 -= f * row_2;
  v.w -= f * v.z;
  good = good && row_3.w > kLeastPivot;
  per.w = 1.0lf / row_3.w;
  set.m.w = v.w * per.w;
  set.m.z = (v.z - row_2.w * set.m.w) * per.z;
  set.m.y = (v.y - row_1.z * set.m.z - row_1.w * set.m.w) * per.y;
  set.m.x = (v.x - row_0.y * set.m.y - row_0.z * set.m.z - row_0.w * set.m.w) * per.x;
  set.plane = p;
  set.size = uint(is.x) + uint(is.y) + uint(is.z) + uint(is.w);
  set.point = set.m.x * a + set.m.y * b + set.m.z * c + set.m.w * d;
  set.slack = kHoldSlack * dot(set.m, real);
  return good && (!is.x || set.m.x > 0.0lf) && (!is.y || set.m.y > 0.0lf) && (!is.z || set.m.z > 0.0lf) &&
         (!is.w || set.m.w > 0.0lf);
}

// The planes of `held` that the mask names, and the one that enters.
uvec4 Chosen(Held held, uint mask, uint entering) {
  uvec4 p = uvec4((mask & 1u) != 0u ? held.plane.x : kNoPlane, (mask & 2u) != 0u ? held.plane.y : kNoPlane,
                  (mask & 4u) != 0u ? held.plane.z : kNoPlane, entering);
  if ((mask & 8u) != 0u) {
    if (p.x == kNoPlane) p.x = held.plane.w;
    else if (p.y == kNoPlane) p.y = held.plane.w;
    else if (p.z == kNoPlane) p.z = held.plane.w;
  }
  return p;
}

// Planes in the order x, y, z, w without gaps, so that masks and the host's order agree.
Held Packed(Held set) {
  for (uint pass = 0; pass < 3; ++pass) {
    if (set.plane.x == kNoPlane) {
      set.plane.xy = set.plane.yx;
      set.m.xy = set.m.yx;
    }
    if (set.plane.y == kNoPlane) {
      set.plane.yz = set.plane.zy;
      set.m.yz = set.m.zy;
    }
    if (set.plane.z == kNoPlane) {
      set.plane.zw = set.plane.wz;
      set.m.zw = set.m.wz;
    }
  }
  return set;
}

// What a lane has, on all of the subgroup.
Held OfLane(Held own, uint lane) {
  return Held(subgroupBroadcast(own.plane, lane), subgroupBroadcast(own.m, lane), subgroupBroadcast(own.size, lane),
              subgroupBroadcast(own.point, lane), subgroupBroadcast(own.slack, lane));
}

// Twin of simulation::FindHoldPoint, about `shift` instead of the tool's pose: one subgroup's work, the same on every lane.
Held FindHold(uint hold, dvec3 shift, bool start) {
  uint lane = gl_SubgroupInvocationID;
  Held held = Held(uvec4(kNoPlane), dvec4(0.0lf), 0u, dvec3(0.0lf), 0.0lf);
  for (uint once = start ? 0 : 1; once < 1; ++once) {
    Held likely;
    uvec4 planes = uvec4(start_plane[0], start_plane[1], start_plane[2], start_plane[3]);
    if (SolveSet(hold, planes, shift, likely) && likely.size > 0u) held = Packed(likely);
  }
  for (uint round = 0; round < kMostRounds; ++round) {
    // the most violated plane, of equal ones the first
    float worst = 0.0;
    uint entering = kNoPlane;
    for (uint k = lane; k < there_count; k += gl_SubgroupSize) {
      uint i = there[k];
      double violation = Violation(hold, held, i, shift);
      if (violation <= kViolated_mm || float(violation) <= worst) continue;
      worst = float(violation);
      entering = i;
    }
    // (reductions of whole numbers, which GPUs have)
    float most = uintBitsToFloat(subgroupMax(floatBitsToUint(worst)));
    // a bound, since software drivers go on without a lane at work
    entering = min(subgroupMin(worst == most ? entering : kNoPlane), kNoPlane);
    if (entering == kNoPlane) break;
    // of the sets of it and those that hold, the one whose point keeps the others
    float least = 1e30;
    uint chosen = 16u;
    Held own = held;
    for (uint mask = lane; mask < (1u << held.size); mask += gl_SubgroupSize) {
      Held set;
      bool good = bitCount(mask) < 4 && SolveSet(hold, Chosen(held, mask, entering), shift, set);
      double violation = 0.0lf;
      if (good) {
        if (held.size > 0u) violation = max(violation, Violation(hold, set, held.plane.x, shift));
        if (held.size > 1u) violation = max(violation, Violation(hold, set, held.plane.y, shift));
        if (held.size > 2u) violation = max(violation, Violation(hold, set, held.plane.z, shift));
        if (held.size > 3u) violation = max(violation, Violation(hold, set, held.plane.w, shift));
      }
      if (!good || float(violation) >= least) continue;
      least = float(violation);
      chosen = mask;
      own = set;
    }
    float best = uintBitsToFloat(subgroupMin(floatBitsToUint(least)));
    uint first = subgroupMin(least == best ? chosen : 16u);
    if (first == 16u) break;
    bool again = any(equal(held.plane, uvec4(entering)));
    held = Packed(OfLane(own, subgroupMin(chosen == first ? lane : gl_SubgroupSize - 1u)));
    if (again) break;
  }
  return held;
}

// Where planes hold the tool, what friction takes back, and how much of the multipliers is worth a force (twin of
// simulation::HoldTool).
struct Hold {
  Held held;
  double normal, most;
  dvec3 friction;
};
shared Hold holds[2];  // with the turn, without

void HoldTool(uint number, dvec3 origin_motion, double s) {
  bool turning = number == 0u;
  Hold hold;
  hold.friction = dvec3(0.0lf);
  // then friction, if there is any; a loop, so that the code of FindHold is there but once
  dvec3 shift = dvec3(0.0lf);
  for (uint pass = 0; pass < 2; ++pass) {
    Held found = FindHold(number, shift, pass == 0u);
    if (pass == 1u) {
      hold.friction += found.point;
      break;
    }
    hold.held = found;
    hold.normal = found.m.x + found.m.y + found.m.z + found.m.w;
    hold.most = min(hold.normal, 2.0lf * (length(found.point) + found.slack));
    if (hold.normal <= 0.0lf || frame.friction <= 0.0) break;
    dvec3 turn = turning ? (1.0lf - s) * dvec3(frame.turn.xyz) : dvec3(0.0lf), slip = dvec3(0.0lf);
    for (uint k = 0; k < found.size; ++k) {
      uint i = found.plane[k];
      dvec3 motion = turning ? plane_motion[i] : origin_motion;
      slip += found.m[k] * (motion + found.point - tool_radius[i] * cross(turn, plane_n[i]));
    }
    slip /= hold.normal;
    dvec3 n = normalize(found.point);
    slip -= dot(n, slip) * n;
    double size = length(slip);
    if (size <= 0.0lf) break;
    hold.friction = -min(1.0lf, double(frame.friction) * hold.most / size) * slip;
    // the way back may lead into another plane, by micrometres: out again
    shift = found.point + hold.friction;
  }
  if (subgroupElect()) holds[number] = hold;
}

// ---- candidates

// Takes the pair of a bin, or a remembered one, if it is one: live, and near the tool at first contact.
void Take(uint source, double s) {
  uint bone = 0u, t = 0u;
  bool is = false;
  if (source < kBins) {
    uint64_t key = frame.bin_keys[source];
    is = key != 0xfffffffffffffffful;
    bone = uint(key >> kToolBits) & ((1u << kBoneBits) - 1u);
    t = uint(key) & ((1u << kToolBits) - 1u);
  } else if (source - kBins < frame.remembered_count) {
    is = true;
    bone = frame.remembered_bone[source - kBins];
    t = frame.remembered_tool[source - kBins];
  }
  is = is && bone < frame.ball_count && t < frame.tool_count;
  uint slot = is ? slots[bone] : 0u;
  is = is && slot < frame.live_ball_count && live_entries[slot].index == bone;
  vec4 ball = is ? live_balls[slot] : vec4(0.0);
  dvec4 start = ExactStart(is ? t : 0u);
  dvec3 goal = ExactGoal(is ? t : 0u), at = start.xyz + s * (goal - start.xyz);
  dvec3 from_bone = at - dvec3(ball.xyz);
  double d = length(from_bone), gap = d - start.w - double(ball.w);
  is = is && ball.w > 0.0 && d > 0.0lf && gap < frame.exact.enlargement;
  plane_there[source] = is;
  bone_ball[source] = bone;
  tool_ball[source] = t;
  plane_n[source] = is ? from_bone / d : dvec3(0.0lf);
  plane_gap[source] = gap;
  plane_motion[source] = goal - at;
  tool_radius[source] = start.w;
}

shared uint there_bits[3];
shared uint face_of[4];
shared dvec3 resultant_of[2 * kFaces];
shared dvec4 face_sum[kFaces];  // around the faces of the frame before: weight and weight n
shared double longest_of[64];  // of each subgroup

// Where a plane stands among those that are there.
uint Place(uint c) {
  uint place = 0u;
  for (uint w = 0; w < 3; ++w) {
    uint below = c >= 32u * (w + 1u) ? 0xffffffffu : c <= 32u * w ? 0u : (1u << (c - 32u * w)) - 1u;
    place += bitCount(there_bits[w] & below);
  }
  return place;
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  bool is_void = IsVoid();
  double s = ExactFraction();
  for (uint source = lane; source < kCandidates; source += kLanes) Take(source, s);
  for (uint k = lane; k < kRemembered; k += kLanes) bin_of[k] = kNoPlane;
  // by the last invocations, which have no pair to wait for
  for (uint i = kLanes - 1u - lane; i < 4u * kFaces; i += kLanes) {
    uint f = i / 4u, column = i % 4u;
    face_sum[f][column] = double(frame.exact.face_sums[i] + frame.exact.face_sums[4u * kFaces + i]);
  }
  if (lane < 4u) start_plane[lane] = kNoPlane;
  if (lane < 3u) there_bits[lane] = 0u;
  if (lane == 0u) {
    plane_n[kNoPlane] = dvec3(0.0lf);
    plane_offset[0][kNoPlane] = plane_offset[1][kNoPlane] = 0.0lf;
  }
  barrier();
  // a remembered pair that a bin has too counts once
  for (uint i = lane; i < kRemembered * kBins; i += kLanes) {
    uint k = i / kBins, bin = i % kBins;
    if (plane_there[kBins + k] && plane_there[bin] && bone_ball[bin] == bone_ball[kBins + k] &&
        tool_ball[bin] == tool_ball[kBins + k])
      bin_of[k] = bin;
  }
  barrier();
  for (uint k = lane; k < kRemembered; k += kLanes) {
    if (!plane_there[kBins + k]) continue;
    if (k < frame.held_count) start_plane[k] = bin_of[k] != kNoPlane ? bin_of[k] : kBins + k;
    if (bin_of[k] != kNoPlane) plane_there[kBins + k] = false;
  }
  barrier();
  for (uint c = lane; c < kCandidates; c += kLanes)
    if (plane_there[c]) atomicOr(there_bits[c / 32u], 1u << (c % 32u));
  barrier();
  for (uint c = lane; c < kCandidates; c += kLanes)
    if (plane_there[c]) there[Place(c)] = c;
  if (lane == 0u) there_count = Place(kCandidates);
  barrier();
  // where another faces it and less than the tolerance is left between them, both yield
  double tolerance = frame.exact.tolerance;
  dvec3 motion = frame.exact.goal - (frame.exact.start + s * (frame.exact.goal - frame.exact.start));  // of T's origin
  for (uint k = gl_SubgroupID; k < there_count; k += gl_NumSubgroups) {
    uint c = there[k];
    double least = tolerance + 1e3lf;
    for (uint i = gl_SubgroupInvocationID; i < there_count; i += gl_SubgroupSize) {
      uint other = there[i];
      if (dot(plane_n[other], plane_n[c]) < kOppositeCosine) least = min(least, plane_gap[other]);
    }
    least = subgroupMin(least);
    if (subgroupElect()) opposite_gap[c] = least;
  }
  barrier();
  for (uint k = lane; k < there_count; k += kLanes) {
    uint c = there[k];
    double room = min(tolerance, plane_gap[c] + opposite_gap[c]);
    yielding_gap[c] = plane_gap[c] + min(0.75lf * tolerance, 0.5lf * (tolerance - room));
    plane_offset[0][c] = -(yielding_gap[c] + dot(plane_n[c], plane_motion[c]));
    plane_offset[1][c] = -(yielding_gap[c] + dot(plane_n[c], motion));
  }
  barrier();
  uint hold_count = frame.turning != 0u ? 2u : 1u;
  for (uint number = gl_SubgroupID; number < hold_count; number += gl_NumSubgroups) HoldTool(min(number, 1u), motion, s);
  for (uint k = lane; k < (is_void ? 0u : there_count); k += kLanes) {
    uint c = there[k];
    vec3 n = vec3(plane_n[c]);
    frame.candidates[k] = Candidate(n.x, n.y, n.z, float(plane_gap[c]), float(yielding_gap[c]), bone_ball[c],
                                           tool_ball[c], c);
  }
  barrier();
  Hold hold = holds[0], unturned = holds[hold_count - 1u];
  Held held = hold.held;
  dvec3 friction = hold.friction;
  double normal = hold.normal;
  if (lane == kLanes - 1u && !is_void) {
    frame.candidate_count = there_count;
    frame.shaft_candidate = Place(kCuttingBinCount);
    frame.shaft_end = Place(kBins);
    frame.hold_count = held.size;
    for (uint k = 0; k < 4; ++k) {
      frame.hold_candidate[k] = held.plane[k] != kNoPlane ? Place(held.plane[k]) : kNoPlane;
      frame.exact.hold[k] = held.m[k];
      frame.exact.hold_n[k] = plane_n[held.plane[k]];
    }
    frame.friction_mm = vec4(vec3(friction), float(held.slack));
    dvec3 shift = motion + unturned.held.point + unturned.friction;
    double straight = length(shift), most = frame.exact.max_slide;
    frame.exact.shift = shift;
    frame.shift_mm = vec4(vec3(shift), 0.0);
    frame.exact.straight_way = straight;
    frame.exact.straight_limit = straight > most ? most / straight : 1.0lf;
    frame.turns = 1u;
  }

  // the faces' resultant, along the mean normal of the balls around each: strongest first, so that a new face forms around
  // what holds most
  uvec4 plane = held.plane;
  dvec4 m = held.m;
  for (uint pass = 0; pass < 3; ++pass) {
    if (held.size > 1u && m.y > m.x) {
      m.xy = m.yx;
      plane.xy = plane.yx;
    }
    if (held.size > 2u && m.z > m.y) {
      m.yz = m.zy;
      plane.yz = plane.zy;
    }
    if (held.size > 3u && m.w > m.z) {
      m.zw = m.wz;
      plane.zw = plane.wz;
    }
  }
  // the face of the frame before that each plane belongs to; one that belongs to none begins a face of its own
  for (uint k = lane; k < 4u; k += kLanes) {
    face_of[k] = k < held.size ? kFaces + k : kNoFace;
    double nearest = kFaceCosine;
    for (uint f = 0; f < (k < held.size ? kFaces : 0u); ++f) {
      double cosine = dot(plane_n[plane[k]], frame.exact.face_n[f]);
      if (cosine <= nearest) continue;
      nearest = cosine;
      face_of[k] = f;
    }
  }
  barrier();
  // or it joins one that began before
  for (uint k = lane == 0u ? 1u : held.size; k < held.size; ++k)
    for (uint first = face_of[k] < kFaces ? k : 0u; first < k; ++first) {
      if (face_of[first] != kFaces + first) continue;
      dvec3 sum = dvec3(0.0lf);
      for (uint i = first; i < k; ++i)
        if (face_of[i] == kFaces + first) sum += m[i] * plane_n[plane[i]];
      if (dot(plane_n[plane[k]], sum) > kFaceCosine * length(sum)) face_of[k] = kFaces + first;
    }
  barrier();
  double per_normal = normal > 0.0lf ? 1.0lf / normal : 0.0lf, free_share = normal > 0.0lf ? hold.most * per_normal : 1.0lf;
  for (uint f = lane; f < 2u * kFaces; f += kLanes) {
    dvec3 hold_f = dvec3(0.0lf);
    double multiplier = 0.0lf, cuts = 0.0lf, largest = 0.0lf;
    for (uint k = 0; k < 4u; ++k) {
      double own = 0.0lf;
      for (uint i = 0; i < 4u; ++i)
        if (face_of[i] == face_of[k]) own += m[i];
      if (k < held.size) largest = max(largest, own);
      if (face_of[k] != f) continue;
      hold_f += m[k] * plane_n[plane[k]];
      multiplier = own;
      if (tool_ball[plane[k]] < frame.cutter_count) cuts += m[k];
    }
    resultant_of[f] = dvec3(0.0lf);
    double size = length(hold_f);
    if (size <= 0.0lf) continue;
    dvec3 n = hold_f / size;
    dvec4 sum = face_sum[min(f, kFaces - 1u)];
    if (f < kFaces && sum.x > 0.0lf) {
      double weighed = length(sum.yzw), narrow = weighed / sum.x;
      double exact = clamp(max(4.0lf * (1.0lf - largest * per_normal), (0.983lf - narrow) / 0.013lf), 0.0lf, 1.0lf);
      n = normalize((1.0lf - exact) * (sum.yzw / weighed) + exact * n);
    }
    resultant_of[f] =
        cuts / multiplier * (free_share * size * n + (1.0lf - free_share) * multiplier * per_normal * held.point);
  }
  // the way to the target of the tool point that moves farthest
  dvec3 delta = held.point + friction;
  double longest = length(motion + delta);
  // by the last invocations first, which have no face
  uint end_tool = frame.turning != 0u ? frame.tool_count : 0u;
  for (uint t = kLanes - 1u - lane; t < end_tool; t += kLanes) {
    float about = distance(AtContact(t, float(s)).xyz, Goal(t) + vec3(delta));
    for (uint may = about + frame.rounding_mm > float(longest) ? 0 : 1; may < 1; ++may)
      longest = max(longest, length(ExactGoal(t) + delta - ExactAtContact(t, s).xyz));
  }
  longest = subgroupMax(longest);
  if (subgroupElect()) longest_of[gl_SubgroupID] = longest;
  barrier();
  if (lane == 0) frame.is_void = is_void ? 1u : 0u;
  if (lane != 0 || is_void) return;
  dvec3 cutting = dvec3(0.0lf);
  for (uint f = 0; f < 2u * kFaces; ++f) cutting += resultant_of[f];
  for (uint k = 0; k < gl_NumSubgroups; ++k) longest = max(longest, longest_of[k]);
  double size = length(cutting), most = frame.exact.max_slide;
  frame.exact.way = longest;
  frame.exact.slide_limit = longest > most ? most / longest : 1.0lf;
  // what is found where no later pass has work to do
  frame.exact.slid_share = frame.exact.slide_limit;
  frame.exact.delta = delta;
  frame.exact.cutting = size;
  frame.exact.n = size > 0.0lf ? cutting / size : dvec3(0.0lf);
  frame.delta = vec4(vec3(delta), float(size));
}
