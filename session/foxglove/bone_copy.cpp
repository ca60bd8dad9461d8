#include "session/foxglove/bone_copy.h"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/recording/copied_channels.h"
#include "session/foxglove/cell_scene.h"
#include "session/foxglove/live_topics.h"
#include "session/view/carved_keys.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/dual_surface.h"

namespace osteon::session {
namespace {

// The carved bone along a recording, as messages of topic `bone`.
class BoneMessages {
 public:
  BoneMessages(RecordingTimeline timeline, const CellSetup& setup, std::shared_ptr<const RecordedCut> cut)
      : setup_(setup),
        scene_(setup),
        timeline_(std::move(timeline)),
        bone_(surface::FieldOfBone(setup.solid.get(), setup.bone, surface::VoxelFor(setup.config.tool.tool)),
              std::move(cut)) {}

  // Carves the bone by the frames recorded up to a log time. The error names the file, the byte and the
  // reason.
  tl::expected<void, std::string> CarveTo(rt::Nanoseconds stamp) {
    while (!ended_ && bone_.last_tick < stamp) {
      const auto topic = timeline_.Next();
      if (!topic) return tl::make_unexpected(topic.error());
      ended_ = *topic == io::RecordedTopic::kOther;
      if (!ended_) bone_.Take(*topic, timeline_);
    }
    bone_.CarveAll();
    return {};
  }

  // Encodes the bricks that changed since the last call; in the first call, all bricks.
  // @returns false if no brick has changed
  bool Encode(rt::Nanoseconds stamp, std::string& bytes) {
    const auto material = [this](surface::Vec3 p_mm) {
      return setup_.solid ? setup_.solid->MaterialAt(1e-3 * Vector3(p_mm.x, p_mm.y, p_mm.z))
                          : std::uint8_t{0};
    };
    std::vector<io::SceneEntity> parts;
    surface::SurfaceChunk chunk;
    for (const surface::BrickIndex brick : bone_.field.Dirty()) {
      surface::ExtractChunk(bone_.field, brick, chunk, {}, material);
      triangles_ += chunk.quads.size() / 2;  // four indices make a quad, which is two triangles
      parts.push_back(scene_.BonePart(fmt::format("brick_{}", chunk.brick), {&chunk, 1}));
    }
    bone_.field.ClearDirty();
    if (parts.empty()) return false;
    io::EncodeScene(stamp, parts, !std::exchange(begun_, true), bytes);
    return true;
  }
  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }

 private:
  const CellSetup& setup_;
  CellScene scene_;
  RecordingTimeline timeline_;
  CarvedBone bone_;
  bool ended_{false}, begun_{false};  // the end of the recording was reached; the first message was encoded
  std::uint64_t triangles_{0};
};

// Copies the recording's messages, and writes the bone's messages between them.
// @param step  log time from one state of the bone to the next
tl::expected<BoneCopy, std::string> Copy(io::McapReader& reader, io::McapWriter& writer, BoneMessages& bone,
                                         rt::Nanoseconds step) {
  const console::FoxgloveChannel& topic = CellTopics().at(static_cast<std::size_t>(CellTopic::kBone));
  const std::uint16_t bone_channel = writer.AddChannel(topic.topic, topic.schema_name, topic.schema);
  io::CopiedChannels channels(writer);
  io::McapMessage message;
  std::string bytes;
  BoneCopy copy;
  rt::Nanoseconds last{0};   // log time of the newest message
  rt::Nanoseconds next{-1};  // log time from which the next state of the bone is due; -1: none is written yet
  const auto add_bone = [&](rt::Nanoseconds stamp) -> tl::expected<void, std::string> {
    if (auto carved = bone.CarveTo(stamp); !carved) return carved;
    if (!bone.Encode(stamp, bytes)) return {};
    writer.Write(bone_channel, stamp, bytes);
    ++copy.states;
    return {};
  };
  for (;;) {
    const auto more = reader.Next(message);
    if (!more) return tl::make_unexpected(more.error());
    if (!*more) break;
    last = static_cast<rt::Nanoseconds>(message.log_time_ns);
    if (io::TopicOf(*message.channel) == io::RecordedTopic::kTick && last >= next) {
      if (const auto added = add_bone(next < 0 ? 0 : last); !added) return tl::make_unexpected(added.error());
      next = last + step;
    }
    if (message.channel->topic == topic.topic && message.channel->schema_name == topic.schema_name)
      continue;  // leave out the states of the bone that the run recorded: the copy has its own
    const auto channel = channels.IdOf(*message.channel);
    if (!channel) return tl::make_unexpected(reader.path().string() + ": " + channel.error());
    writer.Write(*channel, last, {message.bytes.data(), message.bytes.size()});
    ++copy.messages;
  }
  if (const auto added = add_bone(last); !added) return tl::make_unexpected(added.error());
  copy.triangles = bone.triangles();
  return copy;
}

}  // namespace

tl::expected<BoneCopy, std::string> CopyWithBone(const std::filesystem::path& recording,
                                                 const CellSetup& setup, double step_s,
                                                 const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::equivalent(recording, file, ignored))
    return tl::make_unexpected(file.string() + ": found the recording itself, accepted another file");
  auto reader = io::McapReader::Open(recording);
  if (!reader) return tl::make_unexpected(reader.error());
  auto timeline = RecordingTimeline::Open(recording);
  if (!timeline) return tl::make_unexpected(timeline.error());

  auto cut = ReadRecordedCut(recording, timeline->session(), setup);
  if (!cut) return tl::make_unexpected(cut.error());

  // write to a temporary file beside the final one, and rename it at the end
  const std::filesystem::path part = file.string() + ".part";
  auto writer = io::McapWriter::Create(part, reader->library());
  if (!writer) return tl::make_unexpected(writer.error());
  const auto discard = [&](std::string error) -> tl::unexpected<std::string> {
    std::filesystem::remove(part, ignored);
    return tl::make_unexpected(std::move(error));
  };
  try {
    BoneMessages bone(std::move(*timeline), setup, std::move(*cut));
    auto copy = Copy(*reader, *writer, bone, static_cast<rt::Nanoseconds>(1e9 * step_s));
    if (!copy) return discard(copy.error());
    const auto bytes = writer->Finish();
    if (!bytes) return discard(bytes.error());
    copy->bytes = *bytes;
    copy->file = file;
    std::error_code error;
    std::filesystem::rename(part, file, error);
    if (error) return discard(file.string() + ": cannot write: " + error.message());
    return *copy;
  } catch (const std::invalid_argument& error) {  // the grid is too large for the memory
    return discard(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace osteon::session
