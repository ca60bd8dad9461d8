#include "simulation/surface/swept_batches.h"

#include <algorithm>
#include <utility>

namespace osteon::surface {

bool SweptBatch::Counts(const std::vector<WayTimes>& taken_back) const {
  return std::ranges::none_of(
      taken_back, [this](const WayTimes& way) { return times.end >= way.begin && times.begin <= way.end; });
}

std::vector<Capsule> CapsulesOf(const SweptBatches& batches, const std::vector<WayTimes>& taken_back) {
  std::vector<Capsule> capsules;
  for (const auto& batch : batches)
    if (batch->Counts(taken_back))
      capsules.insert(capsules.end(), batch->capsules.begin(), batch->capsules.end());
  return capsules;
}

void BatchedWays::Add(const ToolFrame& frame, SweptBatches& out) {
  if (frame.frame != 0 && frame.cuts) {
    if (open_.times.begin == 0) open_.times.begin = frame.pose_stamp;
    open_.times.end = frame.pose_stamp;
    open_.touches = open_.touches || frame.touches;
  }
  if (ways_.Add(frame)) EndBatch(out);
}

void BatchedWays::EndBatch(SweptBatches& out) {
  open_.capsules = ways_.TakeCapsules();
  SweptBatch ended = std::exchange(open_, {});
  if (!ended.capsules.empty()) out.push_back(std::make_shared<const SweptBatch>(std::move(ended)));
}

void BatchedWays::UseTool(const simulation::Tool& tool, SweptBatches& out) {
  EndBatch(out);
  ways_ = ToolWays(tool, X_WG_);
}

}  // namespace osteon::surface
