// What the shaders and C++ both see: sizes, bindings, and the memory layout of every buffer. Included by
// both. Lengths in millimetres relative to the packing's origin, forces in newtons, work in newton
// millimetres.
#ifndef OSTEON_GPU_LAYOUT_H
#define OSTEON_GPU_LAYOUT_H

#include "simulation/cutting_constants.h"

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace osteon::gpu {
using uint = std::uint32_t;
using std::int32_t;
using std::int64_t;
using uint64_t = std::uint64_t;
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
#endif

OSTEON_CONST uint kGroupSize = 64;  // invocations of a workgroup; balls or points of a cluster
// on a GPU, in passes whose last workgroup goes on or whose sums meet
OSTEON_CONST uint kWideLanes = 256;
OSTEON_CONST uint kMaxToolBalls = 10000;
OSTEON_CONST uint kNoToolBall = 0xffffffffu;
OSTEON_CONST uint kMaxMaterials = 8;
// the contact law's, see simulation/contact_law.h
OSTEON_CONST uint kBins = 60;  // of direction; from kCuttingBinCount on of balls that do not cut
OSTEON_CONST uint kCuttingBinCount = 54;
OSTEON_CONST uint kRemembered = 8;
OSTEON_CONST uint kCandidates = 68;  // the nearest pair of each bin, then the remembered ones
OSTEON_CONST uint kFaces = 4;
OSTEON_CONST uint kFaceColumns = 4;  // weight centre (3), weight radius
OSTEON_CONST uint kToolBits = 14;    // of a tool ball's number in keys and words
// Parts of the units of face_scale, area_scale and moment_scale.
OSTEON_CONST double kFiner = 262144.0;
// A word of a span: a tool ball, and above it the gap that it had at least where the lists were made.
OSTEON_CONST uint kLargestSpanGap = (1u << (32u - kToolBits)) - 1u;
OSTEON_CONST float kSpanGapUnit = 1.0f / 32768.0f;  // mm

// A sum in fixed point: high * 2^16 + low, in units of 1/scale. Whole numbers add up to the same in any
// order, so that a frame's result does not depend on scheduling.
struct Sum {
  int high;
  uint low;
};

// What of a frame hangs on less than floats tell, in double precision. Millimetres, newtons, seconds.
struct Exact {
  dvec3 start, goal;  // T's origin at the proxy and at the tool's pose
  dvec3 axis;         // the spindle's
  double enlargement, tolerance, layer, max_slide;
  double stiffness, max_force, spindle_rad_per_s, dt_s;
  double work_held_back;                                // share of the debt that this frame pays
  OSTEON_ARRAY(double, cutting_energy, kMaxMaterials);  // N/mm^2
  OSTEON_ARRAY(double, force_ratio, kMaxMaterials);
  OSTEON_ARRAY(dvec3, face_n, kFaces);  // directions in which faces pressed, the frame before; zero: none
  // found
  dvec3 delta, shift;  // to the constrained target; straight, from first contact
  dvec3 n;             // direction of the cutting contacts' resultant
  double cutting;      // length of their share of delta
  // with the turn and straight: the fraction that is allowed, the whole way of the tool point that moves
  // farthest
  double slide_limit, straight_limit, way, straight_way;
  double slid_share, advance, edge_work;  // of the slide that was done; of the frame
  OSTEON_ARRAY(dvec3, hold_n, 4);         // of what holds the tool, and how much
  OSTEON_ARRAY(double, hold, 4);
  dvec3 step;  // of the proxy's advance
  // area and moment by material, in units of 1 / (area_scale kFiner) and 1 / (moment_scale kFiner)
  OSTEON_ARRAY(int64_t, engaged, 2 * kMaxMaterials);
  OSTEON_ARRAY(uint64_t, removed, kMaxMaterials);  // cleared volume in units of the bone's
  // weight and weight n of each face, in units of 1 / (face_scale kFiner); row 0: balls that cut; row 1:
  // those that do not
  OSTEON_ARRAY(int64_t, face_sums, 2 * kFaces * 4);
};

// Arguments of an indirect dispatch.
struct Groups {
  uint x, y, z;
};

// A pair that may hold the tool, as first contact leaves it.
struct Candidate {
  float n_x, n_y, n_z;  // unit, from bone to tool
  float gap_mm;
  float yielding_gap_mm;  // what it holds at: see simulation::Candidates
  uint bone_ball, tool_ball;
  uint source;  // its bin, or kBins and its number among the remembered
};

// One frame: what the host writes, then what the passes find.
struct Frame {
  OSTEON_ARRAY(uint64_t, bin_keys, kBins);  // found; all ones where there is no pair
  // found: fractions of first contact, and of the slide's with the turn and straight. Bits of doubles: those
  // of one sign order like the doubles
  uint64_t contact_key, slide_key, straight_key;
  Exact exact;

  // of bone, tool and parameters: the same in every frame
  float enlargement_mm;
  float tolerance_mm;
  float layer_mm;
  // units of the fixed-point sums: no summand reaches 2^23 of them
  float face_scale;         // per mm^3, of a face's weights
  float face_point_scale;   // per mm^4, of weight times a place on the tool
  float area_scale;         // per mm^2
  float moment_scale;       // per mm^3
  float cutting_margin_mm;  // how far the tool may be from where the lists were made, by kind of ball
  float shaft_margin_mm;
  uint tool_count;
  uint cutter_count;  // tool balls 0 … cutter_count - 1 cut
  uint ball_count;
  uint point_count;
  uint material_count;
  uint immediate;
  uint live_capacity;
  uint span_capacity;
  uint first_child;       // balls from here on are children, a block of kGroupSize slots after the other
  float split_radius_mm;  // larger balls ask for a split; huge where none is split
  uint request_capacity;

  // of this frame
  vec4 start, goal;                    // T's origin at the proxy and at the tool's pose
  vec4 axis_x, axis_y, axis_z;         // T's axes in G at the tool's pose
  vec4 turn;                           // rotation vector from the proxy to the tool's pose
  OSTEON_ARRAY(vec4, face_n, kFaces);  // directions in which faces pressed, the frame before; zero: none
  OSTEON_ARRAY(uint, remembered_bone, kRemembered);
  OSTEON_ARRAY(uint, remembered_tool, kRemembered);
  uint remembered_count, held_count;  // held: of the remembered, that held
  uint turning;
  float friction;
  float spindle_rad_per_s;
  float rounding_mm;  // what floats may make of a distance, in this frame
  // balls and points further than this from the tool at first contact play no part after it
  float ball_reach_mm;
  float point_reach_mm;
  // how far the tool ball that moved most is from where it was when the lists were made
  float cutting_drift_start_mm, cutting_drift_goal_mm, shaft_drift_start_mm, shaft_drift_goal_mm;
  // the same, from where their words were made: see refresh.comp
  float cutting_words_start_mm, cutting_words_goal_mm, shaft_words_start_mm, shaft_words_goal_mm;
  float path_mm;                 // of the tool point that moves farthest, from the proxy to the tool's pose
  uint chunk;                    // list entries that one invocation looks at
  uint lists_at_contact;         // 1: the lists are made in this frame, where first contact is
  uint max_workgroups;           // of a pass, along x: a pass that needs more goes round
  uint ball_items, point_items;  // clusters that the tool can meet
  uint flush_count;              // balls of the last lists, which flush.comp writes back
  uint upload_count;
  Groups upload_work;
  Groups flush_work;
  Groups path_work;   // clusters of balls, one workgroup each
  Groups point_work;  // clusters of points

  // the lists, as the last frame that made them left them
  // x: chunks of the longest list; y: lists
  Groups pair_work;   // live balls, shaft pairs
  Groups all_work;    // live balls, live points, shaft pairs
  Groups clear_work;  // live balls, live points
  uint live_ball_count, live_point_count, shaft_count, span_count;
  uint longest_span;  // tool balls of an entry
  uint too_many;      // balls or points beyond live_capacity: the frame is void
  uint is_void;       // nothing was changed: see IsVoid

  // found
  uint turns;        // which slide was done
  vec4 delta;        // to the constrained target; w: length of the cutting contacts' share
  vec4 friction_mm;  // its share of delta; w: the slack of the hold
  vec4 shift_mm;     // straight, from first contact to the target
  uint candidate_count;
  uint shaft_candidate, shaft_end;  // those of balls that do not cut; then the remembered ones
  uint hold_count;                  // candidates that hold the tool, and how much
  OSTEON_ARRAY(uint, hold_candidate, 4);
  OSTEON_ARRAY(Candidate, candidates, kCandidates);
  // row 0: balls that cut (nothing with a single one); row 1: those that do not
  OSTEON_ARRAY(Sum, face_sums, 2 * kFaces * kFaceColumns);
  uint request_count;  // of balls that should be split; may be above the capacity
  uint groups_done;    // workgroups of a pass whose last one goes on: see IsLastGroup
  uint sequence;       // the report's
  // where one tool ball cuts alone, which: its number in the tool's own list above, the device's in the lower
  // kToolBits; kNoToolBall where nothing was touched
  uint touching;
};

OSTEON_CONST uint kFrameBytes = 4656u;

// What the host reads of a frame: its bytes, and then (with a sum over their words, so that it can't be half
// there) its number.
struct Report {
  Frame frame;
  uint sum, sequence;
};

// A ball that was touched and is so large that it should be split.
struct SplitRequest {
  uint parent;
  vec4 before, after;
};

// A ball that the host has made.
struct SplitUpload {
  uint index;
  vec4 ball;
};

// A block of children.
struct Block {
  float least_mm;  // smaller children are dropped
  uint live;       // children that are left
  uint waits;      // 1: none was made yet
};

// A cluster of 64 balls or points, and the tool balls that can meet it: tool_refs[first …] in rising order,
// so that those that cut come first.
struct Item {
  uint cluster;
  uint first, cutters, count;
};

// A ball or point within reach, and the cutting tool balls that can meet it: words spans[first …], in rising
// order.
struct Live {
  uint index;
  uint first, count;
  uint more;  // of a point: its material; of a ball: the least gap in its words
};

// A live ball (its slot in the list) and the tool balls that do not cut and can meet it: an entry too, from
// kBindLiveEntries[live_capacity] on.
struct ShaftPair {
  uint slot;
  uint first, count;
  uint least;  // gap in its words
};

// Storage buffers, in the order of their bindings.
OSTEON_CONST uint kBindFrame = 0;
// a tool ball's centre at the proxy (w: radius) and at the tool's pose (w: its number in the tool's own
// list); then what floats leave of the centres and the radius
OSTEON_CONST uint kBindTool = 1;
OSTEON_CONST uint kBindItems = 2;     // clusters of balls, then (from ball cluster count on) of points
OSTEON_CONST uint kBindToolRefs = 3;  // 0 … tool_count - 1 first
OSTEON_CONST uint kBindReport = 4;
OSTEON_CONST uint kBindBalls = 5;         // centre, radius; radius 0: gone
OSTEON_CONST uint kBindMoreBalls = 6;     // those from kBallsPerBuffer on
OSTEON_CONST uint kBindPoints = 7;        // place, volume [mm^3]
OSTEON_CONST uint kBindPointStates = 8;   // material, and kCleared
OSTEON_CONST uint kBindPointUnits = 9;    // volume in the bone's units
OSTEON_CONST uint kBindLiveBalls = 10;    // copies of the live balls
OSTEON_CONST uint kBindLiveEntries = 11;  // Live, then ShaftPair: one list to read, since software drivers
                                          // read all that might be chosen
OSTEON_CONST uint kBindLivePoints = 12;   // copies of the live points
OSTEON_CONST uint kBindPointEntries = 13;
OSTEON_CONST uint kBindSpans = 14;     // words; 0 … tool_count - 1 first
OSTEON_CONST uint kBindSlots = 15;     // of each ball in the list of live balls, where it is in it
OSTEON_CONST uint kBindRequests = 16;  // SplitRequest
OSTEON_CONST uint kBindUploads = 17;   // SplitUpload
OSTEON_CONST uint kBindBlocks = 18;    // Block
OSTEON_CONST uint kBindings = 19;
// The lists' copies again, to read: software drivers fetch a texel at once, but a buffer's words one by one.
OSTEON_CONST uint kBindBallTexels = 19;
OSTEON_CONST uint kBindPointTexels = 20;
// tool, spans and the lists' entries, to read
OSTEON_CONST uint kBindToolTexels = 21, kBindSpanTexels = 22, kBindEntryTexels = 23,
                  kBindPointEntryTexels = 24;

OSTEON_CONST uint kBallsPerBuffer = 8000000;  // a binding holds 128 MiB on every device
OSTEON_CONST uint kCleared = 256;

#ifdef __cplusplus
static_assert(sizeof(Frame) == kFrameBytes && kFrameBytes % 16 == 0 && sizeof(Report) == kFrameBytes + 8);
static_assert(offsetof(Frame, exact) == 8 * 63);
static_assert(sizeof(Exact) == 8 * (9 + 9 + 16 + 12 + 9 + 1 + 4 + 3 + 16 + 3 + 24 + 32));
static_assert(sizeof(Candidate) == 32);
static_assert(sizeof(Item) == 16 && sizeof(Live) == 16 && sizeof(ShaftPair) == sizeof(Live) &&
              sizeof(Sum) == 8);
static_assert(sizeof(SplitRequest) == 36 && sizeof(SplitUpload) == 20 && sizeof(Block) == 12);
}  // namespace osteon::gpu
#endif
#undef OSTEON_CONST
#undef OSTEON_ARRAY
#endif
