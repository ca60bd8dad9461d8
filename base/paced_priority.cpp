#include "base/paced_priority.h"

#include <sched.h>

namespace osteon::rt {
namespace {

constexpr Nanoseconds kWindow = 100 * kMillisecond;
constexpr int kPriority = 5;

}  // namespace

PacedPriority::PacedPriority() noexcept { Set(true); }

PacedPriority::~PacedPriority() {
  if (is_lifted_) Set(false);
}

void PacedPriority::CountWork(Nanoseconds start, Nanoseconds end) noexcept {
  if (window_start_ < 0) window_start_ = start;
  worked_ += end - start;
  const Nanoseconds passed = end - window_start_;
  if (passed < kWindow) return;
  if (is_lifted_ && worked_ * 10 > passed * 8) Set(false);
  if (!is_lifted_ && worked_ * 2 < passed) Set(true);
  window_start_ = end;
  worked_ = 0;
}

void PacedPriority::Set(bool lifted) noexcept {
  is_lifted_ = lifted;
  const sched_param priority{.sched_priority = lifted ? kPriority : 0};
  // a thread that this one begins, to pack coarser zones, is an ordinary one
  (void)sched_setscheduler(0, lifted ? SCHED_FIFO | SCHED_RESET_ON_FORK : SCHED_OTHER, &priority);
}

}  // namespace osteon::rt
