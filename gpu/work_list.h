#pragma once

#include <vector>

#include "gpu/cluster_tree.h"
#include "gpu/shaders/layout.h"

namespace osteon::gpu {

/// Clusters that the tool can meet in a frame, each with the groups of tool balls that can: what the host
/// hands the passes that make the lists. Buffers are sized once.
///
///     items       cluster 7: refs 313 … 315     cluster 9: refs 316     …
///     group refs  0 1 2 … 312 │ 0 4 5 │ 0 │ …     (all groups first: where room is short, they stand for
///     any)
class WorkList {
 public:
  /// @param ref_capacity  of the device's buffer of group refs; the group count at least
  WorkList(std::size_t largest_cluster_count, uint group_count, std::size_t ref_capacity);

  void Clear();
  /// Lists the clusters of one tree that the groups meet. `sweep(g, meet)` calls meet(a, b, radius_mm) for
  /// group g, or leaves it out.
  template <class Sweep>
  void Add(const ClusterTree& tree, std::vector<Item>& items, Sweep sweep);

  [[nodiscard]] const std::vector<uint>& refs() const { return refs_; }

 private:
  struct Hit {
    uint cluster, group;
  };
  uint group_count_;
  std::size_t ref_capacity_;
  std::vector<uint> refs_;
  std::vector<Hit> hits_;
  std::vector<uint> counts_;    // of hits by cluster; 0 between calls
  std::vector<uint> clusters_;  // hit, in the order of their first hit
};

template <class Sweep>
void WorkList::Add(const ClusterTree& tree, std::vector<Item>& items, Sweep sweep) {
  items.clear();
  hits_.clear();
  clusters_.clear();
  bool overflow = false;
  for (uint g = 0; g < group_count_; ++g)
    sweep(g, [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, float radius_mm) {
      tree.Meet(a, b, radius_mm, [&](uint cluster) {
        if (counts_[cluster]++ == 0) clusters_.push_back(cluster);
        if (hits_.size() < hits_.capacity())
          hits_.push_back({.cluster = cluster, .group = g});
        else
          overflow = true;
      });
    });
  // groups of one cluster one after the other, in rising order: each cluster's place first, then its groups
  overflow = overflow || refs_.size() + hits_.size() > ref_capacity_;
  uint place = static_cast<uint>(refs_.size());
  if (!overflow) refs_.resize(refs_.size() + hits_.size());
  for (const uint cluster : clusters_) {
    const uint count = counts_[cluster];
    items.push_back(
        {.cluster = cluster, .first = overflow ? 0 : place, .count = overflow ? group_count_ : count});
    counts_[cluster] = place;  // from here on: where its next group goes
    place += count;
  }
  if (!overflow)
    for (const Hit& hit : hits_) refs_[counts_[hit.cluster]++] = hit.group;
  for (const uint cluster : clusters_) counts_[cluster] = 0;
}

}  // namespace osteon::gpu
