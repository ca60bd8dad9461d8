#pragma once

#include <cstddef>
#include <cstdint>

// Data that the engine passes to its kernels: structures of arrays, eight lanes at a time. Positions are
// stored twice: as doubles in metres, which determine the results, and as floats in millimetres, which only
// exclude pairs (rounding.h).

namespace osteon::simulation::cpu {

inline constexpr std::size_t kLanes = 8;
/// Means "no value"; larger than any gap.
inline constexpr float kNever = 3e38f;
/// Coordinate that removed mass points and a block's empty lanes get [mm].
inline constexpr float kFarAway_mm = 1e15f;

/// Eight bone balls [mm] in G; r = 0: gone.
struct alignas(64) BallBlock {
  float x[kLanes], y[kLanes], z[kLanes], r[kLanes];
};
/// Returns the index of the ball at a place. A place is the offset of the ball's x in an array of blocks,
/// counted in floats. Places rise with the balls' indices.
[[nodiscard]] constexpr std::uint32_t BallAtPlace(std::uint32_t place) { return place / 32 * 8 + place % 32; }

/// Eight mass points of one material [mm] in G, and their indices in the bone.
struct alignas(64) PointBlock {
  float x[kLanes], y[kLanes], z[kLanes];
  std::uint32_t index[kLanes];
  double area_m2[kLanes];  ///< volume of each point over the depth of the engaged layer
};

/// Centres of the tool's balls, then T's origin, in G.
struct Places {
  double *x, *y, *z;          ///< [m]
  float *x_mm, *y_mm, *z_mm;  ///< the same, rounded to floats
};

/// The tool's balls.
struct ToolView {
  std::uint32_t count;             ///< number of balls; in Places, T's origin has the index `count`
  const double *r, *tx, *ty, *tz;  ///< radius [m]; centre in T [m]
  const float* r_mm;
  const float* rounding_mm;  ///< largest error of a gap to each ball in floats, in this frame
  const std::uint8_t* cutting;
};

/// Rows of a neighbour list: a block of eight balls or points and a tool ball that may come near one of them.
///
/// A row's bound is the smallest gap of its eight pairs when these were last computed, plus the tool's
/// displacement (since the list was built) at that time. A gap closes no faster than the tool moves, and bone
/// only shrinks. So no pair of the row can now have a smaller gap than bound minus displacement.
struct PairRows {
  std::uint32_t block_count;
  const std::uint32_t* block;  ///< index of each listed block, ascending
  const std::uint32_t* first;  ///< block[b] has the rows first[b] … first[b + 1] - 1, by rising tool ball
  float* block_bound;          ///< smallest bound of the block's rows
  const std::uint16_t* tool;
  float* bound;
};

/// Pass 1, also used for the slide: first contact of the tool on straight paths.
struct ContactPass {
  const BallBlock* balls;
  PairRows rows;
  ToolView tool;
  Places from, to;
  const float *way_x_mm, *way_y_mm, *way_z_mm;  ///< path of each tool ball
  double tolerance_m;                           ///< overlap that is no contact yet
  float tolerance_mm, displacement_mm, longest_way_mm, rounding_mm;
  bool every_row;  ///< brute force: bounds exclude nothing
};

inline constexpr std::size_t kBinCount = 60, kFaceCount = 4;

/// Pass 2: the nearest pair of each bin of direction, and the sums over the cone around each face's normal.
struct NearFieldPass {
  const BallBlock* balls;
  PairRows rows;
  ToolView tool;
  Places at;
  double enlargement_m;   ///< pairs with a larger gap are ignored
  double middle_worth_m;  ///< kBinCentreBias_m: weight of a direction's distance to its bin's centre
  double face_cosine;     ///< cosine of the half angle of a face's cone
  double max_lens_m3;     ///< largest weight of a pair
  float enlargement_mm, displacement_mm, rounding_mm;
  bool every_row;
  double axes[9];  ///< T's axes in G, rounded to floats, by columns
  double face_n[kFaceCount][3];
  std::int32_t face_count;

  /// Scratch: pairs to compute in double precision. near_* has room for kNearCapacity pairs, cone_* for
  /// kConeCapacity plus all pairs of a block, block_* for all pairs of a block. Kernels write up to 16 more
  /// elements of each.
  std::uint32_t *near_place, *near_tool, *cone_place, *cone_tool, *block_place, *block_tool;
  float* near_score;
  std::uint8_t* near_bin;

  /// Results. A bin's best pair is given by the ball's place (BallAtPlace) and tool ball; without a pair the
  /// score is infinite.
  double score[kBinCount];
  std::uint32_t best_place[kBinCount];
  std::uint16_t best_tool[kBinCount];
  double sums[kFaceCount][8];  ///< weight, n, centre in T, radius (FaceSums)
};
inline constexpr std::size_t kNearCapacity = 4096, kConeCapacity = 2048;

/// Pass 3: area of the cutting surface that lies in bone, from the points of one material.
struct EngagementPass {
  const PointBlock* points;
  PairRows rows;
  ToolView tool;
  Places at;
  double layer_m;                   ///< depth of the engaged layer
  double n[3], origin[3], axis[3];  ///< contact normal, T's origin, spindle's axis, in G
  float layer_mm, displacement_mm, rounding_mm;
  bool every_row;
  double area_m2, moment_m3;  ///< results, which the pass adds to
};

/// Sweep of the cutting balls: two straight segments, contact ─▶ slid ─▶ end.
struct SweepView {
  ToolView tool;
  Places contact, slid, end;
  float displacement_mm, way_mm, rounding_mm;  ///< way_mm: longest path of a tool ball from contact to end
  std::int32_t only;                           ///< index of the only tool ball that cuts; -1: all cut
  bool every_row;
};

/// A function that does ShrinkBall for one ball whose centre lies close to the path's axis. Lengths in
/// metres.
using ShrinkOnAxis = void (*)(double* center, double* radius, const double* a, const double* b,
                              double tool_radius);

/// A block being processed, and a tool ball that may touch some of its balls.
struct TouchingRow {
  /// slot: index of the block in the kernel's work; lanes: a bit for each ball that may be touched
  std::uint32_t slot, tool, lanes;  // full words, because narrower fields are slow to combine
};

/// Pass 3: shrinks the balls that the sweep touches.
struct RemovalPass {
  SweepView sweep;
  BallBlock* balls;
  PairRows rows;
  double min_radius_m;   ///< smaller balls are removed
  double on_axis_share;  ///< kOnAxis: centres nearer to the path, over the tool ball's radius, count as on it
  ShrinkOnAxis shrink_on_axis;
  /// Children of split balls: blocks from first_child on, child_stride blocks for each split ball. Children
  /// smaller than min_child_m are removed. touched_children receives the touched blocks of children; null: no
  /// ball is split.
  std::uint32_t first_child, child_stride;
  const double* min_child_m;
  std::uint32_t* touched_children;
  TouchingRow* scratch;  ///< room for scratch_capacity rows, at least the rows of one block
  std::uint32_t scratch_capacity;
  std::size_t touched_count, pairs_examined, balls_changed;  ///< results
};

/// Finds the large balls that the sweep may touch, in ascending order.
struct LargeBallPass {
  SweepView sweep;
  const BallBlock* balls;
  PairRows rows;
  float larger_than_mm;
  std::uint32_t end_block;  ///< only blocks before this one are searched
  std::uint32_t* ball;      ///< result; has room for every ball
  std::size_t count;
};

/// Finds the points inside the sweep, in ascending order. A point is given as block · 8 + lane.
struct ClearingPass {
  SweepView sweep;
  const PointBlock* points;
  PairRows rows;
  std::uint32_t* cleared;  ///< result; has room for every point
  std::size_t count;
};

/// Makes the rows of one block with the tool balls of a list.
struct RowMaker {
  ToolView tool;
  Places at;
  float cutting_reach_mm, shaft_reach_mm;
  std::uint16_t* out_tool;  ///< the rows' tool balls and bounds are written to these arrays
  float* out_bound;
};

}  // namespace osteon::simulation::cpu
