#pragma once

#include <span>
#include <vector>

#include "gpu/engine/cluster_tree.h"
#include "gpu/engine/tool_layout.h"
#include "gpu/shaders/layout.h"

namespace osteon::gpu {

/// A ball's path from a to b [mm]; if the radius is negative, there is no ball.
struct BallSweep {
  Eigen::Vector3f a{Eigen::Vector3f::Zero()}, b{Eigen::Vector3f::Zero()};
  float radius_mm{-1.0f};
};

/// Clusters that the tool can meet in a frame, each with the tool balls that can meet it. It is the host's
/// input for the passes that build the lists. Buffers do not grow after construction.
///
///     items       cluster 7: refs 1000 …    cluster 9: refs 1003     …
///     tool refs   0 1 2 … 999 │ 0 4 917 │ 0 │ …   (first all tool balls: used for every
///                                                cluster if the buffer is too small)
class WorkList {
 public:
  /// @param ref_capacity  size of the device's buffer of tool refs; at least the number of tool balls
  WorkList(std::size_t largest_cluster_count, const ToolLayout& tool, std::size_t ref_capacity);

  void Clear() { refs_.resize(tool_->balls.size()); }
  /// Lists the clusters of one tree that the tool's balls meet.
  /// @param groups  the sweep of each group's bounding ball; @param balls the sweep of each tool ball
  void Add(const ClusterTree& tree, std::span<const BallSweep> groups, std::span<const BallSweep> balls,
           std::vector<ClusterPairs>& items);

  [[nodiscard]] const std::vector<uint>& refs() const { return refs_; }

 private:
  struct Hit {
    uint cluster, ball;
  };
  const ToolLayout* tool_;
  std::size_t ref_capacity_;
  std::vector<uint> refs_;
  // clusters that the groups' bounding balls meet: those of group 0, then of group 1, …
  std::vector<uint> near_;
  std::vector<std::size_t> end_;  // end of each group's clusters in near_
  std::vector<Hit> hits_;
  struct Count {
    uint cutters{0}, all{0};
  };
  std::vector<Count> counts_;   // number of hits by cluster; 0 between calls
  std::vector<uint> clusters_;  // hit clusters, in the order of their first hit
};

}  // namespace osteon::gpu
