#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "session/foxglove/cell_scene.h"
#include "session/procedure/bone_history.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/swept_batches.h"

namespace osteon::session {

struct RecordedBoneParams {
  rt::Nanoseconds step{5'000'000'000};  ///< of log time, from one state of the bone to the next; > 0
  bool own_thread{true};                ///< false: the caller carves, so that equal runs give equal bytes
  std::size_t max_quads{30'000};        ///< of the uncut bone: its grid is made coarser until it has no more
  std::vector<simulation::Tool> tools{};  ///< of a procedure, by TickInput::tool_index; empty: the cell's own
  BoneHistory history{};                  ///< of the procedure's session
};

/// The carved bone of a run as messages for its recording: the whole surface first, then at each state the
/// bricks that changed. Coarser than the console's, so that a recording grows little by it.
///
///     frame ─▶ BatchedWays ─▶ batches ─┐ state is due              ┌─▶ Take: message for the file
///                                      └─▶ own thread: carve, mesh ┘
///
/// A state that is due while the one before is still being made comes later: nothing waits for it. In a
/// session the batches that touched bone are kept (some 3 MB for an hour of reaming). When a pass is taken
/// back, the next state is carved anew from those that count.
class RecordedBone {
 public:
  /// @param scene  outlives this
  RecordedBone(const CellSetup& setup, const CellScene& scene, RecordedBoneParams params);
  ~RecordedBone();
  RecordedBone(const RecordedBone&) = delete;
  RecordedBone& operator=(const RecordedBone&) = delete;

  /// Goes on with another tool of the procedure.
  void UseTool(std::size_t tool);
  /// Adds a frame's way.
  void Add(const simulation::ContactModel& model, bool spindle_turns);
  /// Begins the next state where it is due. @param stamp  log time
  /// @returns the message of a state that is made; nothing: none. Valid until the next call.
  [[nodiscard]] const std::string* Take(rt::Nanoseconds stamp);
  /// The last state, of all that was added: waits for it. Nothing: nothing has changed since the last one.
  [[nodiscard]] const std::string* Finish();

  [[nodiscard]] float voxel_mm() const { return voxel_mm_; }
  /// After Finish has returned nothing: why there is no bone from some state on; empty: there is.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  struct Work {
    surface::SweptBatches batches;  // since the last state
    TakenBackPasses taken_back;     // up to now
    rt::Nanoseconds stamp{0};
  };
  [[nodiscard]] Work TakeWork(rt::Nanoseconds stamp);
  void Run();
  void MakeState(const Work& work);
  void MakeField();
  [[nodiscard]] std::shared_ptr<const surface::SolidField> MakeSolidField();
  [[nodiscard]] surface::CarvedField CarveAnew() const;

  const CellScene& scene_;
  RecordedBoneParams params_;
  std::shared_ptr<const simulation::Solid> solid_;
  simulation::Bone balls_;  // where there is no solid
  surface::BatchedWays ways_;
  std::size_t tool_{0};
  surface::SweptBatches gathered_;       // since the last state
  std::optional<rt::Nanoseconds> next_;  // when the next state is due; nothing: at once
  rt::Nanoseconds last_stamp_{0};
  std::string taken_;

  // of who makes states: the own thread, or after it has ended the caller
  std::shared_ptr<const surface::SolidField> solid_field_;
  std::unique_ptr<surface::CarvedField> field_;
  surface::SweptBatches kept_;  // that touched bone, of a session
  TakenBackPasses taken_back_;  // that the field is without
  bool no_field_{false};        // the bone has no surface that a grid holds
  bool begun_{false};
  float voxel_mm_{0.0F};
  std::string error_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Work> work_;  // guarded by mutex_
  std::string made_;          // guarded by mutex_: empty: none
  bool busy_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
