#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace osteon::simulation::cpu {

/// Boxes around clusters of 64 balls or points in their first state, eight to a node, in a tree over the
/// list's order (which is a space-filling curve). Bone only shrinks inside itself, so a box is never wrong.
class BoxTree {
 public:
  static constexpr std::uint32_t kCluster = 64;
  /// Eight boxes: the least x, y, z of each, then the largest [mm]. A box that holds nothing is inside out.
  struct alignas(64) Node {
    float box[6][8];
  };
  struct Box {
    float low[3], high[3];
  };

  BoxTree() = default;
  /// @param boxes  of each item, in the list's order [mm]
  explicit BoxTree(const std::vector<Box>& boxes);

  [[nodiscard]] std::uint32_t cluster_count() const { return cluster_count_; }
  [[nodiscard]] Box BoxOf(std::uint32_t cluster) const;
  /// A cluster of which nothing is left is found no more, until Reset.
  void Drop(std::uint32_t cluster);
  void Reset();

  /// Calls visit(cluster) for those whose box meets, ascending.
  /// @param meets  bits of a node's eight boxes that meet what is looked for
  template <class Meets, class Visit>
  void Find(const Meets& meets, Visit&& visit) const {
    if (!levels_.empty()) Descend(levels_.size() - 1, 0, meets, visit);
  }

 private:
  template <class Meets, class Visit>
  void Descend(std::size_t level, std::size_t node, const Meets& meets, Visit&& visit) const {
    const unsigned found = meets(levels_[level][node].box);
    for (unsigned k = 0; k < 8; ++k) {
      if ((found >> k & 1u) == 0) continue;
      const std::size_t child = node * 8 + k;
      if (level == 0)
        visit(static_cast<std::uint32_t>(child));
      else
        Descend(level - 1, child, meets, visit);
    }
  }

  std::vector<std::vector<Node>> levels_;  // clusters first
  std::vector<Node> first_level_;          // as it was built
  std::uint32_t cluster_count_{0};
};

}  // namespace osteon::simulation::cpu
