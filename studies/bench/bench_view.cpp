#include "studies/bench/bench_view.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "base/json_text.h"
#include "base/percentile.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "console/server/surface_feed.h"
#include "io/recording/recorder.h"
#include "io/recording/recording_reader.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "session/setup/cell_setup.h"
#include "session/summary/chart_files.h"
#include "session/view/playback.h"
#include "session/view/recording_scan.h"
#include "session/view/view_surface.h"

namespace osteon::studies {
namespace {

using ViewClock = std::chrono::steady_clock;
constexpr std::chrono::minutes kViewPatience{20};  // longest wait for anything to be shown
// A tick or a bone within this time of the requested one counts as shown: a window of the feed covers 30 ms.
constexpr double kTickNear_s = 0.05;
// length of the page's charts, and number of windows per second from which they count as complete
constexpr double kStrip_s = 30.0, kMinWindowsPerSecond = 20.0;

double SecondsSince(ViewClock::time_point begun) {
  return std::chrono::duration<double>(ViewClock::now() - begun).count();
}

// Waits until `holds` returns true. @returns the seconds since `begun`; nothing if kViewPatience passed first
std::optional<double> Await(ViewClock::time_point begun, const std::function<bool()>& holds) {
  while (!holds()) {
    if (ViewClock::now() - begun > kViewPatience) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return SecondsSince(begun);
}

// Writes a recording's ticks, frames and events again and again, with stamps and numbers that continue.
// @returns the length of the result [s], at least `seconds`
tl::expected<double, std::string> WriteRepeated(const std::filesystem::path& from, double seconds,
                                                const std::filesystem::path& to) {
  std::unique_ptr<io::Recorder> recorder;
  rt::Nanoseconds offset = 0, first = 0, last = 0;
  std::uint64_t tick_offset = 0, frame_offset = 0, ticks = 0, frames = 0;
  while (rt::ToSeconds(last - first) < seconds) {
    auto stream = io::RecordingStream::Open(from);
    if (!stream) return tl::unexpected(stream.error());
    const rt::Nanoseconds last_before = last;
    while (true) {
      const auto topic = stream->Next();
      if (!topic) return tl::unexpected(topic.error());
      if (*topic == io::RecordedTopic::kOther) break;
      if (!recorder) {
        first = stream->session.stamp;
        auto opened = io::Recorder::Open({.path = to, .writer_thread = false}, stream->session);
        if (!opened) return tl::unexpected(opened.error());
        recorder = std::move(*opened);
      }
      if (*topic == io::RecordedTopic::kTick) {
        control::TickRecord& tick = stream->tick;
        tick.stamp += offset;
        tick.tick += tick_offset;
        tick.model_frame += frame_offset;
        last = tick.stamp;
        ticks = tick.tick;
        recorder->Push(tick);
      } else if (*topic == io::RecordedTopic::kFrame) {
        simulation::FrameRecord& frame = stream->frame;
        frame.stamp += offset;
        frame.model.pose_stamp += offset;
        frame.model.frame += frame_offset;
        frames = frame.model.frame;
        recorder->PushFrame(frame);
      } else if (*topic == io::RecordedTopic::kEvent) {
        recorder->PushEvent(stream->event.stamp + offset, stream->event.text);
      }
      recorder->Drain();
    }
    if (last <= last_before) return tl::unexpected(from.string() + ": found no tick, accepted at least 1");
    offset = last - first;
    tick_offset = ticks;
    frame_offset = frames;
  }
  if (const auto closed = recorder->Close(); !closed) return tl::unexpected(closed.error());
  return rt::ToSeconds(last - first);
}

// Median and largest value.
nlohmann::json Figures(std::vector<double> seconds) {
  return {{"median_s", base::Median(seconds)}, {"most_s", base::Percentile(seconds, 1.0)}};
}

}  // namespace

int RunBenchView(const BenchViewOptions& options) {
  const base::WorkFolder own("bench_view");
  const std::filesystem::path file =
      (options.folder.empty() ? own.path() : options.folder) / "long_recording.mcap";
  fmt::print("writes {:g} h of recording …\n", options.hours);
  std::fflush(stdout);
  const auto duration_s = WriteRepeated(options.recording, 3600.0 * options.hours, file);
  if (!duration_s) return session::Fail("bench view", duration_s.error());
  const auto bytes = static_cast<double>(std::filesystem::file_size(file));

  const auto begun = ViewClock::now();
  auto timeline = session::RecordingTimeline::Open(file);
  if (!timeline) return session::Fail("bench view", timeline.error(), session::kFailed);
  auto setup = session::SetUpRecorded(timeline->session());
  if (!setup) return session::Fail("bench view", setup.error());
  auto cut = session::ReadRecordedCut(file, timeline->session(), *setup);
  if (!cut) return session::Fail("bench view", cut.error());
  const double start_s = rt::ToSeconds(timeline->start());
  console::LiveFeed feed(session::Playback::kFeedWindows);
  console::SurfaceStore store;
  console::SurfaceFeed chunks(store);
  session::Playback playback(std::move(*timeline), feed);
  const session::RecordingScan scan(file);
  session::ViewSurface bone(file, *setup, std::move(*cut), chunks);
  // Whether the feed's newest tick is near a time.
  const auto shows_tick = [&](double at_s) {
    return std::abs(rt::ToSeconds(feed.Newest().tick.stamp) - start_s - at_s) < kTickNear_s;
  };
  // Whether the page's charts before a time are complete.
  const auto shows_before = [&](double at_s) {
    return shows_tick(at_s) &&
           static_cast<double>(feed.Newest().number) >= kMinWindowsPerSecond * std::min(at_s, kStrip_s);
  };
  const auto shows_bone = [&](double at_s) {
    return bone.shown_s() >= at_s && bone.shown_s() < at_s + kTickNear_s;
  };
  bone.GoTo(1.0);
  playback.Seek(1.0);
  const auto open_s = Await(begun, [&] { return shows_tick(1.0) && shows_bone(1.0); });
  const auto keys_s = Await(begun, [&] { return bone.keys_complete(); });
  if (!open_s || !keys_s) return session::Fail("bench view", "the recording did not open", session::kFailed);

  std::vector<double> tick_s, before_s, bone_s;
  constexpr double kGolden = 0.6180339887;  // golden ratio: spreads the seeks forward and backward
  for (int i = 1; i <= options.seeks; ++i) {
    const double at_s = *duration_s * std::fmod(kGolden * i, 1.0);
    const auto asked = ViewClock::now();
    playback.Seek(at_s);
    bone.GoTo(at_s);
    const auto tick = Await(asked, [&] { return shows_tick(at_s); });
    const auto before = Await(asked, [&] { return shows_before(at_s); });
    const auto carved = Await(asked, [&] { return shows_bone(at_s); });
    if (!tick || !before || !carved)
      return session::Fail("bench view", fmt::format("no picture of {:.1f} s came", at_s), session::kFailed);
    tick_s.push_back(*tick);
    before_s.push_back(*before);
    bone_s.push_back(std::max(*tick, *carved));
  }
  const nlohmann::json json{{"schema", "osteon.bench.view/1"},
                            {"machine", session::MachineName()},
                            {"build", session::BuildName()},
                            {"duration_s", *duration_s},
                            {"bytes", bytes},
                            {"open_s", *open_s},
                            {"keys_s", *keys_s},
                            {"seeks", options.seeks},
                            {"seek_tick", Figures(tick_s)},
                            {"seek_before", Figures(before_s)},
                            {"seek_bone", Figures(bone_s)}};
  fmt::print(
      "recording: {:.0f} s, {:.2f} GB\nopens in {:.2f} s, ticks and bone\nkey states of the bone complete "
      "after {:.1f} s\n",
      *duration_s, 1e-9 * bytes, *open_s, *keys_s);
  for (const auto& [name, figures] : {std::pair("seek, ticks", Figures(tick_s)),
                                      std::pair("seek, half a minute before it as well", Figures(before_s)),
                                      std::pair("seek, bone as well", Figures(bone_s))})
    fmt::print("{}: median {:.2f} s, most {:.2f} s of {}\n", name, figures["median_s"].get<double>(),
               figures["most_s"].get<double>(), options.seeks);
  if (!options.folder.empty()) std::filesystem::remove(file);
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench view", written.error(), session::kFailed);
  return 0;
}

}  // namespace osteon::studies
