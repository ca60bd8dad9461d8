// What the shaders and C++ both see: sizes, bindings, and the memory layout of every buffer. Included by
// both. Lengths in millimetres relative to the packing's origin, forces in newtons, work in newton
// millimetres.
#ifndef OSTEON_GPU_LAYOUT_H
#define OSTEON_GPU_LAYOUT_H

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace osteon::gpu {
using uint = std::uint32_t;
using std::int32_t;
struct vec4 {
  float x, y, z, w;
};
#define OSTEON_CONST inline constexpr
#define OSTEON_ARRAY(type, name, count) std::array<type, count> name
#else
#define OSTEON_CONST const
#define OSTEON_ARRAY(type, name, count) type name[count]
#endif

OSTEON_CONST uint kGroupSize = 64;  // invocations of a workgroup; balls or points of a cluster
OSTEON_CONST uint kMaxToolBalls = 64;
OSTEON_CONST uint kMaxMaterials = 8;
OSTEON_CONST uint kPlanes = 8;  // groups of contacts, see PlaneGroup
OSTEON_CONST uint kShaft = 7;
OSTEON_CONST uint kPlaneColumns = 7;  // weight, weight u (3), weight point (3)

// A sum in fixed point: high * 2^16 + low, in units of 1/scale. Whole numbers add up to the same in any
// order, so that a frame's result does not depend on scheduling.
struct Sum {
  int high;
  uint low;
};

// Arguments of an indirect dispatch.
struct Groups {
  uint x, y, z;
};

// One frame: what the host writes, then what the passes find. Copied to the device before them and back
// after.
struct Frame {
  // host
  // tool ball centres at the proxy; w: radius. Entry tool_count: T's origin
  OSTEON_ARRAY(vec4, start, kMaxToolBalls + 1);
  OSTEON_ARRAY(vec4, goal, kMaxToolBalls + 1);   // the same at the tool's pose; w: 1 cutting, 0 not
  OSTEON_ARRAY(vec4, built, kMaxToolBalls + 1);  // where the tool was when the lists of live balls and points
                                                 // were made; w: how far from there they serve
  OSTEON_ARRAY(vec4, contact, kMaxToolBalls + 1);  // found: the same at first contact; w: radius
  OSTEON_ARRAY(vec4, target, kMaxToolBalls + 1);   // found: the constrained target
  OSTEON_ARRAY(vec4, slid, kMaxToolBalls + 1);     // found: after the slide
  OSTEON_ARRAY(vec4, end, kMaxToolBalls + 1);      // found: after the advance, the new proxy
  OSTEON_ARRAY(vec4, material, kMaxMaterials);  // x specific cutting energy [N/mm^2], y cutting-force ratio
  vec4 axis_x, axis_y, axis_z;                  // T's axes in G at the tool's pose
  vec4 turn;                                    // rotation vector from the proxy to the tool's pose
  float spindle_rad_per_s;
  float dt_s;
  float stiffness_N_per_mm;
  float max_force_N;
  float enlargement_mm;
  float tolerance_mm;
  float layer_mm;
  float work_held_back_Nmm;  // share of the debt that this frame pays
  uint tool_count;
  uint ball_count;
  uint point_count;
  uint material_count;
  uint immediate;
  // units of the fixed-point sums: no summand reaches 2^23 of them
  float point_scale;   // per mm^4, of lens volume times a touching point's place
  float area_scale;    // per mm^2
  float moment_scale;  // per mm^3
  float max_slide_mm;
  // balls and points further than this from the tool at first contact play no part after it
  float ball_reach_mm;
  float point_reach_mm;
  // passes
  uint contact_bits;  // fraction of first contact, as bits: those of floats of one sign order like the floats
  uint slide_bits;
  float slide_limit;  // fraction of the way to the target that the slide may take
  Groups path_balls;  // clusters that the way from proxy to tool meets
  Groups near_balls;  // clusters within reach at first contact
  Groups near_points;
  Groups live_balls;  // workgroups for the balls within reach
  Groups live_points;
  Groups shaft_balls;  // the same list, as far as balls of it meet the shaft's margin
  uint live_ball_count, live_point_count;
  uint cutting_low, cutting_high;  // mask of the tool balls that cut
  Groups reach_groups;  // workgroups of the passes that run only where the lists have to be made anew
  Groups place_groups;
  Groups near_groups;
  uint rebuilt;      // the lists were made anew at this frame's first contact
  float way_mm;      // from first contact to the target, of the tool point that moves farthest
  uint lists_serve;  // 0: there are no lists yet, or they reach less far than this frame asks
  vec4 delta;        // to the constrained target; w: length of the cutting planes' share
  vec4 n;            // direction of the cutting planes' resultant
  float advance_mm;
  float edge_work_Nmm;
  uint planes_present;                       // bit per plane
  OSTEON_ARRAY(vec4, plane_n, kPlanes);      // w: smallest gap
  OSTEON_ARRAY(vec4, plane_point, kPlanes);  // w: lens volume
  OSTEON_ARRAY(float, multiplier, kPlanes);
  OSTEON_ARRAY(uint, plane_gap_bits, kPlanes);  // smallest gap, as bits that order like the float
  OSTEON_ARRAY(Sum, plane_sums, kPlanes* kPlaneColumns);
  OSTEON_ARRAY(Sum, engaged_sums, 2 * kMaxMaterials);  // area and moment by material
  OSTEON_ARRAY(float, engaged, 2 * kMaxMaterials);
  OSTEON_ARRAY(uint, removed, kMaxMaterials);  // cleared volume in units of the bone's
};

// Box around a cluster of balls (whole balls) or of points, as they were at the start: conservative for ever.
// A cluster of which nothing is left is passed over.
struct Cluster {
  float low_x, low_y, low_z;
  uint alive;
  float high_x, high_y, high_z;
  uint pad;
};

// A cluster, ball or point that a pass has to look at, and the tool balls that can reach it.
struct Active {
  uint index;
  uint tool_low, tool_high;  // mask
};

// A mass point. units: its volume in the bone's units; material; cleared: 1 where it is gone.
struct Point {
  float x, y, z;
  float volume_mm3;
  uint units;
  uint material;
  uint cleared;
};

#ifdef __cplusplus
static_assert(sizeof(Frame) % 4 == 0);
static_assert(offsetof(Frame, material) == 16 * 7 * 65);
static_assert(offsetof(Frame, spindle_rad_per_s) == 16 * (7 * 65 + 8 + 4));
static_assert(offsetof(Frame, delta) == offsetof(Frame, spindle_rad_per_s) + 56 * 4);
static_assert(sizeof(Cluster) == 32 && sizeof(Point) == 28 && sizeof(Active) == 12 && sizeof(Sum) == 8);
}  // namespace osteon::gpu
#endif
#undef OSTEON_CONST
#undef OSTEON_ARRAY
#endif
