// Bindings and helpers that every pass uses.
#extension GL_EXT_scalar_block_layout : require
#include "layout.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) buffer FrameBuffer { Frame frame; };
layout(scalar, binding = 1) buffer BallBuffer { vec4 balls[]; };  // centre, radius; radius 0: gone
layout(scalar, binding = 2) buffer PointBuffer { Point points[]; };
layout(scalar, binding = 3) readonly buffer BallClusters { Cluster ball_clusters[]; };
layout(scalar, binding = 4) readonly buffer PointClusters { Cluster point_clusters[]; };
// by workgroup: a flag, then columns
layout(scalar, binding = 5) buffer PlaneSums { float plane_sums[]; };
layout(scalar, binding = 6) buffer EngagedSums { float engaged_sums[]; };

const float kInfinity = 1e30;
const uint kPlaneStride = 1 + kPlanes * kPlaneColumns;
const uint kEngagedStride = 1 + kEngagedColumns;

// Placements of the tool in the frame, by tool ball (or T's origin).
float ContactFraction() { return min(1.0, uintBitsToFloat(frame.contact_bits)); }
float SlideFraction() { return min(1.0, uintBitsToFloat(frame.slide_bits)); }
vec3 AtContact(uint t) { return mix(frame.start[t].xyz, frame.goal[t].xyz, ContactFraction()); }
vec3 AtTarget(uint t) { return frame.goal[t].xyz + frame.delta.xyz; }
vec3 AtSlid(uint t) { return mix(AtContact(t), AtTarget(t), SlideFraction()); }
vec3 AtEnd(uint t) { return AtSlid(t) + (frame.origin_end.xyz - frame.origin_slid.xyz); }

vec3 ClosestOnSegment(vec3 p, vec3 a, vec3 b) {
  vec3 m = b - a;
  float mm = dot(m, m);
  return mm == 0.0 ? a : a + clamp(dot(p - a, m) / mm, 0.0, 1.0) * m;
}

// Distance from a box to a point; 0 inside.
float BoxDistance(Cluster box, vec3 p) {
  return length(max(max(box.low.xyz - p, p - box.high.xyz), vec3(0.0)));
}

// Whether a ball of radius r that moves from a to b can reach the box: the ball around its path must.
bool PathMeetsBox(Cluster box, vec3 a, vec3 b, float r) {
  return BoxDistance(box, 0.5 * (a + b)) <= r + 0.5 * distance(a, b) + 1e-4;
}
