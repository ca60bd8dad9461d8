#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_record.h"

namespace osteon::session {

/// Cuts a recording's bone again: gives an engine the poses of the recorded frames, in their order. With the
/// run's bone and engine, the result is the run's carved state, bit for bit.
class Recarve {
 public:
  /// @param engine  with the uncut bone; must outlive this object
  /// @param dt_limit_s  as in FrameRunner
  Recarve(simulation::CuttingEngine& engine, control::Law law, double dt_limit_s = 0.1)
      : engine_(&engine), measured_(law == control::Law::kImpedance), dt_limit_s_(dt_limit_s) {}

  /// Keeps the pose of a tick. Call both functions Add in the order of the file.
  void Add(const control::TickRecord& tick);
  /// Steps the engine to the pose that a frame was made for. A frame whose tick is not among the last kKept
  /// is left out and counted.
  void Add(const simulation::FrameRecord& frame);

  /// Keeps a frame until it is due. In a recording of wall time, a frame may come before the tick of its
  /// pose.
  void Wait(const simulation::FrameRecord& frame) { waiting_.push_back(frame); }
  /// Removes and returns the next waiting frame if it is due: its tick was added, or cannot follow any more.
  /// The caller passes the frame to Add.
  /// @param at_end  no further tick follows
  [[nodiscard]] std::optional<simulation::FrameRecord> NextDue(bool at_end = false);
  /// Continues with another engine, which must outlive this object.
  void ReplaceEngine(simulation::CuttingEngine& engine) { engine_ = &engine; }

  [[nodiscard]] std::uint64_t frames() const { return frames_; }      ///< number of frames cut again
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }  ///< number of frames left out

  static constexpr std::size_t kKept = 2048;  ///< number of stored ticks: 2 s at 1 kHz; no frame is that old

 private:
  // The pose and spindle speed of a tick that a frame may have been made for.
  struct Place {
    rt::Nanoseconds stamp{0};
    PlainPose X_WT;
    double spindle_rad_per_s{0.0};
  };

  simulation::CuttingEngine* engine_;
  bool measured_;  // frames follow the measured pose while the arm renders (impedance law)
  double dt_limit_s_;
  std::array<Place, kKept> places_{};  // ring buffer of the last ticks
  std::size_t next_{0};                // index in places_ for the next tick
  rt::Nanoseconds last_stamp_{0};      // stamp of the last frame's pose
  rt::Nanoseconds newest_{0};          // newest stamp in places_
  std::deque<simulation::FrameRecord> waiting_;
  std::uint64_t frames_{0}, left_out_{0};
};

}  // namespace osteon::session
