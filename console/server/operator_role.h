#pragma once

#include <cstdint>
#include <mutex>

namespace osteon::console {

/// Who holds the operator's role: at most one page, the first that asks. All others watch. Any thread.
class OperatorRole {
 public:
  /// Takes the role for a page if nobody holds it. @param page  its number, above 0
  /// @returns whether the page holds it now
  bool Take(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (holder_ == 0) holder_ = page;
    return holder_ == page;
  }
  /// Gives the role back if the page holds it: by its wish, or because it has gone.
  /// @returns whether it held it
  bool GiveBack(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (holder_ != page) return false;
    holder_ = 0;
    return true;
  }
  /// The page that holds it; 0: nobody.
  [[nodiscard]] std::uint64_t holder() const {
    const std::lock_guard lock(mutex_);
    return holder_;
  }

 private:
  mutable std::mutex mutex_;
  std::uint64_t holder_{0};
};

}  // namespace osteon::console
