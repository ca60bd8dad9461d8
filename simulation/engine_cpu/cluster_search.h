#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulation/engine_cpu/box_tree.h"
#include "simulation/engine_cpu/tool_balls.h"

namespace osteon::simulation::cpu {

/// Distance from each tool ball up to which a list holds bone [mm]: the frame's reach plus the list's skin.
struct ListReach {
  float cutting_mm{0.0f}, shaft_mm{0.0f};
};

/// Result of a search: the clusters of bone near the tool, ascending, each with the groups of tool balls near
/// it.
struct NearClusters {
  std::vector<std::uint32_t> cluster, first;  ///< cluster[i] has the groups first[i] … first[i + 1] - 1
  std::vector<std::uint16_t> group;
  std::size_t next{0};  ///< index of the first cluster that has not been visited

  [[nodiscard]] std::size_t left() const { return cluster.size() - next; }
};

/// Finds the clusters of bone near the tool, and for a cluster the tool balls near it. Memory is allocated at
/// set-up.
class ClusterSearch {
 public:
  /// @param max_hits  largest number of pairs (a group of tool balls, a cluster)
  ClusterSearch(const ToolBalls& tool, std::size_t max_clusters, std::size_t max_hits);

  /// Allocates the memory that Find may need in `clusters`.
  void Reserve(NearClusters& clusters) const;
  /// Finds the clusters near the tool. @returns false if there are more pairs of group and cluster than
  /// max_hits
  [[nodiscard]] bool Find(const Kernels& kernels, const BoxTree& tree, const ToolPlacement& at,
                          const ListReach& reach, bool cutting_only, NearClusters& found);
  /// Returns the tool balls that may be near the cluster clusters.cluster[place], ascending; valid until the
  /// next call.
  [[nodiscard]] std::span<const std::uint16_t> ToolsNear(const Kernels& kernels, const BoxTree& tree,
                                                         const NearClusters& clusters, std::size_t place,
                                                         const RowMaker& maker);

 private:
  // Records a hit: a group of tool balls is near a cluster.
  void AddHit(std::uint32_t cluster, std::size_t group);
  // Moves the recorded hits to `found`, by ascending cluster.
  void Collect(NearClusters& found);

  const ToolBalls& tool_;
  std::size_t max_hits_;
  std::vector<std::uint64_t> cluster_bits_, tool_bits_;  // sets with a bit for each cluster or tool ball
  std::vector<std::uint32_t> first_hit_, next_hit_;      // a list of hits for each cluster
  std::vector<std::uint16_t> hit_group_, tools_, some_tools_;
};

}  // namespace osteon::simulation::cpu
