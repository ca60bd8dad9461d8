#include "session/foxglove/recorded_topics.h"

#include "session/foxglove/live_topics.h"

namespace osteon::session {

RecordedTopics::RecordedTopics(const CellSetup& setup, std::span<const ProcedureTool> tools,
                               const std::optional<RecordedBoneParams>& bone)
    : scene_(setup, tools) {
  if (!bone) return;
  RecordedBoneParams params = *bone;
  params.tools = ToolsOf(tools);
  bone_.emplace(setup, scene_, params);
}

void RecordedTopics::Begin(io::McapWriter& file, rt::Nanoseconds stamp) {
  for (const console::FoxgloveChannel& topic : CellTopics())
    channels_.push_back(
        topic.topic == "bone" && !bone_ ? 0 : file.AddChannel(topic.topic, topic.schema_name, topic.schema));
  io::EncodeScene(stamp, scene_.Bodies(tool_), true, bytes_);
  file.Write(channels_[static_cast<std::size_t>(CellTopic::kScene)], stamp, bytes_);
}

void RecordedTopics::TakeTick(const control::TickRecord& tick, io::McapWriter& file) {
  spindle_turns_ = tick.spindle_rad_per_s != 0.0;
  last_stamp_ = tick.stamp;
  if (bone_) bone_->UseTool(tick.input.tool_index);
  if (tick.stamp < next_) return;
  if (tick.input.tool_index != tool_) {  // draw the new tool in place of the last one
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
  if (!bone_) return;
  if (const std::string* state = bone_->Take(tick.stamp))
    file.Write(channels_[static_cast<std::size_t>(CellTopic::kBone)], tick.stamp, *state);
}

void RecordedTopics::TakeFrame(const simulation::FrameRecord& frame, io::McapWriter&) {
  model_ = frame.model;
  if (bone_) bone_->Add(frame.model, spindle_turns_);
}

void RecordedTopics::TakeEvent(const io::RecordedEvent& event, io::McapWriter& file) {
  io::EncodeLog(event.stamp, LevelOf(event.text), event.text, bytes_);
  file.Write(channels_[static_cast<std::size_t>(CellTopic::kLog)], event.stamp, bytes_);
}

void RecordedTopics::End(io::McapWriter& file) {
  if (!bone_) return;
  while (const std::string* state = bone_->Finish())
    file.Write(channels_[static_cast<std::size_t>(CellTopic::kBone)], last_stamp_, *state);
  if (bone_->error().empty()) return;
  io::EncodeLog(last_stamp_, io::LogLevel::kWarning, "the bone is not recorded to the end: " + bone_->error(),
                bytes_);
  file.Write(channels_[static_cast<std::size_t>(CellTopic::kLog)], last_stamp_, bytes_);
}

}  // namespace osteon::session
