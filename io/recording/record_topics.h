#pragma once

#include "control/tick_record.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

/// Adds topics of its own to a recording. Called by the recorder's writer, after the message itself is
/// written; what it writes depends on the messages alone, so that equal runs give equal bytes.
class RecordTopics {
 public:
  virtual ~RecordTopics() = default;
  /// Adds the channels, and writes what does not change. @param stamp  of the session's beginning
  virtual void Begin(McapWriter& file, rt::Nanoseconds stamp) = 0;
  virtual void TakeTick(const control::TickRecord& tick, McapWriter& file) = 0;
  virtual void TakeFrame(const simulation::FrameRecord& frame, McapWriter& file) = 0;
  virtual void TakeEvent(const RecordedEvent& event, McapWriter& file) = 0;
  /// Writes what is left, after the last message.
  virtual void End(McapWriter& /*file*/) {}
};

}  // namespace osteon::io
