#pragma once

#include "control/tick_record.h"
#include "io/recording/messages.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

/// Takes the messages of a session beside the file: a view that is live. Called by the recorder's writer, in
/// the file's order, so an implementation returns at once: it keeps the newest and never waits for a reader.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  virtual void TakeTick(const control::TickRecord& tick) = 0;
  virtual void TakeFrame(const simulation::FrameRecord& frame) = 0;
  virtual void TakeEvent(const RecordedEvent& event) = 0;
};

}  // namespace osteon::io
