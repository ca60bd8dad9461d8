// What the shaders and C++ both see: sizes, bindings, and the memory layout of every buffer. Included by both.
// Lengths in millimetres relative to the packing's origin, forces in newtons, work in newton millimetres.
#ifndef OSTEON_GPU_LAYOUT_H
#define OSTEON_GPU_LAYOUT_H

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace osteon::gpu {
using uint = std::uint32_t;
struct vec4 {
  float x, y, z, w;
};
#define OSTEON_CONST inline constexpr
#define OSTEON_ARRAY(type, name, count) std::array<type, count> name
#else
#define OSTEON_CONST const
#define OSTEON_ARRAY(type, name, count) type name[count]
#endif

OSTEON_CONST uint kGroupSize = 64;      // invocations of a workgroup; balls or points of a cluster
OSTEON_CONST uint kMaxToolBalls = 64;
OSTEON_CONST uint kMaxMaterials = 8;
OSTEON_CONST uint kPlanes = 8;          // groups of contacts, see PlaneGroup
OSTEON_CONST uint kShaft = 7;
OSTEON_CONST uint kPlaneColumns = 8;    // weight, weight u (3), weight point (3), smallest gap
OSTEON_CONST uint kEngagedColumns = 16; // area and moment by material

// One frame: what the host writes, then what the passes find. Copied to the device before them and back after.
struct Frame {
  // host
  OSTEON_ARRAY(vec4, start, kMaxToolBalls + 1);  // tool ball centres at the proxy; w: radius. Entry tool_count: T's origin
  OSTEON_ARRAY(vec4, goal, kMaxToolBalls + 1);   // the same at the tool's pose; w: 1 cutting, 0 not
  OSTEON_ARRAY(vec4, material, kMaxMaterials);   // x specific cutting energy [N/mm^2], y cutting-force ratio
  vec4 axis_x, axis_y, axis_z;                   // T's axes in G at the tool's pose
  vec4 turn;                                     // rotation vector from the proxy to the tool's pose
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
  // passes
  uint contact_bits;  // fraction of first contact, as the bits of a float: order of bits is order of fractions
  uint slide_bits;
  uint pad;
  vec4 delta;             // to the constrained target; w: length of the cutting planes' share
  vec4 n;                 // direction of the cutting planes' resultant
  vec4 origin_contact;
  vec4 origin_slid;
  vec4 origin_end;
  float advance_mm;
  float edge_work_Nmm;
  uint planes_present;    // bit per plane
  uint pad2;
  OSTEON_ARRAY(vec4, plane_n, kPlanes);      // w: smallest gap
  OSTEON_ARRAY(vec4, plane_point, kPlanes);  // w: lens volume
  OSTEON_ARRAY(float, multiplier, kPlanes);
  OSTEON_ARRAY(float, engaged, kEngagedColumns);
  OSTEON_ARRAY(uint, removed, kMaxMaterials);  // cleared volume in units of the bone's
};

// Box around a cluster of balls (whole balls) or of points, as they were at the start: conservative for ever.
struct Cluster {
  vec4 low, high;
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
static_assert(sizeof(Frame) % 16 == 0);
static_assert(offsetof(Frame, material) == 16 * 2 * 65);
static_assert(offsetof(Frame, spindle_rad_per_s) == 16 * (2 * 65 + 8 + 4));
static_assert(offsetof(Frame, delta) == offsetof(Frame, spindle_rad_per_s) + 64);
static_assert(offsetof(Frame, plane_n) == offsetof(Frame, delta) + 96);
static_assert(offsetof(Frame, removed) == offsetof(Frame, plane_n) + 2 * 128 + 32 + 64);
static_assert(sizeof(Cluster) == 32 && sizeof(Point) == 28);
}  // namespace osteon::gpu
#endif
#undef OSTEON_CONST
#undef OSTEON_ARRAY
#endif
