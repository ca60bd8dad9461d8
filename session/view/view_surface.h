#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "session/setup/cell_setup.h"
#include "session/view/recording_timeline.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/surface_sink.h"
#include "simulation/surface/tool_ways.h"

namespace osteon::app {

/// Shows the carved bone of a recording at the time that a playback has reached, in a thread of its own.
/// Forward it carves on from where it is; backward it begins anew from the uncut bone.
class ViewSurface {
 public:
  /// @param setup, sink  outlive this; without a solid and without balls nothing is shown
  ViewSurface(const std::filesystem::path& recording, const CellSetup& setup, surface::SurfaceSink& sink);
  ~ViewSurface();
  ViewSurface(const ViewSurface&) = delete;
  ViewSurface& operator=(const ViewSurface&) = delete;

  /// Any thread.
  void GoTo(double at_s) { wanted_s_.store(at_s); }
  /// Time up to which the bone that was shown is carved [s].
  [[nodiscard]] double shown_s() const { return shown_s_.load(); }

 private:
  void Run();
  void Begin();
  bool CarveOn(double wanted_s);
  void Publish();

  const std::filesystem::path recording_;
  const CellSetup& setup_;
  surface::SurfaceSink& sink_;
  std::atomic<double> wanted_s_{0.0}, shown_s_{0.0};
  std::atomic<bool> stop_{false};

  // of the thread
  std::shared_ptr<const surface::SolidField> solid_;
  std::unique_ptr<surface::CarvedField> field_;
  std::unique_ptr<surface::ToolWays> ways_;
  std::unique_ptr<RecordingTimeline> timeline_;
  std::vector<surface::SurfaceChunk> chunks_;
  double carved_s_{0.0};
  bool turns_{false};  // the spindle, in the last tick
  bool ended_{false};

  std::thread thread_;
};

}  // namespace osteon::app
