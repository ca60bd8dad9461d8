#pragma once

#include "control/tick_record.h"
#include "io/recording/messages.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

/// Receives a session's messages in addition to the file, for a live view. The recorder's writer calls it, in
/// the file's order, so an implementation must return at once. It keeps only the newest messages and never
/// waits for a viewer.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  // Each function is called once for each message of its kind, after the message was written to the file.
  virtual void TakeTick(const control::TickRecord& tick) = 0;
  virtual void TakeFrame(const simulation::FrameRecord& frame) = 0;
  virtual void TakeEvent(const RecordedEvent& event) = 0;
};

}  // namespace osteon::io
