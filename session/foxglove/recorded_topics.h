#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/recording/record_topics.h"
#include "session/foxglove/cell_scene.h"
#include "session/foxglove/recorded_bone.h"
#include "simulation/engine/frame_record.h"

namespace osteon::session {

/// Adds the topics of CellTopics to a recording: the bodies once; the tool again whenever another tool comes
/// into use; events when they occur; the bone's states at the interval of RecordedBoneParams; everything else
/// every kPeriod_ns of log time.
class RecordedTopics final : public io::RecordTopics {
 public:
  static constexpr rt::Nanoseconds kPeriod_ns = 33'000'000;

  /// @param tools  as for CellScene
  /// @param bone   how the bone is recorded, with `tools` as its tools; absent: the bone is left out
  explicit RecordedTopics(const CellSetup& setup, std::span<const ProcedureTool> tools = {},
                          const std::optional<RecordedBoneParams>& bone = {});
  void Begin(io::McapWriter& file, rt::Nanoseconds stamp) override;
  void TakeTick(const control::TickRecord& tick, io::McapWriter& file) override;
  void TakeFrame(const simulation::FrameRecord& frame, io::McapWriter& file) override;
  void TakeEvent(const io::RecordedEvent& event, io::McapWriter& file) override;
  void End(io::McapWriter& file) override;

 private:
  CellScene scene_;
  // channel numbers in the order of CellTopics; 0: the topic is not recorded
  std::vector<std::uint16_t> channels_;
  simulation::ContactModel model_;  // model of the newest frame
  rt::Nanoseconds next_{0};         // log time from which the next periodic messages are due
  std::size_t tool_{0};             // the tool that was drawn last
  std::string bytes_;               // buffer for one message
  std::optional<RecordedBone> bone_;
  bool spindle_turns_{false};      // whether the spindle turned in the last tick
  rt::Nanoseconds last_stamp_{0};  // log time of the last tick
};

}  // namespace osteon::session
