#include "session/view/recording_difference.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/realtime_thread.h"
#include "console/stream/live_window.h"

namespace osteon::session {
namespace {

constexpr std::chrono::seconds kNewsPeriod{1};  // time between two messages during reading
constexpr double kMinStep_s = 0.01;             // smallest width of a bin of the time line
constexpr double kNoTick = std::numeric_limits<double>::quiet_NaN();  // value of a bin without ticks
constexpr double kSame_s = 0.5e-3;  // ticks closer than half of the shortest period are simultaneous

// One value per bin of the time line. nlohmann writes NaN as null.
using Column = std::vector<double>;

// Keeps the larger value; a kept NaN is replaced, a new NaN or infinity is ignored.
void KeepMax(double& kept, double value) {
  if (std::isfinite(value) && !(kept >= value)) kept = value;
}

// Rounds to four decimals.
nlohmann::json Rounded(const Column& column) {
  nlohmann::json out = nlohmann::json::array();
  for (const double value : column) out.push_back(std::round(1e4 * value) / 1e4);
  return out;
}

// The difference with the largest absolute value so far, and its time.
struct LargestAt {
  double value{0.0}, at_s{0.0};

  void Take(double candidate, double time_s) {
    if (!(std::abs(candidate) > std::abs(value))) return;
    value = candidate;
    at_s = time_s;
  }
  [[nodiscard]] nlohmann::json ToJson() const { return {value, at_s}; }
};

// One of the two recordings, read up to one tick beyond the tick that is compared.
struct Reader {
  RecordingTimeline timeline;
  std::optional<control::TickRecord> tick{}, next{};  // the tick that is compared, and the tick after it
  double next_s{0.0};
  // figures of the newest frame before `tick`, and before `next`
  double removed_mm3{0.0}, next_removed_mm3{0.0}, depth_mm{kNoTick}, next_depth_mm{kNoTick};
  bool ended{false};

  // Moves `next` to `tick`, and reads on to the following tick.
  void Advance() {
    tick = next;
    removed_mm3 = next_removed_mm3;
    depth_mm = next_depth_mm;
    while (true) {
      const auto topic = timeline.Next();
      if (!topic || *topic == io::RecordedTopic::kOther) {
        ended = true;
        return;
      }
      if (*topic == io::RecordedTopic::kFrame) {
        next_removed_mm3 = 1e9 * timeline.message().frame.model.removed_volume_m3;
        next_depth_mm = 1e3 * timeline.message().frame.cup_depth_m;
      }
      if (*topic != io::RecordedTopic::kTick) continue;
      next = timeline.message().tick;
      next_s = timeline.At(next->stamp);
      return;
    }
  }
};

// The result so far: columns (values per bin of the time line) of the two recordings and of their
// differences, and the largest differences.
struct Compared {
  double step_s{kMinStep_s};
  std::array<Column, 2> force_N, depth_mm, removed_mm3;
  Column force_apart_N, apart_mm, turn_deg;
  LargestAt max_force, max_depth, max_apart, max_turn, max_removed;
  std::uint64_t ticks{0};  // number of compared pairs of ticks

  explicit Compared(double duration_s)
      : step_s(std::max(kMinStep_s, duration_s / static_cast<double>(RecordingDifference::kMaxBins))) {
    const auto bins = static_cast<std::size_t>(duration_s / step_s) + 1;
    for (auto* columns : {&force_N, &depth_mm, &removed_mm3})
      for (Column& column : *columns) column.assign(bins, kNoTick);
    for (Column* column : {&force_apart_N, &apart_mm, &turn_deg}) column->assign(bins, kNoTick);
  }

  [[nodiscard]] std::size_t BinOf(double time_s) const {
    const auto bin = static_cast<std::size_t>(std::max(0.0, time_s) / step_s);
    return std::min(bin, apart_mm.size() - 1);
  }

  [[nodiscard]] std::string ToJson(bool done) const {
    const auto both = [](const std::array<Column, 2>& columns) {
      return nlohmann::json{Rounded(columns[0]), Rounded(columns[1])};
    };
    return nlohmann::json{{"type", "difference"},
                          {"step_s", step_s},
                          {"force_N", both(force_N)},
                          {"depth_mm", both(depth_mm)},
                          {"removed_mm3", both(removed_mm3)},
                          {"force_apart_N", Rounded(force_apart_N)},
                          {"apart_mm", Rounded(apart_mm)},
                          {"turn_deg", Rounded(turn_deg)},
                          {"most",
                           {{"force_N", max_force.ToJson()},
                            {"depth_mm", max_depth.ToJson()},
                            {"apart_mm", max_apart.ToJson()},
                            {"turn_deg", max_turn.ToJson()},
                            {"removed_mm3", max_removed.ToJson()}}},
                          {"ticks", ticks},
                          {"done", done}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
};

}  // namespace

TickDifference Compare(const control::TickRecord& first, const control::TickRecord& second) {
  const Pose X_1 = first.X_WT_cmd, X_2 = second.X_WT_cmd;
  const Matrix3 R_12 = X_1.linear().transpose() * X_2.linear();
  return {
      .force_N = (Vector3(second.F_coupling_T_W.f) - Vector3(first.F_coupling_T_W.f)).norm(),
      .apart_mm = 1e3 * (X_2.translation() - X_1.translation()).norm(),
      // compute the angle from its sine and cosine: the sine is accurate for nearly equal orientations
      .turn_deg =
          180.0 / std::numbers::pi *
          std::atan2(
              0.5 * Vector3(R_12(2, 1) - R_12(1, 2), R_12(0, 2) - R_12(2, 0), R_12(1, 0) - R_12(0, 1)).norm(),
              0.5 * (R_12.trace() - 1.0))};
}

RecordingDifference::RecordingDifference(const std::array<std::filesystem::path, 2>& recordings)
    : json_(Compared(0.0).ToJson(false)), thread_([this, recordings] { Run(recordings); }) {}

RecordingDifference::~RecordingDifference() {
  stop_.store(true);
  thread_.join();
}

std::string RecordingDifference::Json() const {
  const std::lock_guard lock(mutex_);
  return json_;
}

void RecordingDifference::Run(const std::array<std::filesystem::path, 2>& recordings) {
  rt::NameThread("difference");
  rt::LowerPriority();
  const auto tell = [&](const Compared& compared, bool done) {
    std::string json = compared.ToJson(done);
    const std::lock_guard lock(mutex_);
    json_ = std::move(json);
  };
  std::vector<Reader> readers;
  for (const std::filesystem::path& path : recordings) {
    auto timeline = RecordingTimeline::Open(path);
    if (!timeline) return tell(Compared(0.0), true);  // the file was removed in the meantime
    (void)timeline->Seek(0.0);
    readers.push_back({.timeline = std::move(*timeline)});
  }
  Compared compared(std::max(readers[0].timeline.duration_s(), readers[1].timeline.duration_s()));
  auto told = std::chrono::steady_clock::now();
  for (Reader& reader : readers) reader.Advance();
  while (!stop_.load() && !(readers[0].ended && readers[1].ended)) {
    // advance the recording whose next tick is earlier; advance both if the times are the same
    const std::array<double, 2> next_s{readers[0].ended ? INFINITY : readers[0].next_s,
                                       readers[1].ended ? INFINITY : readers[1].next_s};
    const double time_s = std::min(next_s[0], next_s[1]);
    const std::size_t bin = compared.BinOf(time_s);
    for (std::size_t i = 0; i < 2; ++i) {
      if (!(next_s[i] <= time_s + kSame_s)) continue;
      readers[i].Advance();
      const control::TickRecord& tick = *readers[i].tick;
      KeepMax(compared.force_N[i][bin], console::Length(tick.F_coupling_T_W.f));
      compared.depth_mm[i][bin] = readers[i].depth_mm;
      compared.removed_mm3[i][bin] = readers[i].removed_mm3;
    }
    // stop at the end of the shorter recording: there is nothing more to compare
    const bool both_go_on = std::isfinite(next_s[0]) && std::isfinite(next_s[1]);
    if (both_go_on && readers[0].tick && readers[1].tick) {
      const TickDifference difference = Compare(*readers[0].tick, *readers[1].tick);
      KeepMax(compared.force_apart_N[bin], difference.force_N);
      KeepMax(compared.apart_mm[bin], difference.apart_mm);
      KeepMax(compared.turn_deg[bin], difference.turn_deg);
      compared.max_force.Take(difference.force_N, time_s);
      compared.max_depth.Take(readers[1].depth_mm - readers[0].depth_mm, time_s);
      compared.max_apart.Take(difference.apart_mm, time_s);
      compared.max_turn.Take(difference.turn_deg, time_s);
      compared.max_removed.Take(readers[1].removed_mm3 - readers[0].removed_mm3, time_s);
      ++compared.ticks;
    }
    if (const auto now = std::chrono::steady_clock::now(); now - told >= kNewsPeriod) {
      told = now;
      tell(compared, false);
    }
  }
  tell(compared, true);
}

}  // namespace osteon::session
