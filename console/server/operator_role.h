#pragma once

#include <cstdint>
#include <mutex>

namespace osteon::console {

/// The operator's role. At most one page has it: the first one that requests it. All other pages only watch.
/// Any thread.
class OperatorRole {
 public:
  /// Gives the role to a page if no page has it. @param page  number of the page, above 0
  /// @returns whether the page holds it now
  bool Take(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (holder_ == 0) holder_ = page;
    return holder_ == page;
  }
  /// Takes the role from the page if the page holds it. Called when the page gives the role back or has
  /// disconnected.
  /// @returns whether the page held the role
  bool GiveBack(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (holder_ != page) return false;
    holder_ = 0;
    return true;
  }
  /// The number of the page that has the role; 0: no page has it.
  [[nodiscard]] std::uint64_t holder() const {
    const std::lock_guard lock(mutex_);
    return holder_;
  }

 private:
  mutable std::mutex mutex_;
  std::uint64_t holder_{0};
};

}  // namespace osteon::console
