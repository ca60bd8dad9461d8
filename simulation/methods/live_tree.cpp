#include "simulation/methods/live_tree.h"

#include <algorithm>
#include <numeric>

#include "simulation/packing/morton.h"

namespace osteon::simulation {
namespace {

Eigen::AlignedBox3d BoxOf(const Vector3& center_m, double radius_m) {
  const Vector3 reach = Vector3::Constant(radius_m);
  return {Vector3(center_m - reach), Vector3(center_m + reach)};
}

}  // namespace

LiveTree::LiveTree(std::span<const Ball> items)
    : order_(items.size()), place_(items.size()), left_(items.size(), true) {
  if (items.empty()) return;
  Eigen::AlignedBox3d bounds;
  for (const Ball& item : items) bounds.extend(Vector3(item.center_m));
  std::iota(order_.begin(), order_.end(), 0u);
  SortAlongMortonCurve(order_, bounds, [&](std::uint32_t item) { return Vector3(items[item].center_m); });
  for (std::size_t i = 0; i < order_.size(); ++i) place_[order_[i]] = static_cast<std::uint32_t>(i);

  // number of nodes needed on the level above `count` items or nodes
  const auto groups = [](std::size_t count) { return (count + kChildren - 1) / kChildren; };
  levels_.emplace_back(groups(items.size()));
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Ball& item = items[order_[i]];
    Node& leaf = levels_[0][i / kChildren];
    leaf.box.extend(BoxOf(item.center_m, item.radius_m));
    ++leaf.left;
  }
  // build each level from the one below, up to a single root
  while (levels_.back().size() > 1) {
    const std::vector<Node>& below = levels_.back();
    std::vector<Node> level(groups(below.size()));
    for (std::size_t i = 0; i < below.size(); ++i) {
      level[i / kChildren].box.extend(below[i].box);
      level[i / kChildren].left += below[i].left;
    }
    levels_.push_back(std::move(level));
  }
}

void LiveTree::Grow(std::uint32_t item, const Vector3& center_m, double radius_m) {
  const Eigen::AlignedBox3d box = BoxOf(center_m, radius_m);
  std::size_t index = place_[item];
  for (std::vector<Node>& level : levels_) {
    Node& node = level[index /= kChildren];
    if (node.box.contains(box)) return;  // and so do the boxes above
    node.box.extend(box);
  }
}

void LiveTree::Remove(std::uint32_t item) {
  if (!left_[item]) return;
  left_[item] = false;
  std::size_t index = place_[item];
  for (std::vector<Node>& level : levels_) --level[index /= kChildren].left;
}

void LiveTree::Restore(const std::vector<bool>& left) {
  for (std::vector<Node>& level : levels_)
    for (Node& node : level) node.left = 0;
  left_ = left;
  for (std::size_t item = 0; item < left_.size(); ++item) {
    if (!left_[item]) continue;
    std::size_t index = place_[item];
    for (std::vector<Node>& level : levels_) ++level[index /= kChildren].left;
  }
}

}  // namespace osteon::simulation
