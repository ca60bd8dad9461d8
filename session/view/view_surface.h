#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "console/server/surface_feed.h"
#include "session/setup/cell_setup.h"
#include "session/view/bone_difference.h"
#include "session/view/carved_keys.h"
#include "session/view/recording_timeline.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/tissue_bricks.h"
#include "simulation/surface/tool_sweep.h"

namespace osteon::session {

/// Shows the carved bone of a recording at the time that a playback has reached, in a thread of its own. To
/// reach the time, it carves on from the bone that is shown, or from the last key state (CarvedKeys) before
/// that time, whichever is nearer.
class ViewSurface {
 public:
  /// @param setup, feed  must outlive this object; if setup has neither solid nor balls, nothing is shown
  /// @param cut  the cut of the recording; not null
  /// @param map  map of the difference to another recording's bone; null: there is no other recording
  ViewSurface(const std::filesystem::path& recording, const CellSetup& setup,
              std::shared_ptr<const RecordedCut> cut, console::SurfaceFeed& feed,
              std::unique_ptr<DifferenceMap> map = nullptr);
  ~ViewSurface();
  ViewSurface(const ViewSurface&) = delete;
  ViewSurface& operator=(const ViewSurface&) = delete;

  /// Sets the time to show [s]. Any thread.
  void GoTo(double at_s) { wanted_s_.store(at_s); }
  /// Whether the key states of the whole recording are ready, so that any time is reached quickly.
  [[nodiscard]] bool keys_complete() const { return keys_complete_.load(); }
  /// Time up to which the bone shown is carved [s].
  [[nodiscard]] double shown_s() const { return shown_s_.load(); }

 private:
  void Run();
  void Begin(const CarvedBone& from);  // shows this state, and reads on from its time
  void GoNear(double wanted_s);        // jumps to a key state if that is nearer
  bool CarveOn(double wanted_s);       // reads on to a time; true: more is to be read
  void BeginFeed();                    // tells the feed that all bricks will be sent anew
  void Publish();                      // sends the bricks that have changed

  const std::filesystem::path recording_;
  const CellSetup& setup_;
  const std::shared_ptr<const RecordedCut> cut_;
  console::SurfaceFeed& feed_;
  std::atomic<double> wanted_s_{0.0}, shown_s_{0.0};
  std::atomic<bool> stop_{false}, keys_complete_{false};

  // used only by the thread
  std::shared_ptr<const surface::SolidField> solid_;
  std::optional<surface::TissueBricks> tissue_;
  std::optional<CarvedBone> begin_, bone_;  // bone at the recording's beginning; bone that is shown
  std::unique_ptr<RecordingTimeline> timeline_;
  std::unique_ptr<DifferenceMap> map_;
  std::vector<surface::SurfaceChunk> chunks_;
  bool ended_{false};  // the recording has no more messages

  std::unique_ptr<CarvedKeys> keys_;
  std::thread thread_;
};

}  // namespace osteon::session
