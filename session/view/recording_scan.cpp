#include "session/view/recording_scan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/realtime_thread.h"
#include "console/stream/live_window.h"

namespace osteon::session {
namespace {

constexpr std::chrono::seconds kScanNewsPeriod{1};  // time between two messages during reading

// The events and the largest forces read so far.
struct Seen {
  nlohmann::json events = nlohmann::json::array();
  std::vector<double> force_N;  // the largest force of each second

  [[nodiscard]] std::string ToJson(bool done) const {
    nlohmann::json force = nlohmann::json::array();
    for (const double max_N : force_N) force.push_back(std::round(10.0 * max_N) / 10.0);
    return nlohmann::json{{"type", "timeline"}, {"events", events}, {"force_N", force}, {"done", done}}.dump(
        -1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
};

}  // namespace

RecordingScan::RecordingScan(const std::filesystem::path& path)
    : json_(Seen{}.ToJson(false)), thread_([this, path] { Run(path); }) {}

RecordingScan::~RecordingScan() {
  stop_.store(true);
  thread_.join();
}

std::string RecordingScan::Json() const {
  const std::lock_guard lock(mutex_);
  return json_;
}

void RecordingScan::Run(const std::filesystem::path& path) {
  rt::NameThread("scan");
  rt::LowerPriority();
  Seen seen;
  auto told = std::chrono::steady_clock::now();
  const auto tell = [&](bool done) {
    std::string json = seen.ToJson(done);
    const std::lock_guard lock(mutex_);
    json_ = std::move(json);
  };
  auto timeline = RecordingTimeline::Open(path);
  if (!timeline) return tell(true);  // the file was removed in the meantime: stop reading
  (void)timeline->Seek(0.0);
  while (!stop_.load()) {
    const auto topic = timeline->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kEvent)
      seen.events.push_back({timeline->At(timeline->message().event.stamp), timeline->message().event.text});
    if (*topic != io::RecordedTopic::kTick) continue;
    const control::TickRecord& tick = timeline->message().tick;
    const auto second =
        static_cast<std::size_t>(std::clamp(timeline->At(tick.stamp), 0.0, timeline->duration_s()));
    if (seen.force_N.size() <= second) seen.force_N.resize(second + 1, 0.0);
    seen.force_N[second] = std::max(seen.force_N[second], console::Length(tick.F_coupling_T_W.f));
    if (const auto now = std::chrono::steady_clock::now(); now - told >= kScanNewsPeriod) {
      told = now;
      tell(false);
    }
  }
  tell(true);
}

}  // namespace osteon::session
