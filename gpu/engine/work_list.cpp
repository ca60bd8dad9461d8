#include "gpu/engine/work_list.h"

#include <numeric>
#include <utility>

namespace osteon::gpu {

WorkList::WorkList(std::size_t largest_cluster_count, const ToolLayout& tool, std::size_t ref_capacity)
    : tool_(&tool), ref_capacity_(ref_capacity), counts_(largest_cluster_count) {
  refs_.reserve(ref_capacity);
  near_.reserve(ref_capacity);
  end_.reserve(tool.groups.size());
  hits_.reserve(ref_capacity);
  clusters_.reserve(largest_cluster_count);
  refs_.resize(tool.balls.size());
  std::iota(refs_.begin(), refs_.end(), 0u);
}

void WorkList::Add(const ClusterTree& tree, std::span<const BallSweep> groups,
                   std::span<const BallSweep> balls, std::vector<ClusterPairs>& items) {
  items.clear();
  near_.clear();
  end_.clear();
  hits_.clear();
  clusters_.clear();
  bool overflow = false;
  const auto count_hit = [&](uint cluster) {
    if (counts_[cluster].all == 0) clusters_.push_back(cluster);
    ++counts_[cluster].all;
  };
  // First find the clusters that each group's bounding ball may meet. Then test each of the group's balls
  // against these clusters, in ascending order of balls, so that the tool balls of every cluster are in
  // ascending order.
  for (const BallSweep& group : groups) {
    if (group.radius_mm >= 0.0f)
      tree.VisitOverlapping(group.a, group.b, group.radius_mm, [&](uint cluster) {
        overflow = overflow || near_.size() == near_.capacity();
        if (!overflow)
          near_.push_back(cluster);
        else
          count_hit(cluster);
      });
    end_.push_back(near_.size());
  }
  // If a buffer is too small, every cluster that a group meets is listed with all tool balls.
  if (overflow)
    for (const uint cluster : near_) count_hit(cluster);
  for (uint t = 0; t < balls.size() && !overflow; ++t) {
    if (balls[t].radius_mm < 0.0f) continue;
    const ClusterTree::Sweep sweep(balls[t].a, balls[t].b, balls[t].radius_mm);
    const uint g = tool_->group_of[t];
    for (std::size_t i = g == 0 ? 0 : end_[g - 1]; i < end_[g]; ++i) {
      const uint cluster = near_[i];
      if (!tree.Overlaps(sweep, cluster)) continue;
      count_hit(cluster);
      if (tool_->Cuts(t)) ++counts_[cluster].cutters;
      if (hits_.size() < hits_.capacity()) hits_.push_back({.cluster = cluster, .ball = t});
    }
  }
  std::size_t needed = refs_.size();
  for (const uint cluster : clusters_) needed += counts_[cluster].all;
  overflow = overflow || needed > ref_capacity_;
  uint next_ref = static_cast<uint>(refs_.size());
  if (!overflow) refs_.resize(needed);
  for (const uint cluster : clusters_) {
    Count& count = counts_[cluster];
    if (overflow) {
      items.push_back({.cluster = cluster,
                       .first = 0,
                       .cutters = static_cast<uint>(tool_->cutter_count),
                       .count = static_cast<uint>(balls.size())});
      continue;
    }
    items.push_back({.cluster = cluster, .first = next_ref, .cutters = count.cutters, .count = count.all});
    // from here on, count.all is the index of the cluster's next ball in the tool refs
    next_ref += std::exchange(count.all, next_ref);
  }
  if (!overflow)
    for (const Hit& hit : hits_) refs_[counts_[hit.cluster].all++] = hit.ball;
  for (const uint cluster : clusters_) counts_[cluster] = {};
}

}  // namespace osteon::gpu
