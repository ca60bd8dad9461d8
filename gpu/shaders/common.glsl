// Bindings and helpers that every pass uses.
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "layout.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) buffer FrameBuffer { Frame frame; };
layout(scalar, binding = 1) buffer BallBuffer { vec4 balls[]; };  // centre, radius; radius 0: gone
layout(scalar, binding = 2) buffer PointBuffer { Point points[]; };
layout(scalar, binding = 3) buffer BallClusters { Cluster ball_clusters[]; };
layout(scalar, binding = 4) buffer PointClusters { Cluster point_clusters[]; };
// by workgroup: a flag, then columns
layout(scalar, binding = 5) buffer PathBalls { Active path_balls[]; };
layout(scalar, binding = 6) buffer NearBalls { Active near_balls[]; };
layout(scalar, binding = 7) buffer NearPoints { Active near_points[]; };
layout(scalar, binding = 8) buffer LiveBalls { Active live_balls[]; };
layout(scalar, binding = 9) buffer LivePoints { Active live_points[]; };

const float kNormalScale = 16777216.0;  // units per mm^3

// Adds the values of this subgroup's active invocations to a fixed-point sum. A value's size times its scale is below 2^23,
// so that 64 of them fit an int. Whole numbers: exact in any order.
#define ADD_TO(sum, scaled)                              \
  {                                                      \
    int whole = subgroupAdd(int(round(scaled)));         \
    if (subgroupElect()) {                               \
      atomicAdd(sum.high, whole >> 16);                  \
      atomicAdd(sum.low, uint(whole & 0xffff));          \
    }                                                    \
  }
// The sum's value. How it is split into high and low depends on who added with whom, so the carry goes over first: what is
// rounded to a float is then the same for equal sums.
float Total(Sum sum, float scale) {
  int high = sum.high + int(sum.low >> 16);
  return (float(high) * 65536.0 + float(sum.low & 0xffffu)) / scale;
}

// Bits that order like the float, negative ones too, and back.
uint OrderedBits(float v) {
  uint bits = floatBitsToUint(v);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float FromOrderedBits(uint bits) {
  return uintBitsToFloat((bits & 0x80000000u) != 0u ? bits & 0x7fffffffu : ~bits);
}

// Masks of tool balls. Loops go over the bits that are set, not over all tool balls: software drivers execute a skipped
// iteration in full.
//     for (uvec2 rest = mask; Any(rest); rest = WithoutLowest(rest)) { uint t = Lowest(rest); ... }
bool Any(uvec2 mask) { return (mask.x | mask.y) != 0u; }
uint Lowest(uvec2 mask) { return mask.x != 0u ? uint(findLSB(mask.x)) : 32u + uint(findLSB(mask.y)); }
uvec2 WithoutLowest(uvec2 mask) {
  return mask.x != 0u ? uvec2(mask.x & (mask.x - 1u), mask.y) : uvec2(0u, mask.y & (mask.y - 1u));
}
uvec2 Bit(uint t) { return t < 32u ? uvec2(1u << t, 0u) : uvec2(0u, 1u << (t - 32u)); }
uvec2 Tools(Active a) { return uvec2(a.tool_low, a.tool_high); }
uvec2 ShaftTools(Active a) { return Tools(a) & ~uvec2(frame.cutting_low, frame.cutting_high); }
uvec2 CuttingTools(Active a) { return Tools(a) & uvec2(frame.cutting_low, frame.cutting_high); }

float ContactFraction() { return min(1.0, uintBitsToFloat(frame.contact_bits)); }
float SlideFraction() { return min(frame.slide_limit, uintBitsToFloat(frame.slide_bits)); }

vec3 ClosestOnSegment(vec3 p, vec3 a, vec3 b) {
  vec3 m = b - a;
  float mm = dot(m, m);
  return mm == 0.0 ? a : a + clamp(dot(p - a, m) / mm, 0.0, 1.0) * m;
}

// Distance from a box to a point; 0 inside.
float BoxDistance(Cluster box, vec3 p) {
  vec3 low = vec3(box.low_x, box.low_y, box.low_z), high = vec3(box.high_x, box.high_y, box.high_z);
  return length(max(max(low - p, p - high), vec3(0.0)));
}

// Whether a ball of radius r that moves from a to b can reach the box: the ball around its path must.
bool PathMeetsBox(Cluster box, vec3 a, vec3 b, float r) {
  return BoxDistance(box, 0.5 * (a + b)) <= r + 0.5 * distance(a, b) + 1e-4;
}
