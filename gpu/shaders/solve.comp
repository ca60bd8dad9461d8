#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, second half, one workgroup: planes from their sums, then the closest target to the tool's pose that keeps all of
// them (twin of kinematics/half_spaces.cpp): every set of one, two or three planes is one candidate.
#include "common.glsl"

shared uint solved;
shared uint longest_bits;
shared vec3 found;
shared vec4 plane[kPlanes];    // n, offset
shared uint plane_group[kPlanes];
shared uint plane_count;
shared vec4 candidate[92];     // x, violation
shared vec3 candidate_m[92];   // multipliers
shared uint candidate_set[92]; // planes, a nibble each; 0xffff: none

const float kFeasible = 1e-4;        // mm
const float kLeastVolume = 1e-5;     // of a Gram determinant

float Violation(vec3 x) {
  float worst = 0.0;
  for (uint i = 0; i < plane_count; ++i) worst = max(worst, plane[i].w - dot(plane[i].xyz, x));
  return worst;
}

// The sets of one, two and three of 8 planes, by size and in index order; a nibble a plane, the size in bits 12 up.
const uint kSets[92] = uint[92](
    0x1000u, 0x1001u, 0x1002u, 0x1003u, 0x1004u, 0x1005u, 0x1006u, 0x1007u, 0x2010u, 0x2020u, 0x2030u, 0x2040u,
    0x2050u, 0x2060u, 0x2070u, 0x2021u, 0x2031u, 0x2041u, 0x2051u, 0x2061u, 0x2071u, 0x2032u, 0x2042u, 0x2052u,
    0x2062u, 0x2072u, 0x2043u, 0x2053u, 0x2063u, 0x2073u, 0x2054u, 0x2064u, 0x2074u, 0x2065u, 0x2075u, 0x2076u,
    0x3210u, 0x3310u, 0x3410u, 0x3510u, 0x3610u, 0x3710u, 0x3320u, 0x3420u, 0x3520u, 0x3620u, 0x3720u, 0x3430u,
    0x3530u, 0x3630u, 0x3730u, 0x3540u, 0x3640u, 0x3740u, 0x3650u, 0x3750u, 0x3760u, 0x3321u, 0x3421u, 0x3521u,
    0x3621u, 0x3721u, 0x3431u, 0x3531u, 0x3631u, 0x3731u, 0x3541u, 0x3641u, 0x3741u, 0x3651u, 0x3751u, 0x3761u,
    0x3432u, 0x3532u, 0x3632u, 0x3732u, 0x3542u, 0x3642u, 0x3742u, 0x3652u, 0x3752u, 0x3762u, 0x3543u, 0x3643u,
    0x3743u, 0x3653u, 0x3753u, 0x3763u, 0x3654u, 0x3754u, 0x3764u, 0x3765u);

void Try(uint k) {
  candidate_set[k] = 0xffffu;
  uint set = kSets[k];
  uint size = set >> 12;
  uint a = set & 15u, b = (set >> 4) & 15u, c = (set >> 8) & 15u;
  uint last = size == 1 ? a : size == 2 ? b : c;
  if (last >= plane_count) return;
  vec3 m = vec3(0.0), x;
  vec3 na = plane[a].xyz, nb = plane[b].xyz, nc = plane[c].xyz;
  if (size == 1) {
    m.x = plane[a].w;
    x = m.x * na;
  } else if (size == 2) {
    float g = dot(na, nb), det = 1.0 - g * g;
    if (det < kLeastVolume) return;
    m.x = (plane[a].w - g * plane[b].w) / det;
    m.y = (plane[b].w - g * plane[a].w) / det;
    x = m.x * na + m.y * nb;
  } else {
    float ab = dot(na, nb), ac = dot(na, nc), bc = dot(nb, nc);
    mat3 gram = mat3(1.0, ab, ac, ab, 1.0, bc, ac, bc, 1.0);
    if (determinant(gram) < kLeastVolume) return;
    m = inverse(gram) * vec3(plane[a].w, plane[b].w, plane[c].w);
    x = m.x * na + m.y * nb + m.z * nc;
  }
  if (min(m.x, min(m.y, m.z)) < 0.0) return;
  candidate[k] = vec4(x, Violation(x));
  candidate_m[k] = m;
  candidate_set[k] = set;
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  if (lane == 0) frame.is_void = IsVoid() ? 1u : 0u;
  for (uint p = lane; p < kPlanes; p += kLanes) {
    uint row = p * kPlaneColumns;
    float weight = Total(frame.plane_sums[row], kNormalScale);
    vec3 n = vec3(Total(frame.plane_sums[row + 1], kNormalScale), Total(frame.plane_sums[row + 2], kNormalScale),
                  Total(frame.plane_sums[row + 3], kNormalScale));
    vec3 point = vec3(Total(frame.plane_sums[row + 4], frame.point_scale), Total(frame.plane_sums[row + 5], frame.point_scale),
                      Total(frame.plane_sums[row + 6], frame.point_scale));
    float size = length(n);
    bool present = size > 1e-6 * weight;
    frame.plane_n[p] =
        present ? vec4(n / size, FromOrderedBits(frame.plane_gap_bits[p])) : vec4(0.0);
    // for a single cutting ball the mean touching point follows from the normal
    float s = ContactFraction();
    vec4 head = AtContact(0, s);
    vec3 mean = !kOneCutter || p == kShaft ? OriginAtContact(s) + point / weight : head.xyz - head.w * (n / size);
    frame.plane_point[p] = present ? vec4(mean, weight) : vec4(0.0);
    frame.multiplier[p] = 0.0;
  }
  memoryBarrierBuffer();
  barrier();

  for (uint clipped = 0; clipped < 2; ++clipped) {
    if (lane == 0) {
      vec3 origin = OriginAtContact(ContactFraction());
      vec3 motion = frame.goal.xyz - origin;
      vec3 turn = (1.0 - ContactFraction()) * frame.turn.xyz;
      uint count = 0, present = 0;
      for (uint g = 0; g < kPlanes; ++g) {
        if (frame.plane_point[g].w <= 0.0) continue;
        present |= 1u << g;
        vec3 n = frame.plane_n[g].xyz;
        float gap = frame.plane_n[g].w;
        if (clipped == 1) gap = max(gap, 0.0);
        float at_goal = gap + dot(n, motion + cross(turn, frame.plane_point[g].xyz - origin));
        plane[count] = vec4(n, -at_goal);
        plane_group[count] = g;
        ++count;
      }
      plane_count = count;
      frame.planes_present = present;
    }
    barrier();
    for (uint k = lane; k < 92; k += kLanes) Try(k);
    barrier();
    if (lane == 0) {
      float free_violation = Violation(vec3(0.0));
      uint best = 0xffffu;
      float best_distance = 0.0, best_violation = free_violation;
      bool feasible = free_violation <= 0.0;
      if (!feasible) {
        for (uint k = 0; k < 92; ++k) {
          if (candidate_set[k] == 0xffffu) continue;
          bool keeps = candidate[k].w <= kFeasible;
          float d = dot(candidate[k].xyz, candidate[k].xyz);
          bool better = keeps ? (!feasible || d < best_distance) : (!feasible && candidate[k].w < best_violation);
          if (!better) continue;
          feasible = keeps;
          best = k;
          best_distance = d;
          best_violation = candidate[k].w;
        }
      }
      vec3 delta = vec3(0.0), cutting = vec3(0.0);
      for (uint g = 0; g < kPlanes; ++g) frame.multiplier[g] = 0.0;
      if (best != 0xffffu) {
        delta = candidate[best].xyz;
        uint set = candidate_set[best];
        for (uint j = 0; j < (set >> 12); ++j) {
          uint p = (set >> (4 * j)) & 15u;
          uint g = plane_group[p];
          float m = candidate_m[best][j];
          frame.multiplier[g] = m;
          if (g != kShaft) cutting += m * plane[p].xyz;
        }
      }
      float size = length(cutting);
      found = delta;
      frame.delta = vec4(delta, size);
      frame.n = size > 0.0 ? vec4(cutting / size, 0.0) : vec4(0.0);
      solved = feasible ? 1u : 0u;  // tells the others whether a second round is due
    }
    barrier();
    if (solved == 1u) break;
  }

  // the way to the target of the tool point that moves farthest
  if (lane == 0) longest_bits = 0u;
  barrier();
  float at_contact = ContactFraction(), longest = 0.0;
  for (uint t = lane; t < frame.tool_count; t += kLanes)
    longest = max(longest, distance(AtContact(t, at_contact).xyz, Goal(t) + found));
  longest = max(longest, distance(OriginAtContact(at_contact), frame.goal.xyz + found));
  atomicMax(longest_bits, floatBitsToUint(longest));
  barrier();
  if (lane == 0) {
    longest = uintBitsToFloat(longest_bits);
    frame.way_mm = longest;
    frame.slide_limit = longest > frame.max_slide_mm ? frame.max_slide_mm / longest : 1.0;
  }
}
