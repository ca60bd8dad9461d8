#pragma once

#include "control/tick_record.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

/// Adds derived topics to a recording. The recorder's writer calls Take… after it has written the message
/// itself. The derived messages depend on the recorded messages alone, so that equal runs give equal bytes.
class RecordTopics {
 public:
  virtual ~RecordTopics() = default;
  /// Adds the channels, and writes the messages that do not change during the session. @param stamp  time at
  /// which the session began
  virtual void Begin(McapWriter& file, rt::Nanoseconds stamp) = 0;
  virtual void TakeTick(const control::TickRecord& tick, McapWriter& file) = 0;
  virtual void TakeFrame(const simulation::FrameRecord& frame, McapWriter& file) = 0;
  virtual void TakeEvent(const RecordedEvent& event, McapWriter& file) = 0;
  /// Called after the last message: writes everything not written yet.
  virtual void End(McapWriter& /*file*/) {}
};

}  // namespace osteon::io
