#include "simulation/surface/swept_batches.h"

#include <algorithm>
#include <utility>

namespace osteon::surface {

bool SweptBatch::Counts(const std::vector<SweepTimes>& undone) const {
  return std::ranges::none_of(
      undone, [this](const SweepTimes& way) { return times.end >= way.begin && times.begin <= way.end; });
}

std::vector<Capsule> CapsulesOf(const SweptBatches& batches, const std::vector<SweepTimes>& undone) {
  std::vector<Capsule> capsules;
  for (const auto& batch : batches)
    if (batch->Counts(undone))
      capsules.insert(capsules.end(), batch->capsules.begin(), batch->capsules.end());
  return capsules;
}

void BatchedSweep::Add(const ToolFrame& frame, SweptBatches& out) {
  if (frame.frame != 0 && frame.cuts) {
    if (open_.times.begin == 0) open_.times.begin = frame.pose_stamp;
    open_.times.end = frame.pose_stamp;
    open_.touches = open_.touches || frame.touches;
  }
  if (sweep_.Add(frame)) EndBatch(out);
}

void BatchedSweep::EndBatch(SweptBatches& out) {
  open_.capsules = sweep_.TakeCapsules();
  SweptBatch ended = std::exchange(open_, {});
  if (!ended.capsules.empty()) out.push_back(std::make_shared<const SweptBatch>(std::move(ended)));
}

void BatchedSweep::UseTool(const simulation::Tool& tool, SweptBatches& out) {
  EndBatch(out);
  sweep_ = ToolSweep(tool, X_WG_);
}

}  // namespace osteon::surface
