#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// Spatial index of a bone's items: balls, or mass points as balls of radius 0. Items that are cut away are
/// removed one by one.
///
/// A tree of boxes with eight children per node, over items that are sorted along a Morton curve. Boxes only
/// grow: a ball that shrinks within its original ball keeps them, one that leaves it must be told (Grow). A
/// node counts its remaining items.
class LiveTree {
 public:
  explicit LiveTree(std::span<const Ball> items);

  /// Extends the boxes around an item so that they hold this ball too.
  void Grow(std::uint32_t item, const Vector3& center_m, double radius_m);
  /// Removes an item: later searches do not visit it. Removing an item twice has no effect.
  void Remove(std::uint32_t item);
  /// Sets which items remain.
  /// @param left  for each item: true if it remains
  void Restore(const std::vector<bool>& left);
  [[nodiscard]] std::size_t size() const { return order_.size(); }

  /// Calls visit(item) for each remaining item whose box comes nearer to p than `reach_m`; items that lie
  /// entirely nearer to p than `hollow_m` may be skipped. The order of visits is always the same. An item may
  /// be removed during its own visit.
  template <typename Visit>
  void ForEachNear(const Vector3& p_m, double reach_m, double hollow_m, const Visit& visit) const {
    if (levels_.empty()) return;
    Descend(static_cast<int>(levels_.size()) - 1, 0, p_m, reach_m, hollow_m, visit);
  }

 private:
  static constexpr std::size_t kChildren = 8;

  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t left{0};  ///< number of remaining items below the node
  };

  /// ForEachNear for the items below one node.
  /// @param level, index  place of the node in levels_
  template <typename Visit>
  void Descend(int level, std::size_t index, const Vector3& p_m, double reach_m, double hollow_m,
               const Visit& visit) const {
    const Node& node = levels_[static_cast<std::size_t>(level)][index];
    if (node.left == 0 || !(node.box.squaredExteriorDistance(p_m) < reach_m * reach_m)) return;
    if (hollow_m > 0.0) {
      // skip the node if even the farthest corner of its box is nearer than hollow_m
      const Vector3 far = (p_m - node.box.min()).cwiseAbs().cwiseMax((p_m - node.box.max()).cwiseAbs());
      if (far.squaredNorm() < hollow_m * hollow_m) return;
    }
    const std::size_t begin = index * kChildren;
    if (level == 0) {
      const std::size_t end = std::min(begin + kChildren, order_.size());
      for (std::size_t i = begin; i < end; ++i)
        if (left_[order_[i]]) visit(order_[i]);
      return;
    }
    const std::size_t end = std::min(begin + kChildren, levels_[static_cast<std::size_t>(level) - 1].size());
    for (std::size_t i = begin; i < end; ++i) Descend(level - 1, i, p_m, reach_m, hollow_m, visit);
  }

  std::vector<std::uint32_t> order_;       ///< items, sorted along the curve
  std::vector<std::uint32_t> place_;       ///< for each item: its position in order_
  std::vector<bool> left_;                 ///< for each item: true if it remains
  std::vector<std::vector<Node>> levels_;  ///< leaves first, the root's level last
};

}  // namespace osteon::simulation
