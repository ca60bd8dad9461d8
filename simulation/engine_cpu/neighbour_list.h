#pragma once

#include <span>
#include <utility>
#include <vector>

#include "simulation/engine_cpu/bone_store.h"
#include "simulation/engine_cpu/cluster_search.h"
#include "simulation/engine_cpu/pair_row_list.h"
#include "simulation/engine_cpu/split_blocks.h"

namespace osteon::simulation::cpu {

/// The sources from which a neighbour list is built.
struct ListSources {
  const Kernels& kernels;
  const ToolBalls& tool;
  BoneStore& bone;
  SplitBlocks* split;  ///< null: no ball is split
  ClusterSearch& search;
};

/// Mass points of one material near the cutting balls, in blocks of eight.
struct PointList {
  AlignedArray<PointBlock> blocks;
  std::size_t block_count{0};
  PairRowList rows;
};

/// A Verlet neighbour list. A pair is a block (eight balls or points) and a tool ball. The list holds every
/// pair that can come within reach of each other while each tool ball is within the skin's thickness of its
/// place when the list was built.
///
///     Begin(place) ─▶ Continue … ─▶ End        at once, or in slices over several frames
///
/// While a list is built in slices, bone is still being cut. End applies those changes to the list.
class NeighbourList {
 public:
  /// @param max_rows  largest number of rows of balls, and of points of each material
  NeighbourList(const ListSources& sources, std::size_t max_rows);

  /// Begins to build the list. @param reach, point_reach  reach for balls and for points, including the skin
  void Begin(const ToolPlacement& at, const ListReach& reach, const ListReach& point_reach);
  /// Visits the next clusters of balls and of points, at most as many as given.
  void Continue(std::size_t ball_clusters, std::size_t point_clusters);
  [[nodiscard]] bool all_visited() const;
  /// Ends the build: applies the changes of the bone that were recorded during it.
  void End();
  void Discard() { is_begun_ = is_made_ = false; }

  [[nodiscard]] bool is_begun() const { return is_begun_; }
  [[nodiscard]] bool is_made() const { return is_made_; }
  /// Whether more pairs were found than the list has room for. The list is then invalid.
  [[nodiscard]] bool overflowed() const { return overflowed_; }
  [[nodiscard]] std::size_t ball_clusters() const { return balls_.cluster.size() + children_.size(); }
  [[nodiscard]] std::size_t point_clusters() const { return points_.cluster.size(); }
  [[nodiscard]] const ToolPlacement& built_at() const { return built_at_; }
  [[nodiscard]] PairRowList& ball_rows() { return ball_rows_; }
  [[nodiscard]] std::vector<PointList>& point_lists() { return point_lists_; }
  [[nodiscard]] std::size_t ball_row_count() const { return ball_rows_.row_count(); }
  [[nodiscard]] std::size_t ball_block_count() const { return ball_rows_.block_count(); }
  [[nodiscard]] std::size_t listed_points() const { return listed_points_; }

  /// Adds the new children of a split ball to the list.
  void AddChildren(std::uint32_t number);
  /// NoteCleared and NoteSplit record a point that was cleared, or a ball that was split, while the list is
  /// being built.
  void NoteCleared(std::uint32_t point) { cleared_since_.push_back(point); }
  void NoteSplit(std::uint32_t number) { split_since_.push_back(number); }

 private:
  // Adds the rows of some blocks of balls. @param any  set if there is any row
  void ListBlocks(std::uint32_t first_block, std::uint32_t end_block, std::span<const std::uint16_t> tools,
                  bool& any);
  // These functions visit the next cluster of balls, the children of the next split ball, and the next
  // cluster of points.
  void ListBallCluster();
  void ListChild();
  void ListPointCluster();
  // Adds a point to its material's open block, and closes the block when it is full. @param lanes  number of
  // lanes of the open block that are in use
  void AddPoint(std::uint32_t point, std::span<const std::uint16_t> tools, std::uint32_t& lanes);
  void ClosePointBlock(PointList& list, std::span<const std::uint16_t> tools, std::uint32_t& lanes);
  [[nodiscard]] RowMaker MakerOf(const ListReach& reach) const;

  const ListSources& from_;
  bool is_begun_{false}, is_made_{false}, overflowed_{false};
  ToolPlacement built_at_;
  ListReach reach_, point_reach_;
  PairRowList ball_rows_;
  std::vector<PointList> point_lists_;  // by material
  NearClusters balls_, points_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> children_;  // number; index of the parent's cluster
  std::size_t next_child_{0}, listed_points_{0};
  std::vector<std::uint32_t> place_of_point_;  // block · 8 + lane of each point in its material's list
  std::vector<std::uint32_t> cleared_since_, split_since_;
  std::vector<std::uint16_t> new_tools_;
  std::vector<float> new_bounds_;
};

}  // namespace osteon::simulation::cpu
