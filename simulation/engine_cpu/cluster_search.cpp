#include "simulation/engine_cpu/cluster_search.h"

#include <algorithm>
#include <bit>

#include "simulation/engine_cpu/rounding.h"

namespace osteon::simulation::cpu {
namespace {

constexpr std::uint32_t kNoHit = ~0u;  // marks the end of a cluster's list of hits

// Calls visit(number) for each number in a set of bits, ascending, and empties the set.
template <class Visit>
void Drain(std::vector<std::uint64_t>& bits, Visit&& visit) {
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t left = bits[word]; left != 0; left &= left - 1)
      visit(64 * word + static_cast<std::size_t>(std::countr_zero(left)));
    bits[word] = 0;
  }
}

}  // namespace

ClusterSearch::ClusterSearch(const ToolBalls& tool, std::size_t max_clusters, std::size_t max_hits)
    : tool_(tool),
      max_hits_(std::min(max_hits, max_clusters * tool.groups().size())),
      cluster_bits_(max_clusters / 64 + 1, 0),
      tool_bits_(tool.count() / 64 + 1, 0),
      first_hit_(max_clusters, kNoHit),
      tools_(tool.count()),
      some_tools_(tool.count()) {
  next_hit_.reserve(max_hits_), hit_group_.reserve(max_hits_);
}

void ClusterSearch::Reserve(NearClusters& clusters) const {
  clusters.cluster.reserve(first_hit_.size());
  clusters.first.reserve(first_hit_.size() + 1);
  clusters.group.reserve(max_hits_);
}

void ClusterSearch::AddHit(std::uint32_t cluster, std::size_t group) {
  std::uint64_t& word = cluster_bits_[cluster / 64];
  const std::uint64_t bit = 1ull << cluster % 64;
  next_hit_.push_back((word & bit) != 0 ? first_hit_[cluster] : kNoHit);
  hit_group_.push_back(static_cast<std::uint16_t>(group));
  first_hit_[cluster] = static_cast<std::uint32_t>(next_hit_.size() - 1);
  word |= bit;
}

bool ClusterSearch::Find(const Kernels& kernels, const BoxTree& tree, const ToolPlacement& at,
                         const ListReach& reach, bool cutting_only, NearClusters& found) {
  next_hit_.clear(), hit_group_.clear();
  bool fits = true;
  const Places& p = at.places();
  for (std::size_t g = 0; g < tool_.groups().size(); ++g) {
    const ToolGroup& group = tool_.groups()[g];
    if (cutting_only && !group.cutting) continue;
    float low[3] = {kNever, kNever, kNever}, high[3] = {-kNever, -kNever, -kNever}, max_radius_mm = 0.0f;
    for (const std::uint16_t t : group.members) {
      const float center[3] = {p.x_mm[t], p.y_mm[t], p.z_mm[t]};
      for (int a = 0; a < 3; ++a)
        low[a] = std::min(low[a], center[a]), high[a] = std::max(high[a], center[a]);
      max_radius_mm = std::max(max_radius_mm, tool_.view().r_mm[t]);
    }
    const float radius_mm = max_radius_mm + (group.cutting ? reach.cutting_mm : reach.shaft_mm);
    tree.Find([&](const float(&boxes)[6][8]) { return kernels.boxes_near(boxes, low, high, radius_mm); },
              [&](std::uint32_t cluster) {
                fits = fits && next_hit_.size() < max_hits_;
                if (fits) AddHit(cluster, g);
              });
  }
  Collect(found);
  return fits;
}

void ClusterSearch::Collect(NearClusters& found) {
  found.cluster.clear(), found.first.clear(), found.group.clear();
  found.next = 0;
  Drain(cluster_bits_, [&](std::size_t cluster) {
    found.cluster.push_back(static_cast<std::uint32_t>(cluster));
    found.first.push_back(static_cast<std::uint32_t>(found.group.size()));
    for (std::uint32_t hit = first_hit_[cluster]; hit != kNoHit; hit = next_hit_[hit])
      found.group.push_back(hit_group_[hit]);
  });
  found.first.push_back(static_cast<std::uint32_t>(found.group.size()));
}

std::span<const std::uint16_t> ClusterSearch::ToolsNear(const Kernels& kernels, const BoxTree& tree,
                                                        const NearClusters& clusters, std::size_t place,
                                                        const RowMaker& maker) {
  const BoxTree::Box box = tree.BoxOf(clusters.cluster[place]);
  for (std::uint32_t i = clusters.first[place]; i < clusters.first[place + 1]; ++i) {
    const ToolGroup& group = tool_.groups()[clusters.group[i]];
    const std::size_t near = kernels.tools_near_box(maker, box.low, box.high, group.members.data(),
                                                    group.members.size(), some_tools_.data());
    for (std::size_t k = 0; k < near; ++k) tool_bits_[some_tools_[k] / 64] |= 1ull << some_tools_[k] % 64;
  }
  std::size_t count = 0;
  Drain(tool_bits_, [&](std::size_t t) { tools_[count++] = static_cast<std::uint16_t>(t); });
  return {tools_.data(), count};
}

}  // namespace osteon::simulation::cpu
