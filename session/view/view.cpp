#include "session/view/view.h"

#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/write_text.h"
#include "console/server/surface_feed.h"
#include "session/process/exit_code.h"
#include "session/run/console_scene.h"
#include "session/view/bone_difference.h"
#include "session/view/playback.h"
#include "session/view/recorded_cut.h"
#include "session/view/recorded_procedure.h"
#include "session/view/recording_difference.h"
#include "session/view/recording_scan.h"
#include "session/view/view_surface.h"

namespace osteon::session {
namespace {

constexpr std::chrono::milliseconds kEndPeriod{50};  // time between two checks for Ctrl-C
constexpr int kChecksPerAlign = 20;     // after this many checks, the times of two playbacks are aligned
constexpr double kApartPlaying_s{0.1};  // a smaller time difference of two playbacks is not visible
constexpr double kApartFar_s{1.0};      // a larger time difference is removed by a Seek, with a break

// Makes the message with the playback's state for the page. @param start  log stamp at which the time line is
// 0
std::string StateJson(const PlaybackState& state, rt::Nanoseconds start) {
  return nlohmann::json{{"type", "playback"},
                        {"at_s", state.at_s},
                        {"duration_s", state.duration_s},
                        {"start_s", rt::ToSeconds(start)},
                        {"playing", state.playing},
                        {"speed", state.speed},
                        {"error", state.error}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Passes a page's request on to a playback.
void Move(Playback& playback, const console::ViewRequest& request) {
  using Kind = console::ViewRequest::Kind;
  switch (request.kind) {
    case Kind::kPlay:
      return playback.Play();
    case Kind::kHalt:
      return playback.Halt();
    case Kind::kSeek:
      return playback.Seek(request.value);
    case Kind::kSpeed:
      return playback.SetSpeed(request.value);
    case Kind::kMap:  // the request concerns both bones, not a playback
      return;
  }
}

// One recording, with all that is needed to show it.
struct ShownRecording {
  std::filesystem::path file;
  double duration_s;
  rt::Nanoseconds start;
  CellSetup setup;
  console::LiveFeed feed{Playback::kFeedWindows};  // ticks, frames and events up to the shown time
  console::SurfaceStore surface{};                 // the carved bone's surface at the shown time
  Playback playback;
  console::SurfaceFeed chunks;
  ViewSurface bone;
  std::shared_ptr<const RecordedCut> cut;
  std::unique_ptr<RecordedProcedure> procedure;  // null: no procedure is shown

  ShownRecording(std::filesystem::path path, RecordingTimeline timeline, CellSetup cell,
                 std::shared_ptr<const RecordedCut> recorded_cut, std::unique_ptr<RecordedProcedure> plan,
                 std::unique_ptr<DifferenceMap> map)
      : file(std::move(path)),
        duration_s(timeline.duration_s()),
        start(timeline.start()),
        setup(std::move(cell)),
        playback(std::move(timeline), feed),
        chunks(surface),
        bone(file, setup, recorded_cut, chunks, std::move(map)),
        cut(std::move(recorded_cut)),
        procedure(std::move(plan)) {}

  /// Makes the page's first message. @param length_s  length of the page's time line
  [[nodiscard]] std::string Hello(double length_s, const std::string& name) const {
    return ConsoleScene(setup, "view", length_s, name, cut->tools);
  }
};

// Returns a file's name, preceded by the name of its folder if the other file has the same name.
std::string NameBeside(const std::filesystem::path& file, const std::filesystem::path& other) {
  if (file.filename() != other.filename()) return file.filename().string();
  const std::filesystem::path whole = std::filesystem::absolute(file);
  return (whole.parent_path().filename() / whole.filename()).string();
}

// Opens a recording to show it. @param map  map of the difference to another recording; null: it is shown
// alone
tl::expected<std::unique_ptr<ShownRecording>, std::string> OpenShown(const std::filesystem::path& file,
                                                                     std::unique_ptr<DifferenceMap> map) {
  auto timeline = RecordingTimeline::Open(file);
  if (!timeline) return tl::unexpected(timeline.error());
  auto setup = SetUpRecorded(timeline->session());
  if (!setup) return tl::unexpected(file.string() + ": " + setup.error());
  if (!setup->bone_warning.empty()) fmt::print(stderr, "osteon view: warning: {}\n", setup->bone_warning);
  auto cut = ReadRecordedCut(file, timeline->session(), *setup);
  if (!cut) return tl::unexpected(cut.error());
  // two recordings are shown without their plans
  auto procedure = map ? nullptr : RecordedProcedure::Open(file, timeline->session(), setup->X_WG);
  return std::make_unique<ShownRecording>(file, std::move(*timeline), std::move(*setup), std::move(*cut),
                                          std::move(procedure), std::move(map));
}

// Aligns the other playback's time with the first one's. This is needed because each playback keeps its own
// time and does not catch up after a stall.
void BringTogether(const Playback& first, Playback& other) {
  const PlaybackState leader = first.state(), follower = other.state();
  const double wanted_s = std::min(leader.at_s, follower.duration_s);
  const double apart_s = std::abs(follower.at_s - wanted_s);
  if (apart_s > kApartFar_s)
    other.Seek(wanted_s);
  else if (apart_s > kApartPlaying_s)
    other.Align(wanted_s);
}

}  // namespace

int RunView(const ViewOptions& options) {
  // the page's time line is as long as the longest recording
  const bool two = options.recordings.size() == 2;
  BoneDifference bones;
  std::vector<std::unique_ptr<ShownRecording>> shown;
  for (const std::filesystem::path& file : options.recordings) {
    auto opened = OpenShown(file, two ? std::make_unique<DifferenceMap>(bones, shown.size()) : nullptr);
    if (!opened) return Fail("view", opened.error());
    shown.push_back(std::move(*opened));
  }
  ShownRecording& first = *shown.front();
  ShownRecording& longest = two && shown[1]->duration_s > first.duration_s ? *shown[1] : first;
  const double duration_s = longest.duration_s;

  RecordingScan scan(longest.file);
  // the state of the longer recording's playback, with the error of either recording
  const auto state = [&] {
    PlaybackState page_state = longest.playback.state();
    for (const auto& each : shown)  // look at both: either recording may be damaged
      if (page_state.error.empty()) page_state.error = each->playback.state().error;
    return page_state;
  };
  std::vector<std::function<std::string()>> notes{[&] { return StateJson(state(), longest.start); },
                                                  [&] { return scan.Json(); }};
  std::optional<RecordingDifference> difference;
  std::optional<console::ConsoleStream> second;
  if (first.procedure) {
    notes.emplace_back([&] { return first.procedure->PlanJson(); });
    notes.emplace_back([&] { return first.procedure->Json(first.playback.state().at_s); });
  }
  if (two) {
    difference.emplace(std::array{first.file, shown[1]->file});
    notes.emplace_back([&] { return difference->Json(); });
    notes.emplace_back([&] { return bones.Json(); });
    second.emplace(
        console::ConsoleStream{.hello = shown[1]->Hello(duration_s, NameBeside(shown[1]->file, first.file)),
                               .context = LiveContextOf(shown[1]->setup),
                               .feed = shown[1]->feed,
                               .surface = shown[1]->surface});
  }
  const auto server = console::ConsoleServer::Start(
      {.address = options.console.address,
       .port = options.console.port,
       .only_this_port = options.console.only_this_port,
       .page = ConsolePageFolder(),
       .hello = first.Hello(duration_s,
                            two ? NameBeside(first.file, shown[1]->file) : first.file.filename().string()),
       .context = LiveContextOf(first.setup),
       .request = {},
       .view =
           [&](const console::ViewRequest& request) {
             if (request.kind == console::ViewRequest::Kind::kMap) return bones.Show(request.value != 0.0);
             for (const auto& each : shown) Move(each->playback, request);
             if (!two || request.kind != console::ViewRequest::Kind::kHalt) return;
             const double halted_s = longest.playback.state().at_s;  // show the same time after a halt
             for (const auto& each : shown) each->playback.Seek(halted_s);
           },
       .notes = notes,
       .second = second},
      first.feed, first.surface);
  if (!server) return Fail("view", server.error(), kFailed);
  for (const auto& each : shown) each->playback.Seek(options.at_s);
  const std::string url = (*server)->url() + (two ? "compare.html" : "");
  fmt::print("{}\n", url);
  std::fflush(stdout);
  if (!options.json.empty()) {
    nlohmann::json json{{"schema", "osteon.view/1"},
                        {"url", url},
                        {"recording", first.file.string()},
                        {"duration_s", duration_s}};
    if (two) json["second"] = shown[1]->file.string();
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return Fail("view", written.error(), kFailed);
  }
  base::InstallInterrupt();
  for (int check = 1; !base::Interrupted().load(); ++check) {
    std::this_thread::sleep_for(kEndPeriod);
    for (const auto& each : shown) {
      if (check % kChecksPerAlign == 0 && each->playback.state().playing)
        BringTogether(longest.playback, each->playback);
      each->bone.GoTo(each->playback.state().at_s);
    }
  }
  return 0;
}

}  // namespace osteon::session
