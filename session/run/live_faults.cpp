#include "session/run/live_faults.h"

#include <utility>

#include "session/stops/stop_records.h"
#include "session/summary/each_fault.h"
#include "session/summary/fault_seen.h"
#include "session/summary/run_files.h"

namespace osteon::session {

LiveFaults::LiveFaults(const config::CellConfig& cell, std::filesystem::path recording, io::RecordSink& next)
    : cell_(cell), recording_(std::move(recording)), next_(next) {}

void LiveFaults::TakeTick(const control::TickRecord& tick) {
  UpdateSeen(tick);
  if (changed_)
    if (const std::unique_lock lock(mutex_, std::try_to_lock);
        lock) {  // if a reader holds the lock, the next tick tries again
      notes_.clear();
      const std::string page =
          stopped_ && !recording_.empty()
              ? StopPage(recording_.parent_path(), recording_.stem().string(), stops_).string()
              : "";
      for (const auto& [fault, seen] : seen_) notes_[fault] = {.seen = seen, .page = page};
      changed_ = false;
    }
  next_.TakeTick(tick);
}

void LiveFaults::UpdateSeen(const control::TickRecord& tick) {
  if (begun_ && BeginsStop(before_, tick)) {
    ++stops_;
    stopped_ = changed_ = true;
  }
  if (MovesArm(tick.phase)) stopped_ = false;
  if (tick.faults != (begun_ ? before_.faults : 0u)) {
    changed_ = true;
    ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
      const bool latched = (tick.faults & static_cast<std::uint32_t>(fault)) != 0;
      if (!latched) seen_.erase(fault);
      if (latched && !seen_.contains(fault)) seen_[fault] = SeenAt(fault, tick, &cell_.servo);
    });
  }
  before_ = tick;
  begun_ = true;
}

console::FaultNote LiveFaults::Of(safety::Fault fault) const {
  const std::lock_guard lock(mutex_);
  const auto found = notes_.find(fault);
  return found == notes_.end() ? console::FaultNote{} : found->second;
}

}  // namespace osteon::session
