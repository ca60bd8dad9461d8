#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, second half, one workgroup: planes from their sums, then the closest target to the tool's pose that keeps all of
// them (twin of kinematics/half_spaces.cpp): every set of one, two or three planes is one candidate.
#include "common.glsl"

layout(constant_id = 3) const bool kSumPoints = true;  // false: one cutting ball, number kOnlyCutting
layout(constant_id = 4) const uint kOnlyCutting = 0;

shared uint solved;
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

// Set number k of 8 planes: sizes 1, 2, 3 in index order; a nibble a plane, the size in bits 12 up.
uint SetNumber(uint k) {
  if (k < 8) return k | (1u << 12);
  uint n = 8;
  for (uint i = 0; i < 8; ++i)
    for (uint j = i + 1; j < 8; ++j) {
      if (n == k) return i | (j << 4) | (2u << 12);
      ++n;
    }
  for (uint i = 0; i < 8; ++i)
    for (uint j = i + 1; j < 8; ++j)
      for (uint l = j + 1; l < 8; ++l) {
        if (n == k) return i | (j << 4) | (l << 8) | (3u << 12);
        ++n;
      }
  return 0;
}

void Try(uint k) {
  candidate_set[k] = 0xffffu;
  uint set = SetNumber(k);
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
  if (lane < kPlanes) {
    uint row = lane * kPlaneColumns;
    float weight = Total(frame.plane_sums[row], kNormalScale);
    vec3 n = vec3(Total(frame.plane_sums[row + 1], kNormalScale), Total(frame.plane_sums[row + 2], kNormalScale),
                  Total(frame.plane_sums[row + 3], kNormalScale));
    vec3 point = vec3(Total(frame.plane_sums[row + 4], frame.point_scale), Total(frame.plane_sums[row + 5], frame.point_scale),
                      Total(frame.plane_sums[row + 6], frame.point_scale));
    float size = length(n);
    bool present = size > 1e-6 * weight;
    frame.plane_n[lane] =
        present ? vec4(n / size, FromOrderedBits(frame.plane_gap_bits[lane])) : vec4(0.0);
    vec4 head = frame.contact[kOnlyCutting];
    vec3 mean = kSumPoints || lane == kShaft ? frame.contact[frame.tool_count].xyz + point / weight
                                             : head.xyz - head.w * (n / size);
    frame.plane_point[lane] = present ? vec4(mean, weight) : vec4(0.0);
    frame.multiplier[lane] = 0.0;
  }
  memoryBarrierBuffer();
  barrier();

  for (uint clipped = 0; clipped < 2; ++clipped) {
    if (lane == 0) {
      vec3 origin = frame.contact[frame.tool_count].xyz;
      vec3 motion = frame.goal[frame.tool_count].xyz - origin;
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
    for (uint k = lane; k < 92; k += 64) Try(k);
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
      frame.delta = vec4(delta, size);
      frame.n = size > 0.0 ? vec4(cutting / size, 0.0) : vec4(0.0);
      solved = feasible ? 1u : 0u;  // tells the others whether a second round is due
      float longest = 0.0;
      for (uint t = 0; t <= frame.tool_count; ++t) {
        vec3 target = frame.goal[t].xyz + delta;
        frame.target[t] = vec4(target, 0.0);
        longest = max(longest, distance(frame.contact[t].xyz, target));
      }
      frame.way_mm = longest;
      frame.slide_limit = longest > frame.max_slide_mm ? frame.max_slide_mm / longest : 1.0;
    }
    barrier();
    if (solved == 1u) break;
  }
}
