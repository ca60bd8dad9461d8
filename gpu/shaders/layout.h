// Sizes, bindings and the memory layout of every buffer, included by both the shaders and C++. Lengths and
// positions in millimetres, relative to the packing's origin, forces in newtons, work in newton millimetres.
#ifndef OSTEON_GPU_LAYOUT_H
#define OSTEON_GPU_LAYOUT_H

#include "simulation/contact/cutting_constants.h"

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace osteon::gpu {
using uint = std::uint32_t;
// 64-bit integers for keys and exact sums. In GLSL they are the device's 64-bit integers, or two words: see
// words.glsl.
using Key64 = std::uint64_t;
using Sum64 = std::int64_t;
struct vec4 {
  float x, y, z, w;
};
struct dvec3 {
  double x, y, z;
};
#define OSTEON_CONST inline constexpr
#define OSTEON_ARRAY(type, name, count) std::array<type, count> name
#else
#define OSTEON_CONST const
#define OSTEON_ARRAY(type, name, count) type name[count]
#ifdef OSTEON_NO_INT64
#define Key64 uvec2  // lower word, upper word
#define Sum64 uvec2
#else
#define Key64 uint64_t
#define Sum64 int64_t
#endif
#endif

OSTEON_CONST uint kGroupSize = 64;  // invocations of a workgroup; balls or points of a cluster
// Invocations of a workgroup on a GPU, in passes whose last workgroup does the next step of the frame or that
// combine sums.
OSTEON_CONST uint kWideLanes = 256;
OSTEON_CONST uint kMaxToolBalls = 10000;
OSTEON_CONST uint kNoToolBall = 0xffffffffu;
OSTEON_CONST uint kMaxMaterials = 8;
// the following constants have the same values as those in simulation/contact/contact_law.h
// bins of direction; those from kCuttingBinCount on are for balls that do not cut
OSTEON_CONST uint kBins = 60;
OSTEON_CONST uint kCuttingBinCount = 54;
OSTEON_CONST uint kRemembered = 8;
OSTEON_CONST uint kCandidates = 68;  // the nearest pair of each bin, then the remembered pairs
OSTEON_CONST uint kFaces = 4;
OSTEON_CONST uint kFaceColumns = 4;  // weight × centre (3 columns), weight × radius
OSTEON_CONST uint kToolBits = 14;    // bits of a tool ball's index in keys and packed pairs
// Exact sums subdivide the units of face_scale, area_scale and moment_scale by 2^kUnitBits.
// kFloatUnitBits: without shaderFloat64, see double_single.glsl
OSTEON_CONST uint kUnitBits = 18, kFloatUnitBits = 10;
#ifdef OSTEON_NO_FLOAT64
OSTEON_CONST double kUnitSubdivision = double(1u << kFloatUnitBits);
#else
OSTEON_CONST double kUnitSubdivision = double(1u << kUnitBits);
#endif
// Packed pair: the lower 14 bits are a tool ball's index, the upper 18 bits a lower bound of the pair's gap
// at the time of the list's construction.
OSTEON_CONST uint kMaxPackedGap = (1u << (32u - kToolBits)) - 1u;
OSTEON_CONST float kPackedGapUnit = 1.0f / 32768.0f;  // mm

// A sum in fixed point: high * 2^16 + low, in units of 1/scale. A sum of integers does not depend on the
// order, so a frame's result does not depend on scheduling.
struct Sum {
  int high;
  uint low;
};

// Frame values that need double precision. Millimetres, newtons, seconds.
struct DoublePrecision {
  dvec3 start, goal;  // T's origin at the proxy and at the tool's pose
  dvec3 axis;         // axis of the spindle
  double enlargement, tolerance, layer, max_slide;
  double stiffness, max_force, spindle_rad_per_s, dt_s;
  double work_held_back;  // part of this frame's work that reduces the energy lead
  OSTEON_ARRAY(double, cutting_energy, kMaxMaterials);  // N/mm^2
  OSTEON_ARRAY(double, force_ratio, kMaxMaterials);
  OSTEON_ARRAY(double, edge_force, kMaxMaterials);  // N/mm, for all edges together
  OSTEON_ARRAY(dvec3, face_n, kFaces);  // directions in which faces pressed in the frame before; zero: none
  // results
  dvec3 delta, shift;  // delta: to the constrained target; shift: straight to it from first contact
  dvec3 n;             // direction of the cutting contacts' resultant
  double cutting;      // length of the cutting contacts' share of delta
  // For the slide with the turn and the straight slide: the allowed fraction of it, and the travel of the
  // tool point that moves farthest in the whole slide.
  double slide_limit, straight_limit, way, straight_way;
  double slid_share, advance, edge_work;  // slid_share: of the performed slide; the others: of the frame
  OSTEON_ARRAY(dvec3, hold_n, 4);  // normals of the planes that hold the tool, with their multipliers below
  OSTEON_ARRAY(double, hold, 4);
  dvec3 step;  // step of the proxy's advance
  // area and moment by material, in units of 1 / (area_scale kUnitSubdivision) and 1 / (moment_scale
  // kUnitSubdivision)
  OSTEON_ARRAY(Sum64, engaged, 2 * kMaxMaterials);
  OSTEON_ARRAY(Sum64, removed, kMaxMaterials);  // cleared volume in the bone's units
  // weight and weight n of each face, in units of 1 / (face_scale kUnitSubdivision); row 0: balls that cut;
  // row 1: those that do not
  OSTEON_ARRAY(Sum64, face_sums, 2 * kFaces * 4);
};

// Arguments of an indirect dispatch.
struct DispatchArgs {
  uint x, y, z;
};

// A pair that may hold the tool, as found at first contact.
struct Candidate {
  float n_x, n_y, n_z;  // unit, from bone to tool
  float gap_mm;
  float yielding_gap_mm;  // gap at which it holds: see simulation::Candidates
  uint bone_ball, tool_ball;
  uint source;  // its bin, or kBins plus its index among the remembered
};

// One frame: inputs from the host, then results of the passes.
struct Frame {
  OSTEON_ARRAY(Key64, bin_keys, kBins);  // result: key of the nearest pair of each bin; all ones: no pair
  // Results: fraction of the path at first contact; fractions at first contact of the slide with the turn and
  // of the straight slide. Each key is the bits of a double, which sort like the doubles because all of them
  // are positive.
  Key64 contact_key, slide_key, straight_key;
  DoublePrecision exact;

  // from bone, tool and parameters: constant over all frames
  float enlargement_mm;
  float tolerance_mm;
  float layer_mm;
  // units of the fixed-point sums: every summand is below 2^23 of them
  float face_scale;        // per mm^3, of a face's weights
  float face_point_scale;  // per mm^4, of weight times a position on the tool
  float area_scale;        // per mm^2
  float moment_scale;      // per mm^3
  float cutting_skin_mm;   // allowed displacement of the tool since the lists were built, by kind of ball
  float shaft_skin_mm;
  uint tool_count;
  uint cutter_count;  // tool balls 0 … cutter_count - 1 cut
  uint ball_count;
  uint point_count;
  uint material_count;
  uint immediate;  // 1: the immediate removal law
  uint live_capacity;
  uint packed_pair_capacity;
  uint first_child;  // index of the first child ball; blocks of kGroupSize slots follow each other from here
  float split_radius_mm;  // larger balls request a split; huge where none is split
  uint split_event_capacity;

  // inputs of this frame
  vec4 start, goal;                    // T's origin at the proxy and at the tool's pose
  vec4 axis_x, axis_y, axis_z;         // T's axes in G at the tool's pose
  vec4 turn;                           // rotation vector from the proxy to the tool's pose
  OSTEON_ARRAY(vec4, face_n, kFaces);  // directions in which faces pressed in the frame before; zero: none
  OSTEON_ARRAY(uint, remembered_bone, kRemembered);
  OSTEON_ARRAY(uint, remembered_tool, kRemembered);
  uint remembered_count, held_count;  // held: number of remembered pairs that held
  uint turning;                       // 1: the tool turns in this frame
  float friction;
  float spindle_rad_per_s;
  float rounding_mm;  // bound on the rounding of a distance in floats, in this frame
  // balls and points farther than this from the tool at first contact are irrelevant after it
  float ball_reach_mm;
  float point_reach_mm;
  // displacement since the lists were built of the tool ball that moved most
  float cutting_displacement_start_mm, cutting_displacement_goal_mm, shaft_displacement_start_mm,
      shaft_displacement_goal_mm;
  // its displacement since the lists' packed pairs were measured: see refresh.comp
  float cutting_measured_start_mm, cutting_measured_goal_mm, shaft_measured_start_mm, shaft_measured_goal_mm;
  float path_mm;          // travel of the tool point that moves farthest, from the proxy to the tool's pose
  uint chunk;             // list entries for one invocation
  uint lists_at_contact;  // 1: the lists are built in this frame, at first contact
  uint max_workgroups;    // largest number in a pass, along x: further work loops over them
  uint near_ball_clusters, near_point_clusters;  // clusters that the tool can meet
  uint flush_count;                              // balls of the previous lists, which flush.comp writes back
  uint upload_count;
  DispatchArgs upload_work;
  DispatchArgs flush_work;
  DispatchArgs path_work;   // clusters of balls, one workgroup each
  DispatchArgs point_work;  // clusters of points

  // the lists, as the last frame that built them left them; x: chunks of the longest list; y: lists
  DispatchArgs pair_work;   // listed balls, shaft pairs
  DispatchArgs all_work;    // listed balls, listed points, shaft pairs
  DispatchArgs clear_work;  // listed balls, listed points
  uint live_ball_count, live_point_count, shaft_count, packed_pair_count;
  uint longest_pair_range;  // largest number of tool balls of an entry
  uint list_overflow;       // set where the lists are too short: the frame is void
  uint needs_rebuild;       // set where nothing was changed: see NeedsRebuild

  // results
  uint turns;        // whether the performed slide includes the turn
  vec4 delta;        // to the constrained target; w: length of the cutting contacts' share
  vec4 friction_mm;  // friction's share of delta; w: the hold's slack
  vec4 shift_mm;     // from first contact to the target, without the turn
  uint candidate_count;
  uint shaft_candidate, shaft_end;  // range of the balls that do not cut; the remembered pairs follow
  uint hold_count;                  // number of candidates that hold the tool
  OSTEON_ARRAY(uint, hold_candidate, 4);
  OSTEON_ARRAY(Candidate, candidates, kCandidates);
  // row 0: balls that cut (unused with a single one); row 1: those that do not
  OSTEON_ARRAY(Sum, face_sums, 2 * kFaces * kFaceColumns);
  uint split_event_count;
  uint groups_done;  // workgroups that have finished a pass whose last one continues: see IsLastGroup
  uint sequence;     // number of the readback
  // where one tool ball alone cuts: the ball that touches first. Upper bits: its index in the tool's own
  // list; lower kToolBits: its device index. kNoToolBall where nothing was touched
  uint touching;
};

OSTEON_CONST uint kFrameBytes = 4720u;

// A frame as the host reads it: its bytes, then a checksum over their words, which reveals an incomplete
// readback, and its number.
struct Readback {
  Frame frame;
  uint sum, sequence;
};

// An event of a frame for the host's record of split balls: a touched ball that is large enough to be split,
// or a block whose last child has gone (its number with kEmptiedBlock added, no balls).
struct SplitEvent {
  uint index;
  vec4 before, after;
};
OSTEON_CONST uint kEmptiedBlock = 0x80000000u;

// A ball from the host: a split parent or a child. For an index from ball_count on, it is a block instead,
// with min_mm and live in `ball`.
struct SplitUpload {
  uint index;
  vec4 ball;
};

// A block of children.
struct Block {
  float min_mm;  // smaller children are dropped
  uint live;     // number of children left
};

// A cluster of 64 balls or points, and the tool balls that can meet it: tool_refs[first …] in ascending
// order, so that cutting balls come first.
struct ClusterPairs {
  uint cluster;
  uint first, cutters, count;
};

// A ball or point within reach, and the cutting tool balls that can meet it: packed pairs packed_pairs[first
// …], in ascending order.
struct ListEntry {
  uint index;
  uint first, count;
  uint more;  // of a point: its material; ball: the smallest gap of its packed pairs
};

// A listed ball (its slot in the list) and the tool balls that do not cut and can meet it. Also an entry,
// from kBindLiveEntries[live_capacity] on.
struct ShaftPair {
  uint slot;
  uint first, count;
  uint min_gap;  // smallest gap of its packed pairs
};

// Storage buffers, in the order of their bindings.
OSTEON_CONST uint kBindFrame = 0;
// a tool ball's centre at the proxy (w: radius) and at the tool's pose (w: its index in the tool's own list);
// then the remainders (double minus float) of the centres and the radius
OSTEON_CONST uint kBindTool = 1;
OSTEON_CONST uint kBindClusterPairs = 2;  // clusters of balls, then (from ball cluster count on) of points
OSTEON_CONST uint kBindToolRefs = 3;      // 0 … tool_count - 1 first
OSTEON_CONST uint kBindReadback = 4;
OSTEON_CONST uint kBindBalls = 5;         // centre, radius; radius 0: gone
OSTEON_CONST uint kBindMoreBalls = 6;     // balls from kBallsPerBuffer on
OSTEON_CONST uint kBindPoints = 7;        // position, volume [mm^3]
OSTEON_CONST uint kBindPointStates = 8;   // material, and kCleared
OSTEON_CONST uint kBindPointUnits = 9;    // volume in the bone's units
OSTEON_CONST uint kBindLiveBalls = 10;    // copies of the listed balls
OSTEON_CONST uint kBindLiveEntries = 11;  // ListEntry, then ShaftPair: one buffer, since software drivers
                                          // read every buffer that might be selected
OSTEON_CONST uint kBindLivePoints = 12;   // copies of the listed points
OSTEON_CONST uint kBindPointEntries = 13;
OSTEON_CONST uint kBindPackedPairs = 14;  // packed pairs; 0 … tool_count - 1 first
OSTEON_CONST uint kBindSlots = 15;        // slot of each ball in the list
OSTEON_CONST uint kBindSplitEvents = 16;  // SplitEvent
OSTEON_CONST uint kBindUploads = 17;      // SplitUpload
OSTEON_CONST uint kBindBlocks = 18;       // Block
OSTEON_CONST uint kBindings = 19;
// Read-only views of the lists' copies: software drivers fetch a texel at once, but a buffer's words one by
// one.
OSTEON_CONST uint kBindBallTexels = 19;
OSTEON_CONST uint kBindPointTexels = 20;
// read-only views of tool, packed pairs and list entries
OSTEON_CONST uint kBindToolTexels = 21, kBindPackedPairTexels = 22, kBindEntryTexels = 23,
                  kBindPointEntryTexels = 24;

OSTEON_CONST uint kBallsPerBuffer = 8000000;  // a binding holds 128 MiB on every device
OSTEON_CONST uint kCleared = 256;             // flag in a point's state: the point is cleared

#ifdef __cplusplus
static_assert(sizeof(Frame) == kFrameBytes && kFrameBytes % 16 == 0 && sizeof(Readback) == kFrameBytes + 8);
static_assert(offsetof(Frame, exact) == 8 * 63);
static_assert(sizeof(DoublePrecision) == 8 * (9 + 9 + 24 + 12 + 9 + 1 + 4 + 3 + 16 + 3 + 24 + 32));
static_assert(sizeof(Candidate) == 32);
static_assert(sizeof(ClusterPairs) == 16 && sizeof(ListEntry) == 16 &&
              sizeof(ShaftPair) == sizeof(ListEntry) && sizeof(Sum) == 8);
static_assert(sizeof(SplitEvent) == 36 && sizeof(SplitUpload) == 20 && sizeof(Block) == 8);
}  // namespace osteon::gpu
#endif
#undef OSTEON_CONST
#undef OSTEON_ARRAY
#endif
