#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace osteon::simulation::cpu {

/// Bounding volume hierarchy with eight boxes to a node. A leaf is the box around a cluster of 64 consecutive
/// balls or points. The order of balls and points follows a space-filling curve, so the boxes are small. The
/// boxes are those of the uncut bone; they stay valid because balls and points only shrink or vanish.
class BoxTree {
 public:
  static constexpr std::uint32_t kCluster = 64;  ///< number of balls or points in a cluster
  /// Eight boxes: the smallest x, y, z of each box, then the largest [mm]. An empty box has smallest >
  /// largest.
  struct alignas(64) Node {
    float box[6][8];
  };
  struct Box {
    float low[3], high[3];  ///< [mm]
  };

  BoxTree() = default;
  /// @param boxes  box of each item, in the items' order [mm]
  explicit BoxTree(const std::vector<Box>& boxes);

  [[nodiscard]] std::uint32_t cluster_count() const { return cluster_count_; }
  [[nodiscard]] Box BoxOf(std::uint32_t cluster) const;
  /// Excludes a cluster from later searches, until Reset. Used when nothing of the cluster is left.
  void Drop(std::uint32_t cluster);
  /// Undoes each Drop.
  void Reset();

  /// Calls visit(cluster) for each cluster whose box matches, in ascending order.
  /// @param meets  returns a bit for each of a node's eight boxes that matches
  template <class Meets, class Visit>
  void Find(const Meets& meets, Visit&& visit) const {
    if (!levels_.empty()) Descend(levels_.size() - 1, 0, meets, visit);
  }

 private:
  // Does the search of Find for one node of a level (0: the clusters' level) and for the nodes below it.
  template <class Meets, class Visit>
  void Descend(std::size_t level, std::size_t node, const Meets& meets, Visit&& visit) const {
    const unsigned found = meets(levels_[level][node].box);
    const std::size_t count = level == 0 ? cluster_count_ : levels_[level - 1].size();
    for (unsigned k = 0; k < 8; ++k) {
      const std::size_t child = node * 8 + k;
      // skip empty boxes, which have no child: a search with a coordinate that is not finite matches them,
      // too
      if ((found >> k & 1u) == 0 || child >= count) continue;
      if (level == 0)
        visit(static_cast<std::uint32_t>(child));
      else
        Descend(level - 1, child, meets, visit);
    }
  }

  std::vector<std::vector<Node>> levels_;  // levels from the clusters up to the root
  std::vector<Node> first_level_;          // the clusters' level as built, for Reset
  std::uint32_t cluster_count_{0};
};

}  // namespace osteon::simulation::cpu
