#include "session/foxglove/live_topics.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "io/recording/messages.h"
#include "simulation/surface/chunk_bytes.h"

namespace osteon::session {
namespace {

// indices of the channels `tick` and `frame`, which follow those of CellTopics
constexpr std::size_t kTick = 6, kFrame = 7;
// bytes of bricks for one message; the encoded message is larger
constexpr std::size_t kBoneBytes = 128u << 10;

}  // namespace

const std::vector<console::FoxgloveChannel>& CellTopics() {
  static const std::vector<console::FoxgloveChannel> topics = [] {
    const std::string schema = io::FoxgloveDescriptorSet();
    return std::vector<console::FoxgloveChannel>{
        {.topic = "tf", .schema_name = "foxglove.FrameTransforms", .schema = schema},
        {.topic = "scene", .schema_name = "foxglove.SceneUpdate", .schema = schema},
        {.topic = "forces", .schema_name = "foxglove.SceneUpdate", .schema = schema},
        {.topic = "joints", .schema_name = "foxglove.JointStates", .schema = schema},
        {.topic = "log", .schema_name = "foxglove.Log", .schema = schema},
        {.topic = "bone", .schema_name = "foxglove.SceneUpdate", .schema = schema}};
  }();
  return topics;
}

io::LogLevel LevelOf(const std::string& event) {
  return event.starts_with("fault") ? io::LogLevel::kError : io::LogLevel::kInfo;
}

LiveTopics::LiveTopics(const CellSetup& setup, const console::LiveFeed& feed,
                       const console::SurfaceStore& surface, std::span<const ProcedureTool> tools)
    : scene_(setup, tools), feed_(feed), surface_(surface), channels_(CellTopics()) {
  const std::string schema = io::RecordingDescriptorSet();
  channels_.push_back({.topic = "tick", .schema_name = "osteon.Tick", .schema = schema});
  channels_.push_back({.topic = "frame", .schema_name = "osteon.Frame", .schema = schema});
}

void LiveTopics::New(std::size_t channel, console::FoxgloveCursor& cursor,
                     std::vector<console::FoxgloveMessage>& out) const {
  if (const std::uint64_t epoch = feed_.epoch(); epoch != cursor.epoch)
    cursor = {.begun = cursor.begun, .epoch = epoch};
  const auto topic = static_cast<CellTopic>(channel);
  if (topic == CellTopic::kBone) return NewBone(cursor, out);
  console::FoxgloveMessage message;
  if (topic == CellTopic::kLog) {
    for (const io::RecordedEvent& event : feed_.EventsSince(cursor.events)) {
      message.stamp = event.stamp;
      io::EncodeLog(event.stamp, LevelOf(event.text), event.text, message.bytes);
      out.push_back(message);
    }
    return;
  }
  const console::LiveWindow window = feed_.Newest();
  if (window.number == 0 || window.number == cursor.window) return;
  cursor.window = window.number;
  const bool first = !std::exchange(cursor.begun, true);
  message.stamp = window.tick.stamp;
  if (topic == CellTopic::kFrames) {
    io::EncodeFrames(message.stamp, scene_.Frames(window.tick, window.frame.model), message.bytes);
  } else if (topic == CellTopic::kScene) {
    const std::size_t tool = window.tick.input.tool_index;
    if (!first && tool == cursor.tool) return;
    cursor.tool = tool;
    io::EncodeScene(message.stamp, first ? scene_.Bodies(tool) : scene_.Tools(tool), first, message.bytes);
  } else if (topic == CellTopic::kForces) {
    io::EncodeScene(message.stamp, scene_.Forces(window.tick, window.frame.model), true, message.bytes);
  } else if (topic == CellTopic::kJoints) {
    io::EncodeJoints(message.stamp, scene_.Joints(window.tick), message.bytes);
  } else if (channel == kTick) {
    io::Encode(window.tick, message.bytes);
  } else if (channel == kFrame) {
    if (window.frame.model.frame == 0) return;
    io::Encode(window.frame, message.bytes);
  }
  out.push_back(std::move(message));
}

void LiveTopics::NewBone(console::FoxgloveCursor& cursor, std::vector<console::FoxgloveMessage>& out) const {
  const rt::Nanoseconds stamp = feed_.Newest().tick.stamp;
  if (!cursor.bone) cursor.bone = std::make_shared<console::SurfaceReader>();
  const console::SurfaceReader::Part part = cursor.bone->Next(surface_, kBoneBytes);
  const bool all = part.layout != nullptr;
  const auto layout = surface_.Layout();
  std::vector<io::SceneEntity> parts;
  std::span<const std::uint8_t> raw(reinterpret_cast<const std::uint8_t*>(part.bricks.data()),
                                    part.bricks.size());
  surface::SurfaceChunk chunk;
  for (auto size = surface::ReadChunk(layout, raw, chunk); size;
       size = surface::ReadChunk(layout, raw, chunk)) {
    parts.push_back(scene_.BonePart(fmt::format("brick_{}", chunk.brick), {&chunk, 1}));
    raw = raw.subspan(*size);
  }
  if (parts.empty() && !all) return;
  console::FoxgloveMessage message{.stamp = stamp, .bytes = {}};
  io::EncodeScene(stamp, parts, all, message.bytes);
  out.push_back(std::move(message));
}

}  // namespace osteon::session
