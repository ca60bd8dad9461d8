#include "session/view/view.h"

#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/write_text.h"
#include "console/server/surface_feed.h"
#include "session/process/exit_code.h"
#include "session/run/console_scene.h"
#include "session/view/playback.h"
#include "session/view/recording_scan.h"
#include "session/view/view_surface.h"

namespace osteon::app {
namespace {

constexpr std::chrono::milliseconds kLooksForEnd{50};

std::string StateJson(const PlaybackState& state) {
  return nlohmann::json{{"type", "playback"},       {"at_s", state.at_s},   {"duration_s", state.duration_s},
                        {"playing", state.playing}, {"speed", state.speed}, {"error", state.error}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

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
  }
}

}  // namespace

int RunView(const ViewOptions& options) {
  auto timeline = RecordingTimeline::Open(options.recording);
  if (!timeline) return Fail("view", timeline.error());
  auto setup = SetUpRecorded(timeline->session());
  if (!setup) return Fail("view", options.recording.string() + ": " + setup.error());
  if (!setup->bone_warning.empty()) fmt::print(stderr, "osteon view: warning: {}\n", setup->bone_warning);
  const double duration_s = timeline->duration_s();

  console::LiveFeed feed;
  console::SurfaceStore surface;
  Playback playback(std::move(*timeline), feed);
  RecordingScan scan(options.recording);
  console::SurfaceFeed chunks(surface);
  ViewSurface bone(options.recording, *setup, chunks);
  const auto server = console::ConsoleServer::Start(
      {.address = options.console.address,
       .port = options.console.port,
       .only_this_port = options.console.only_this_port,
       .page = ConsolePageFolder(),
       .hello = ConsoleScene(*setup, "view", duration_s, options.recording.filename().string()),
       .context = LiveContextOf(*setup),
       .request = {},
       .view = [&](const console::ViewRequest& request) { Move(playback, request); },
       .notes = {[&] { return StateJson(playback.state()); }, [&] { return scan.Json(); }}},
      feed, surface);
  if (!server) return Fail("view", server.error(), kFailed);
  fmt::print("{}\n", (*server)->url());
  std::fflush(stdout);
  if (!options.json.empty()) {
    const nlohmann::json json{{"schema", "osteon.view/1"},
                              {"url", (*server)->url()},
                              {"recording", options.recording.string()},
                              {"duration_s", duration_s}};
    if (const auto written = WriteText(options.json, JsonText(json)); !written)
      return Fail("view", written.error(), kFailed);
  }
  InstallInterrupt();
  while (!Interrupted().load()) {
    std::this_thread::sleep_for(kLooksForEnd);
    bone.GoTo(playback.state().at_s);
  }
  return 0;
}

}  // namespace osteon::app
