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

/// How often and how finely the bone is recorded; and the tools and the history of a procedure.
struct RecordedBoneParams {
  rt::Nanoseconds step{5'000'000'000};  ///< log time from one state of the bone to the next; > 0
  bool own_thread{true};  ///< false: Take carves in the caller's thread, so that equal runs give equal bytes
  /// the grid is made coarser until the uncut bone's surface has at most this many quads
  std::size_t max_quads{30'000};
  /// tools of a procedure, by TickInput::tool_index; empty: only the cell's own tool
  std::vector<simulation::Tool> tools{};
  BoneHistory history{};  ///< earlier recordings and undone passes of the procedure's session
};

/// Makes messages of a run's carved bone for the recording: the first has the whole surface, each later one
/// the bricks that have changed. The surface is coarser than the console's, so that it adds little to a
/// recording.
///
///     frame ─▶ BatchedSweep ─▶ batches ─┐ state is due             ┌─▶ Take: message for the file
///                                       └─▶ own thread: carve, mesh ┘
///
/// If a state is due while the previous one is still being made, it is begun later, so the caller never
/// waits. In a procedure's session the batches that touched bone are kept (some 3 MB for an hour of reaming).
/// If a pass is undone, the next state is carved again from the batches of the remaining passes.
class RecordedBone {
 public:
  /// @param scene  must outlive this
  RecordedBone(const CellSetup& setup, const CellScene& scene, RecordedBoneParams params);
  ~RecordedBone();
  RecordedBone(const RecordedBone&) = delete;
  RecordedBone& operator=(const RecordedBone&) = delete;

  /// Continues with another tool of the procedure.
  void UseTool(std::size_t tool);
  /// Adds the path that the tool has travelled in a frame.
  void Add(const simulation::ContactModel& model, bool spindle_turns);
  /// Begins the next state if it is due and no other is being made. @param stamp  log time
  /// @returns the message of a state that has become ready, valid until the next call; null: there is none
  [[nodiscard]] const std::string* Take(rt::Nanoseconds stamp);
  /// Ends the thread and returns the remaining messages, one per call; call it until it returns null. After
  /// the last message the recording has everything that was added.
  [[nodiscard]] const std::string* Finish();

  [[nodiscard]] float voxel_mm() const { return voxel_mm_; }
  /// Call it after Finish has returned null. Returns the reason why states of the bone are missing; empty:
  /// none is missing.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  struct Work {
    surface::SweptBatches batches;  // since the last state
    UndonePasses undone;            // passes that were undone before the state was begun
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
  simulation::Bone balls_;  // the bone's balls; used if there is no solid
  surface::BatchedSweep sweep_;
  std::size_t tool_{0};
  surface::SweptBatches gathered_;       // since the last state
  std::optional<rt::Nanoseconds> next_;  // log time at which the next state is due; nothing: at once
  rt::Nanoseconds last_stamp_{0};
  std::string taken_;

  // members used only by MakeState, which runs in the own thread or, without it or after its end, in the
  // caller's
  std::shared_ptr<const surface::SolidField> solid_field_;
  std::unique_ptr<surface::CarvedField> field_;
  surface::SweptBatches kept_;  // in a procedure's session: all batches that touched bone
  UndonePasses undone_;         // the undone passes, which are not carved in field_
  bool no_field_{false};        // no grid was coarse enough for the bone, or carving has failed
  bool begun_{false};           // the first state, with the whole surface, has been made
  float voxel_mm_{0.0F};
  std::string error_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Work> work_;        // guarded by mutex_
  std::string made_;                // the message that is ready; guarded by mutex_; empty: none
  bool busy_{false}, stop_{false};  // a state is being made; the thread has to end
  std::thread thread_;
};

}  // namespace osteon::session
