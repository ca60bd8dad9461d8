#include "session/foxglove/recorded_topics.h"

#include "session/foxglove/live_topics.h"

namespace osteon::session {

void RecordedTopics::Begin(io::McapWriter& file, rt::Nanoseconds stamp) {
  for (const console::FoxgloveChannel& topic : CellTopics())
    channels_.push_back(
        topic.topic == "bone" ? 0 : file.AddChannel(topic.topic, topic.schema_name, topic.schema));
  io::EncodeScene(stamp, scene_.Bodies(tool_), true, bytes_);
  file.Write(channels_[static_cast<std::size_t>(CellTopic::kScene)], stamp, bytes_);
}

void RecordedTopics::TakeTick(const control::TickRecord& tick, io::McapWriter& file) {
  if (tick.stamp < next_) return;
  if (tick.input.tool_index != tool_) {
    tool_ = tick.input.tool_index;
    io::EncodeScene(tick.stamp, scene_.Tools(tool_), false, bytes_);
    file.Write(channels_[static_cast<std::size_t>(CellTopic::kScene)], tick.stamp, bytes_);
  }
  next_ = tick.stamp + kPeriod_ns;
  const auto write = [&](CellTopic topic) {
    file.Write(channels_[static_cast<std::size_t>(topic)], tick.stamp, bytes_);
  };
  io::EncodeFrames(tick.stamp, scene_.Frames(tick, model_), bytes_);
  write(CellTopic::kFrames);
  io::EncodeScene(tick.stamp, scene_.Forces(tick, model_), true, bytes_);
  write(CellTopic::kForces);
  io::EncodeJoints(tick.stamp, scene_.Joints(tick), bytes_);
  write(CellTopic::kJoints);
}

void RecordedTopics::TakeFrame(const simulation::FrameRecord& frame, io::McapWriter&) {
  model_ = frame.model;
}

void RecordedTopics::TakeEvent(const io::RecordedEvent& event, io::McapWriter& file) {
  io::EncodeLog(event.stamp, LevelOf(event.text), event.text, bytes_);
  file.Write(channels_[static_cast<std::size_t>(CellTopic::kLog)], event.stamp, bytes_);
}

}  // namespace osteon::session
