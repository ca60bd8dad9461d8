#include "simulation/engine_cpu/box_tree.h"

#include <algorithm>
#include <limits>

namespace osteon::simulation::cpu {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Empties box k of a node.
void Empty(BoxTree::Node& node, std::size_t k) {
  for (int a = 0; a < 3; ++a) node.box[a][k] = kInfinity, node.box[a + 3][k] = -kInfinity;
}

// Enlarges box k of a node until it holds another box.
void Extend(BoxTree::Node& node, std::size_t k, const BoxTree::Box& box) {
  for (int a = 0; a < 3; ++a) {
    node.box[a][k] = std::min(node.box[a][k], box.low[a]);
    node.box[a + 3][k] = std::max(node.box[a + 3][k], box.high[a]);
  }
}

// Box k of a node.
BoxTree::Box BoxIn(const BoxTree::Node& node, std::size_t k) {
  BoxTree::Box box{};
  for (int a = 0; a < 3; ++a) box.low[a] = node.box[a][k], box.high[a] = node.box[a + 3][k];
  return box;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes)
    : cluster_count_(static_cast<std::uint32_t>((boxes.size() + kCluster - 1) / kCluster)) {
  if (cluster_count_ == 0) return;
  Node none;
  for (std::size_t k = 0; k < 8; ++k) Empty(none, k);
  levels_.emplace_back((cluster_count_ + 7) / 8, none);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    Extend(levels_[0][i / kCluster / 8], i / kCluster % 8, boxes[i]);
  while (levels_.back().size() > 1) {
    const std::vector<Node>& below = levels_.back();
    std::vector<Node> above((below.size() + 7) / 8, none);
    for (std::size_t i = 0; i < below.size(); ++i)
      for (std::size_t k = 0; k < 8; ++k) Extend(above[i / 8], i % 8, BoxIn(below[i], k));
    levels_.push_back(std::move(above));
  }
  first_level_ = levels_[0];
}

BoxTree::Box BoxTree::BoxOf(std::uint32_t cluster) const {
  return BoxIn(levels_[0][cluster / 8], cluster % 8);
}

void BoxTree::Drop(std::uint32_t cluster) { Empty(levels_[0][cluster / 8], cluster % 8); }

void BoxTree::Reset() {
  if (!levels_.empty()) std::copy(first_level_.begin(), first_level_.end(), levels_[0].begin());
}

}  // namespace osteon::simulation::cpu
