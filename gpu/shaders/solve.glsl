// Pass 2, second half, in one workgroup (equivalent to simulation/contact/contact_law.cpp and constrained_goal.cpp): the pairs that may hold
// the tool, the point at which their planes hold it, friction, and the resultant of the cutting faces. In double precision: a
// few dozen planes, whose active set depends on small differences.
//
// On a GPU this is a chain of latencies. Values are therefore loaded together, work for few invocations runs beside the chain,
// and one division replaces three.

const uint kNoPlane = kCandidates;
const double kViolated_mm = 1e3 * kViolated_m;
const uint kNoFace = 2u * kFaces;

// The planes by the bin of their pair, then those of the remembered pairs. The existing planes, in that order, are there[0 …
// there_count - 1].
shared bool plane_there[kCandidates];
shared uint there[kCandidates], there_count;
shared dvec3 plane_n[kCandidates + 1];
shared double plane_gap[kCandidates], yielding_gap[kCandidates];
shared dvec3 plane_motion[kCandidates];
shared double tool_radius[kCandidates];
shared uint bone_ball[kCandidates], tool_ball[kCandidates];
shared uint bin_of[kRemembered];  // bin with the same pair as a remembered one
shared double opposite_gap[kLanes];  // smallest gap of the planes opposite to a plane, by the invocations that search them
shared uint start_plane[4];  // planes that held the tool in the frame before
// offsets of the planes for the hold with the turn, and for the hold without it
shared double plane_offset[2][kCandidates + 1];

// ---- the point at which planes hold the tool

// Up to four planes that hold a point, kNoPlane for none.
struct ActiveSet {
  uvec4 plane;
  dvec4 m;
  uint size;
  dvec3 point;
  double slack;
};

double Violation(uint hold, ActiveSet held, uint i, dvec3 shift) {
  return plane_offset[hold][i] - dot(plane_n[i], shift + held.point) - held.slack;
}

// Multipliers of the nearest point on all planes of a set, by elimination of the Gram matrix; empty places have a row of the
// unit matrix. False where the planes are parallel or a multiplier is not positive.
bool SolveSet(uint hold, uvec4 p, dvec3 shift, out ActiveSet set) {
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
  // one division for each pivot, since divisions are slow
  dvec4 per;
  bool good = row_0.x > kMinPivot;
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
  good = good && row_1.y > kMinPivot;
  per.y = 1.0lf / row_1.y;
  f = row_2.y * per.y;
  row_2 -= f * row_1;
  v.z -= f * v.y;
  f = row_3.y * per.y;
  row_3 -= f * row_1;
  v.w -= f * v.y;
  good = good && row_2.z > kMinPivot;
  per.z = 1.0lf / row_2.z;
  f = row_3.z * per.z;
  row_3 -= f * row_2;
  v.w -= f * v.z;
  good = good && row_3.w > kMinPivot;
  per.w = 1.0lf;
  if (is.w) per.w = 1.0lf / row_3.w;  // a fourth plane is rare
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

// The planes of `held` selected by the mask, plus the entering one.
uvec4 SelectPlanes(ActiveSet held, uint mask, uint entering) {
  uvec4 p = uvec4((mask & 1u) != 0u ? held.plane.x : kNoPlane, (mask & 2u) != 0u ? held.plane.y : kNoPlane,
                  (mask & 4u) != 0u ? held.plane.z : kNoPlane, entering);
  if ((mask & 8u) != 0u) {
    if (p.x == kNoPlane) p.x = held.plane.w;
    else if (p.y == kNoPlane) p.y = held.plane.w;
    else if (p.z == kNoPlane) p.z = held.plane.w;
  }
  return p;
}

// Moves the planes to x, y, z, w without gaps, so that masks and the host's order agree.
ActiveSet CompactPlanes(ActiveSet set) {
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

// Broadcasts one lane's set to the whole subgroup.
ActiveSet BroadcastLane(ActiveSet own, uint lane) {
  return ActiveSet(subgroupBroadcast(own.plane, lane), subgroupBroadcast(own.m, lane), subgroupBroadcast(own.size, lane),
              subgroupBroadcast(own.point, lane), subgroupBroadcast(own.slack, lane));
}

// Equivalent to simulation::FindConstrainedGoal, about `shift` instead of the tool's pose: run by one subgroup, with the same result
// on every lane.
ActiveSet FindConstrainedGoal(uint hold, dvec3 shift, bool start) {
  uint lane = gl_SubgroupInvocationID, rank = SubgroupRank(), workers = SubgroupWorkers();
  ActiveSet held = ActiveSet(uvec4(kNoPlane), dvec4(0.0lf), 0u, dvec3(0.0lf), 0.0lf);
  for (uint once = start ? 0 : 1; once < 1; ++once) {
    ActiveSet likely;
    uvec4 planes = uvec4(start_plane[0], start_plane[1], start_plane[2], start_plane[3]);
    if (SolveSet(hold, planes, shift, likely) && likely.size > 0u) held = CompactPlanes(likely);
  }
  for (uint round = 0; round < uint(kMaxHoldRounds); ++round) {
    // the most violated plane; among equal ones the first
    float worst = 0.0;
    uint entering = kNoPlane;
    for (uint k = rank; k < there_count; k += workers) {
      uint i = there[k];
      double violation = Violation(hold, held, i, shift);
      if (violation <= kViolated_mm || float(violation) <= worst) continue;
      worst = float(violation);
      entering = i;
    }
    // (integer reductions, which GPUs have in hardware)
    float max_violation = uintBitsToFloat(subgroupMax(floatBitsToUint(worst)));
    // clamp, since software drivers continue with inactive lanes
    entering = min(subgroupMin(worst == max_violation ? entering : kNoPlane), kNoPlane);
    if (entering == kNoPlane) break;
    // choose the subset of the holding planes, with the entering plane, whose point violates the other planes least
    float min_violation = 1e30;
    uint chosen = 16u;
    ActiveSet own = held;
    for (uint mask = rank; mask < (1u << held.size); mask += workers) {
      ActiveSet set;
      bool good = bitCount(mask) < 4 && SolveSet(hold, SelectPlanes(held, mask, entering), shift, set);
      double violation = 0.0lf;
      if (good) {
        if (held.size > 0u) violation = max(violation, Violation(hold, set, held.plane.x, shift));
        if (held.size > 1u) violation = max(violation, Violation(hold, set, held.plane.y, shift));
        if (held.size > 2u) violation = max(violation, Violation(hold, set, held.plane.z, shift));
        if (held.size > 3u) violation = max(violation, Violation(hold, set, held.plane.w, shift));
      }
      if (!good || float(violation) >= min_violation) continue;
      min_violation = float(violation);
      chosen = mask;
      own = set;
    }
    float best = uintBitsToFloat(subgroupMin(floatBitsToUint(min_violation)));
    uint first = subgroupMin(min_violation == best ? chosen : 16u);
    if (first == 16u) break;
    bool again = any(equal(held.plane, uvec4(entering)));
    held = CompactPlanes(BroadcastLane(own, subgroupMin(chosen == first ? lane : gl_SubgroupSize - 1u)));
    if (again) break;
  }
  return held;
}

// The planes that hold the tool, the distance by which friction takes it back, and the part of the multipliers that counts as
// force (equivalent to simulation::SolveContacts).
struct ContactSolution {
  ActiveSet held;
  double normal, force_multiplier_cap;
  dvec3 friction;
};
shared ContactSolution solutions[2];  // with the turn; without

void SolveContacts(uint number, dvec3 origin_motion, double s, float friction) {
  bool turning = number == 0u;
  ContactSolution hold;
  hold.friction = dvec3(0.0lf);
  // then friction, if there is any; a loop, so that FindConstrainedGoal's code is instantiated once
  dvec3 shift = dvec3(0.0lf);
  for (uint pass = 0; pass < 2; ++pass) {
    ActiveSet found = FindConstrainedGoal(number, shift, pass == 0u);
    if (pass == 1u) {
      hold.friction += found.point;
      break;
    }
    hold.held = found;
    hold.normal = found.m.x + found.m.y + found.m.z + found.m.w;
    hold.force_multiplier_cap = ForceMultiplierCap(hold.normal, length(found.point), found.slack);
    if (hold.normal <= 0.0lf || friction <= 0.0) break;
    dvec3 turn = turning ? (1.0lf - s) * dvec3(frame.turn.xyz) : dvec3(0.0lf), slip = dvec3(0.0lf);
    for (uint k = 0; k < found.size; ++k) {
      uint i = found.plane[k];
      dvec3 motion = turning ? plane_motion[i] : origin_motion;
      slip += found.m[k] * (motion + found.point - tool_radius[i] * cross(turn, plane_n[i]));
    }
    slip /= hold.normal;
    dvec3 n = Unit(found.point);
    slip -= dot(n, slip) * n;
    double size = length(slip);
    if (size <= 0.0lf) break;
    hold.friction = -min(1.0lf, double(friction) * hold.force_multiplier_cap / size) * slip;
    // friction's step back may lead into another plane by micrometres: move out again
    shift = found.point + hold.friction;
  }
  if (subgroupElect()) solutions[number] = hold;
}

// ---- candidates

// Loads the candidate of a bin, or a remembered pair, if it exists: not gone, and near the tool at first contact. Its buffer
// loads do not depend on branches.
void LoadCandidate(uint source, double s, double enlargement) {
  bool binned = source < kBins;
  uint k = binned ? 0u : source - kBins;
  Key64 key = fresh.bin_keys[binned ? source : 0u];
  uint remembered_bone = frame.remembered_bone[k], remembered_tool = frame.remembered_tool[k];
  uint ball_count = frame.ball_count, tool_count = frame.tool_count, live_count = frame.live_ball_count;
  uint remembered_count = frame.remembered_count;
  bool is = binned ? key != kNoKey : k < remembered_count;
  uint bone = binned ? BoneOfKey(key, kBoneBits) : remembered_bone;
  uint t = binned ? ToolOfKey(key) : remembered_tool;
  is = is && bone < ball_count && t < tool_count;
  uint slot = slots[is ? bone : 0u];
  dvec4 start = ExactStart(is ? t : 0u);
  dvec3 goal = ExactGoal(is ? t : 0u), at = start.xyz + s * (goal - start.xyz);
  is = is && slot < live_count;
  slot = is ? slot : 0u;
  uint index = live_entries[slot].index;
  vec4 ball = live_balls[slot];
  is = is && index == bone;
  dvec3 from_bone = at - dvec3(ball.xyz);
  double d = length(from_bone), gap = d - start.w - double(ball.w);
  is = is && ball.w > 0.0 && d > 0.0lf && gap < enlargement;
  plane_there[source] = is;
  bone_ball[source] = bone;
  tool_ball[source] = t;
  plane_n[source] = is ? (1.0lf / d) * from_bone : dvec3(0.0lf);
  plane_gap[source] = gap;
  plane_motion[source] = goal - at;
  tool_radius[source] = start.w;
}

shared uint there_bits[3];
shared dvec3 resultant_of[2 * kFaces];
shared double longest_of[64];  // longest travel found by each subgroup

// Index of a plane among the existing ones.
uint IndexOfPlane(uint c) {
  uint place = 0u;
  for (uint w = 0; w < 3; ++w) {
    uint below = c >= 32u * (w + 1u) ? 0xffffffffu : c <= 32u * w ? 0u : (1u << (c - 32u * w)) - 1u;
    place += bitCount(there_bits[w] & below);
  }
  return place;
}

// The faces of the frame before: the mean normal of the balls around each, its weight, and the weight of the exact direction
// instead, because the balls are spread widely. Computed before the hold is known.
struct OldFace {
  dvec3 n, mean;
  bool is;
  double off;
};
shared OldFace old_face[kFaces];
void FindOldFaces() {
  for (uint f = kLanes - 1u - gl_LocalInvocationID.x; f < kFaces; f += kLanes) {
    dvec4 sum = dvec4(0.0lf);
    for (uint i = 0u; i < 4u; ++i)
      sum[i] = NumberOf(Plus(fresh.exact.face_sums[4u * f + i], fresh.exact.face_sums[4u * (kFaces + f) + i]));
    double weighed = length(sum.yzw);
    old_face[f] = OldFace(frame.exact.face_n[f], (1.0lf / max(weighed, 1e-300lf)) * sum.yzw, sum.x > 0.0lf,
                          WidthExactness(weighed / max(sum.x, 1e-300lf)));
  }
}

// Finds the resultant of the faces along these normals. Run by one subgroup, one invocation per face. Never index `held`
// dynamically: it must stay in registers.
void FindResultant(ActiveSet held, double normal, double force_multiplier_cap) {
  // strongest first, so that a new face forms around the plane that holds most
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
  dvec3 n_0 = plane_n[plane.x], n_1 = plane_n[plane.y], n_2 = plane_n[plane.z], n_3 = plane_n[plane.w];
  bvec4 is = lessThan(uvec4(0u, 1u, 2u, 3u), uvec4(held.size));
  // assign each plane to a face of the frame before; a plane without one begins a new face
  uvec4 face = uvec4(is.x ? kFaces : kNoFace, is.y ? kFaces + 1u : kNoFace, is.z ? kFaces + 2u : kNoFace,
                     is.w ? kFaces + 3u : kNoFace);
  dvec4 nearest = dvec4(kFaceCosine);
  for (uint f = 0u; f < kFaces; ++f) {
    dvec3 n = old_face[f].n;
    dvec4 cosine = dvec4(dot(n_0, n), dot(n_1, n), dot(n_2, n), dot(n_3, n));
    bvec4 nearer = greaterThan(cosine, nearest);
    if (is.x && nearer.x) face.x = f;
    if (is.y && nearer.y) face.y = f;
    if (is.z && nearer.z) face.z = f;
    if (is.w && nearer.w) face.w = f;
    nearest = max(nearest, cosine);
  }
  // or let it join a new face: compare with the sum of the planes that have joined each so far
  if (is.y && any(greaterThanEqual(face.yzw, uvec3(kFaces)))) {
    uint of[4] = uint[](face.x, face.y, face.z, face.w);
    dvec3 n[4] = dvec3[](n_0, n_1, n_2, n_3);
    double share[4] = double[](m.x, m.y, m.z, m.w);
    for (uint k = 1u; k < held.size; ++k)
      for (uint first = of[k] < kFaces ? k : 0u; first < k; ++first) {
        if (of[first] != kFaces + first) continue;
        dvec3 sum = dvec3(0.0lf);
        for (uint i = first; i < k; ++i)
          if (of[i] == kFaces + first) sum += share[i] * n[i];
        if (dot(n[k], sum) > kFaceCosine * length(sum)) of[k] = kFaces + first;
      }
    face = uvec4(of[0], of[1], of[2], of[3]);
  }
  double per_normal = normal > 0.0lf ? 1.0lf / normal : 0.0lf, free_share = normal > 0.0lf ? force_multiplier_cap * per_normal : 1.0lf;
  // sum of the multipliers of each plane's face
  dvec4 own = dvec4(dot(m, dvec4(equal(face, uvec4(face.x)))), dot(m, dvec4(equal(face, uvec4(face.y)))),
                    dot(m, dvec4(equal(face, uvec4(face.z)))), dot(m, dvec4(equal(face, uvec4(face.w)))));
  dvec4 counted = own * dvec4(is);
  double largest = max(max(counted.x, counted.y), max(counted.z, counted.w));
  uvec4 cutters = uvec4(lessThan(uvec4(tool_ball[min(plane.x, kCandidates - 1u)], tool_ball[min(plane.y, kCandidates - 1u)],
                                       tool_ball[min(plane.z, kCandidates - 1u)], tool_ball[min(plane.w, kCandidates - 1u)]),
                                 uvec4(frame.cutter_count)));
  for (uint f = SubgroupRank(), step = SubgroupWorkers(); f < 2u * kFaces; f += step) {
    dvec4 here = dvec4(equal(face, uvec4(f))) * m;
    dvec3 hold_f = here.x * n_0 + here.y * n_1 + here.z * n_2 + here.w * n_3;
    double multiplier = here.x + here.y + here.z + here.w, cuts = dot(here, dvec4(cutters)), size = length(hold_f);
    OldFace old = old_face[min(f, kFaces - 1u)];
    dvec3 n = (1.0lf / max(size, 1e-300lf)) * hold_f;
    if (f < kFaces && old.is) {
      double exact = Exactness(largest * per_normal, old.off);
      n = Unit((1.0lf - exact) * old.mean + exact * n);
    }
    resultant_of[f] = size > 0.0lf ? cuts / multiplier * (free_share * size * n + (1.0lf - free_share) * multiplier *
                                                                                       per_normal * held.point)
                                   : dvec3(0.0lf);
  }
}

// Called by all invocations of a workgroup.
void Solve() {
  uint lane = gl_LocalInvocationID.x;
  bool needs_rebuild = NeedsRebuild();
  double s = ExactFraction(), tolerance = frame.exact.tolerance;
  bool advances = frame.immediate == 0u && frame.exact.spindle_rad_per_s != 0.0lf && frame.exact.dt_s > 0.0lf;
  double max_slide = frame.exact.max_slide * (advances ? kSlideShare : 1.0lf);
  dvec3 motion = frame.exact.goal - (frame.exact.start + s * (frame.exact.goal - frame.exact.start));  // motion of T's origin
  uint hold_count = frame.turning != 0u ? 2u : 1u, held_count = frame.held_count;
  float friction_share = frame.friction;
  FindOldFaces();  // run by the last invocations, which have no pair to wait for
  for (uint source = lane; source < kCandidates; source += kLanes) LoadCandidate(source, s, frame.exact.enlargement);
  for (uint k = lane; k < kRemembered; k += kLanes) bin_of[k] = kNoPlane;
  if (lane < 4u) start_plane[lane] = kNoPlane;
  if (lane < 3u) there_bits[lane] = 0u;
  if (lane == 0u) {
    plane_n[kNoPlane] = dvec3(0.0lf);
    plane_offset[0][kNoPlane] = plane_offset[1][kNoPlane] = 0.0lf;
  }
  barrier();
  // a remembered pair that is also in a bin counts once
  for (uint i = lane; i < kRemembered * kBins; i += kLanes) {
    uint k = i / kBins, bin = i % kBins;
    if (plane_there[kBins + k] && plane_there[bin] && bone_ball[bin] == bone_ball[kBins + k] &&
        tool_ball[bin] == tool_ball[kBins + k])
      bin_of[k] = bin;
  }
  barrier();
  for (uint c = lane; c < kCandidates; c += kLanes) {
    uint k = c < kBins ? 0u : c - kBins;
    bool twice = c >= kBins && bin_of[k] != kNoPlane, is = plane_there[c];
    if (is && c >= kBins && k < held_count) start_plane[k] = twice ? bin_of[k] : c;
    if (is && !twice) atomicOr(there_bits[c / 32u], 1u << (c % 32u));
  }
  barrier();
  for (uint c = lane; c < kCandidates; c += kLanes)
    if ((there_bits[c / 32u] >> (c % 32u) & 1u) != 0u) there[IndexOfPlane(c)] = c;
  if (lane == 0u) there_count = IndexOfPlane(kCandidates);
  barrier();
  // Where two planes face each other with less than the tolerance between them, both yield. The available invocations share the
  // search for a plane's opposite ones.
  uint count = there_count, each = max(1u, kLanes / max(1u, count)), planes = kLanes / each;
  for (uint begin = 0u; begin < count; begin += planes) {
    uint k = begin + lane / each, c = there[min(k, kCandidates - 1u)];
    dvec3 n = plane_n[k < count ? c : kNoPlane];
    double min_gap = tolerance + 1e3lf;
    for (uint i = lane % each; i < count; i += each) {
      uint other = there[i];
      double gap = plane_gap[other];
      min_gap = dot(plane_n[other], n) < kOppositeCosine ? min(min_gap, gap) : min_gap;
    }
    opposite_gap[lane] = min_gap;
    barrier();
    if (lane % each == 0u && k < count && lane / each < planes) {
      for (uint i = 1u; i < each; ++i) min_gap = min(min_gap, opposite_gap[lane + i]);
      double room = min(tolerance, plane_gap[c] + min_gap);
      double yielding = YieldingGap(plane_gap[c], room, tolerance);
      yielding_gap[c] = yielding;
      plane_offset[0][c] = -(yielding + dot(n, plane_motion[c]));
      plane_offset[1][c] = -(yielding + dot(n, motion));
    }
    barrier();
  }
  for (uint number = gl_SubgroupID; number < hold_count; number += gl_NumSubgroups) SolveContacts(min(number, 1u), motion, s, friction_share);
  for (uint k = kLanes - 1u - lane; k < (needs_rebuild ? 0u : there_count); k += kLanes) {
    uint c = there[k];
    vec3 n = vec3(plane_n[c]);
    frame.candidates[k] = Candidate(n.x, n.y, n.z, float(plane_gap[c]), float(yielding_gap[c]), bone_ball[c],
                                           tool_ball[c], c);
  }
  barrier();
  ContactSolution hold = solutions[0], unturned = solutions[hold_count - 1u];
  ActiveSet held = hold.held;
  dvec3 friction = hold.friction, delta = held.point + friction;
  // one subgroup continues; the others compute what only the next pass needs
  if (gl_SubgroupID == 0u) FindResultant(held, hold.normal, hold.force_multiplier_cap);
  if (lane == kLanes - 1u && !needs_rebuild) {
    frame.candidate_count = there_count;
    frame.shaft_candidate = IndexOfPlane(kCuttingBinCount);
    frame.shaft_end = IndexOfPlane(kBins);
    frame.hold_count = held.size;
    for (uint k = 0; k < 4; ++k) {
      frame.hold_candidate[k] = held.plane[k] != kNoPlane ? IndexOfPlane(held.plane[k]) : kNoPlane;
      frame.exact.hold[k] = held.m[k];
      frame.exact.hold_n[k] = plane_n[held.plane[k]];
    }
    frame.friction_mm = vec4(vec3(friction), float(held.slack));
    dvec3 shift = motion + unturned.held.point + unturned.friction;
    double straight = length(shift);
    frame.exact.shift = shift;
    frame.shift_mm = vec4(vec3(shift), 0.0);
    frame.exact.straight_way = straight;
    frame.exact.straight_limit = straight > max_slide ? max_slide / straight : 1.0lf;
    frame.turns = 1u;
  }
  // travel to the target of the tool point that moves farthest
  double longest = length(motion + delta);
  uint end_tool = hold_count == 2u ? frame.tool_count : 0u;
  for (uint t = kLanes - 1u - lane; t < end_tool; t += kLanes) {
    float about = distance(AtContact(t, float(s)).xyz, Goal(t) + vec3(delta));
    for (uint may = about + frame.rounding_mm > float(longest) ? 0 : 1; may < 1; ++may)
      longest = max(longest, length(ExactGoal(t) + delta - ExactAtContact(t, s).xyz));
  }
  longest = subgroupMax(longest);
  if (subgroupElect()) longest_of[gl_SubgroupID] = longest;
  barrier();
  if (lane == 0) frame.needs_rebuild = needs_rebuild ? 1u : 0u;
  if (lane != 0 || needs_rebuild) return;
  dvec3 cutting = dvec3(0.0lf);
  for (uint f = 0; f < 2u * kFaces; ++f) cutting += resultant_of[f];
  for (uint k = 0; k < gl_NumSubgroups; ++k) longest = max(longest, longest_of[k]);
  double size = length(cutting), per_size = size > 0.0lf ? 1.0lf / size : 0.0lf;
  frame.exact.way = longest;
  frame.exact.slide_limit = longest > max_slide ? max_slide / longest : 1.0lf;
  // results where no later pass has work to do
  frame.exact.slid_share = frame.exact.slide_limit;
  frame.exact.delta = delta;
  frame.exact.cutting = size;
  frame.exact.n = per_size * cutting;
  frame.delta = vec4(vec3(delta), float(size));
}
