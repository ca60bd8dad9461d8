#include "gpu/work_list.h"

#include <numeric>

namespace osteon::gpu {

WorkList::WorkList(std::size_t largest_cluster_count, uint group_count, std::size_t ref_capacity)
    : group_count_(group_count), ref_capacity_(ref_capacity), counts_(largest_cluster_count, 0) {
  refs_.reserve(ref_capacity);
  hits_.reserve(ref_capacity);
  clusters_.reserve(largest_cluster_count);
  refs_.resize(group_count);
  std::iota(refs_.begin(), refs_.end(), 0u);
}

void WorkList::Clear() { refs_.resize(group_count_); }

}  // namespace osteon::gpu
