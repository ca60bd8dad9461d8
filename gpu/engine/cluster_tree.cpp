#include "gpu/engine/cluster_tree.h"

#include <algorithm>

namespace osteon::gpu {

ClusterTree::ClusterTree(std::span<const vec4> items) {
  if (items.empty()) return;
  std::vector<Eigen::AlignedBox3f> boxes((items.size() + kGroupSize - 1) / kGroupSize);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Eigen::Vector3f p(items[i].x, items[i].y, items[i].z);
    const Eigen::Vector3f r = Eigen::Vector3f::Constant(items[i].w);
    boxes[i / kGroupSize].extend(p - r).extend(p + r);
  }
  levels_.push_back(std::move(boxes));
  while (levels_.back().size() > 1) {
    const std::vector<Eigen::AlignedBox3f>& below = levels_.back();
    std::vector<Eigen::AlignedBox3f> above((below.size() + kChildren - 1) / kChildren);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / kChildren].extend(below[i]);
    levels_.push_back(std::move(above));
  }
}

}  // namespace osteon::gpu
