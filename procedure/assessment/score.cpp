#include "procedure/assessment/score.h"

#include <algorithm>
#include <array>

#include "base/units.h"

namespace osteon::procedure {
namespace {

constexpr std::array kMetrics = std::to_array<Metric>({
    {"axis_error", "deg", 1.0 / kDegree, "axis error"},
    {"superior_shift", "mm", 1e3, "shift from the native centre, superior"},
    {"medial_shift", "mm", 1e3, "shift from the native centre, medial"},
    {"posterior_shift", "mm", 1e3, "shift from the native centre, posterior"},
    {"diameter_error", "mm", 1e3, "diameter error"},
    {"form_p95", "mm", 1e3, "out of round, 95th percentile"},
    {"coverage", "ratio", 1.0, "coverage", true},
    {"opening_shift", "mm", 1e3, "shift of the opening from its axis"},
    {"depth_error", "mm", 1e3, "depth error"},
    {"unroofed", "ratio", 1.0, "roof over the target that is open", true},
    {"over_reamed", "mm3", 1e9, "over-reamed", false, MetricKnown::kWithAnyCut},
    {"under_reamed", "mm3", 1e9, "under-reamed"},
    {"cartilage_left", "ratio", 1.0, "cartilage left in the roof", false, MetricKnown::kWithAnyCut},
    {"rim_preserved", "ratio", 1.0, "rim preserved", true, MetricKnown::kWithAnyCut},
    {"time", "s", 1.0, "time", false, MetricKnown::kWithRecordings},
    {"cutting_time", "s", 1.0, "time cutting", false, MetricKnown::kWithRecordings},
    {"path", "mm", 1e3, "way of the head near the cup", false, MetricKnown::kWithRecordings},
    {"force_mean", "N", 1.0, "hand's force while cutting, mean", false, MetricKnown::kWithRecordings},
    {"force_peak", "N", 1.0, "hand's force while cutting, peak", false, MetricKnown::kWithRecordings},
    {"wrong_way", "ratio", 1.0, "share of the hand's impulse across the axis", false,
     MetricKnown::kWithRecordings},
    {"outside", "s", 1.0, "cutting outside of the corridor", false, MetricKnown::kWithRecordings},
    {"tremor", "N", 1.0, "tremor, 6 to 14 Hz", false, MetricKnown::kWithRecordings},
});

}  // namespace

std::span<const Metric> Metrics() { return kMetrics; }

const Metric& MetricNamed(std::string_view name) { return *std::ranges::find(kMetrics, name, &Metric::name); }

Score ScoreOf(const Rubric& rubric, const MetricValues& values, std::optional<double> min_wall_m) {
  Score score;
  for (const RubricItem& item : rubric.items) {
    ScoredItem scored{.item = item, .value = {}};
    if (const auto found = values.find(item.metric); found != values.end()) {
      scored.value = found->second;
      scored.points =
          item.weight * std::clamp((item.zero - found->second) / (item.zero - item.full), 0.0, 1.0);
    }
    score.total += scored.points;
    score.items.push_back(std::move(scored));
  }
  double deducted = 0.0;
  if (rubric.breach_points > 0.0 && min_wall_m && *min_wall_m <= 0.0) {
    score.deductions.push_back({"breach", rubric.breach_source, rubric.breach_points});
    deducted += rubric.breach_points;
  }
  score.total = std::max(0.0, score.total - std::min(deducted, kMaxDeduction));
  return score;
}

}  // namespace osteon::procedure
