#include "session/summary/deflection_events.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "safety/acting_limits.h"

namespace osteon::session {
namespace {

// An event has ended once the displacement has been below the cell's error for this time.
constexpr rt::Nanoseconds kEventGap = rt::kSecond / 2;

// Returns the part with the largest displacement, and this displacement [m].
std::pair<const char*, double> FurthestPart(const control::ComplianceRecord& record) {
  const std::array<std::pair<const char*, double>, 3> parts{
      {{"the tool", Vector3(record.bend_m).norm()},
       {"the surface layer", Vector3(record.layer_m).norm()},
       {"the bone on its mount", Vector3(record.mount_m).norm()}}};
  return *std::ranges::max_element(parts, {}, [](const auto& part) { return part.second; });
}

}  // namespace

void PeakDeflection::Add(const control::ComplianceRecord& record) {
  if (!record.present) return;
  present = true;
  bend_m = std::max(bend_m, Vector3(record.bend_m).norm());
  layer_m = std::max(layer_m, Vector3(record.layer_m).norm());
  mount_m = std::max(mount_m, Vector3(record.mount_m).norm());
  mount_rad = std::max(mount_rad, Vector3(record.mount_rad).norm());
}

bool DeflectionEvents::Add(const control::TickRecord& tick) {
  if (!start_) start_ = tick.stamp;
  if (!safety::LimitSet(tick.limits).Has(safety::Limit::kDeflection)) return false;
  const bool begins = !last_ || tick.stamp - *last_ >= kEventGap;
  last_ = tick.stamp;
  const double displaced_mm = 1e3 * FurthestPart(tick.compliance).second;
  if (begins)
    rows_.push_back({.name = kDeflectionEvent, .time_s = rt::ToSeconds(tick.stamp - *start_), .unit = "mm"});
  rows_.back().value = std::max(rows_.back().value, displaced_mm);
  return begins;
}

std::string DescribeDeflection(const control::ComplianceRecord& record) {
  const auto [part, displaced_m] = FurthestPart(record);
  return fmt::format("{}: {} gives way by {:.3f} mm, more than the cell's error", kDeflectionEvent, part,
                     1e3 * displaced_m);
}

void DeflectionSink::TakeTick(const control::TickRecord& tick) {
  if (events_.Add(tick) && recorder_) recorder_->PushEvent(tick.stamp, DescribeDeflection(tick.compliance));
  if (next_) next_->TakeTick(tick);
}

void DeflectionSink::TakeFrame(const simulation::FrameRecord& frame) {
  if (next_) next_->TakeFrame(frame);
}

void DeflectionSink::TakeEvent(const io::RecordedEvent& event) {
  if (next_) next_->TakeEvent(event);
}

}  // namespace osteon::session
