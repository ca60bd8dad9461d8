#include "session/replay/recorded_surface.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/recording/recording_reader.h"
#include "report/bone_view.h"
#include "session/procedure/session_cut.h"
#include "session/setup/recorded_config.h"
#include "session/summary/chart_files.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/tool_sweep.h"

namespace osteon::session {
namespace {

/// The times at which the spindle began or ceased to turn. They are gathered before the frames are read,
/// since a frame may come before the tick of its pose in the file.
class SpindleTimes {
 public:
  void Add(const control::TickRecord& tick) {
    const bool turns = tick.spindle_rad_per_s != 0.0;
    if (changes_.empty() || changes_.back().second != turns) changes_.emplace_back(tick.stamp, turns);
  }
  /// Whether the spindle turned at a time; false before the first tick.
  [[nodiscard]] bool TurnsAt(rt::Nanoseconds stamp) const {
    const auto after =
        std::upper_bound(changes_.begin(), changes_.end(), stamp,
                         [](rt::Nanoseconds value, const auto& change) { return value < change.first; });
    return after != changes_.begin() && std::prev(after)->second;
  }

 private:
  std::vector<std::pair<rt::Nanoseconds, bool>> changes_;  // time, and whether it turned from then on
};

/// Calls visit(stream) for each message of a topic. @returns the recording's session information
template <class Visit>
tl::expected<io::SessionInfo, std::string> EachMessage(const std::filesystem::path& recording,
                                                       io::RecordedTopic wanted, const Visit& visit) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::make_unexpected(stream.error());
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::make_unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) return stream->session;
    if (*topic == wanted) visit(*stream);
  }
}

}  // namespace

namespace {

// Writes a field's surface as a mesh. @returns `written`, completed by the mesh's figures
tl::expected<WrittenSurface, std::string> WriteField(const std::filesystem::path& file,
                                                     const surface::CarvedField& field, double drop_below_mm3,
                                                     WrittenSurface written) {
  const auto figures = surface::WriteSurface(file, field, drop_below_mm3);
  if (!figures) return tl::make_unexpected(figures.error().Text());
  written.figures = *figures;
  return written;
}

// Reads the paths along which a session's tools have cut, but this recording's frames only up to at_s. Sets
// written.time_s to the time of the last frame that is included.
tl::expected<SessionCut, std::string> ReadSessionCutUpTo(const std::filesystem::path& recording,
                                                         const SessionFile& session, const CellSetup& setup,
                                                         std::optional<double> at_s,
                                                         WrittenSurface& written) {
  auto info = EachMessage(recording, io::RecordedTopic::kEvent, [](const io::RecordingStream&) {});
  if (!info) return tl::make_unexpected(info.error());
  const auto cell = LoadRecordedTools(info->config);
  if (!cell) return tl::make_unexpected(recording.string() + ": " + cell.error());
  const std::string own = recording.filename().string();
  return ReadSessionCut(recording.parent_path(), session, ToolsOf(cell->tools), setup.X_WG,
                        [&](const std::string& name, const simulation::FrameRecord& frame) {
                          if (name != own) return true;
                          const double time_s = rt::ToSeconds(frame.stamp - info->stamp);
                          if (at_s && time_s > *at_s) return false;
                          written.time_s = std::max(written.time_s, time_s);
                          return true;
                        });
}

}  // namespace

tl::expected<WrittenSurface, std::string> WriteRecordedSurface(const std::filesystem::path& recording,
                                                               const CellSetup& setup,
                                                               std::optional<double> at_s,
                                                               const std::filesystem::path& file,
                                                               double drop_below_mm3) {
  SpindleTimes spindle;
  const auto session = EachMessage(recording, io::RecordedTopic::kTick,
                                   [&](const io::RecordingStream& stream) { spindle.Add(stream.tick); });
  if (!session) return tl::make_unexpected(session.error());
  const simulation::Tool& tool = setup.config.tool.tool;
  WrittenSurface written{.file = file,
                         .voxel_mm = static_cast<double>(surface::VoxelFor(tool)),
                         .from_balls = setup.solid == nullptr};
  std::optional<SessionCut> cut;
  if (const auto found = FindSessionOf(recording)) {
    auto read = ReadSessionCutUpTo(recording, SessionUpTo(*found, recording.filename().string()), setup, at_s,
                                   written);
    if (!read) return tl::make_unexpected(read.error());
    cut = std::move(*read);
  }
  try {
    surface::CarvedField field(
        surface::FieldOfBone(setup.solid.get(), setup.bone, static_cast<float>(written.voxel_mm)));
    if (cut) {
      report::CarveAlong(field, cut->paths());
      return WriteField(file, field, drop_below_mm3, std::move(written));
    }
    surface::ToolSweep sweep(tool, setup.X_WG);
    const auto carved =
        EachMessage(recording, io::RecordedTopic::kFrame, [&](const io::RecordingStream& stream) {
          const simulation::FrameRecord& frame = stream.frame;
          const double time_s = rt::ToSeconds(frame.stamp - session->stamp);
          if (at_s && time_s > *at_s) return;
          written.time_s = std::max(written.time_s, time_s);
          const double turning = spindle.TurnsAt(frame.model.pose_stamp) ? 1.0 : 0.0;
          if (sweep.Add(surface::MakeToolFrame(frame.model, turning))) field.Carve(sweep.TakeCapsules());
        });
    if (!carved) return tl::make_unexpected(carved.error());
    field.Carve(sweep.TakeCapsules());
    return WriteField(file, field, drop_below_mm3, std::move(written));
  } catch (const std::invalid_argument& error) {  // the grid is too large for the memory
    return tl::make_unexpected(fmt::format("{}: {}", file.string(), error.what()));
  }
}

tl::expected<CellSetup, std::string> PrepareRecordedCell(const io::SessionInfo& session,
                                                         const std::optional<MeshChoice>& mesh) {
  auto setup = SetUpRecorded(session, mesh);
  if (!setup || setup->solid || !setup->bone.balls.empty()) return setup;
  std::error_code ignored;
  const auto& file = setup->config.bone;
  if (!mesh && file && !std::filesystem::exists(file->file, ignored))
    return tl::make_unexpected(fmt::format(
        "the bone is of {}, which is not in the recording: found no --mesh, accepted with that file",
        file->file.filename().string()));
  return tl::make_unexpected(setup->bone_warning +
                             (mesh ? "" : "; a bone of --mesh: accepted with --mesh and --cup"));
}

std::string ValidateSurfaceFile(const std::filesystem::path& file) {
  if (file.empty()) return "";
  if (const std::string wrong = surface::ValidateSurfaceName(file); !wrong.empty())
    return "--surface: " + wrong;
  return ValidateOutputFile("--surface", file);
}

nlohmann::ordered_json SurfaceJson(const WrittenSurface& surface) {
  return {{"file", surface.file.string()},
          {"triangles", surface.figures.triangles},
          {"volume_mm3", surface.figures.volume_mm3},
          {"watertight", surface.figures.watertight},
          {"voxel_mm", surface.voxel_mm},
          {"time_s", surface.time_s},
          {"from_balls", surface.from_balls},
          {"pieces", surface.figures.pieces.pieces},
          {"dropped_pieces", surface.figures.pieces.dropped},
          {"dropped_mm3", surface.figures.pieces.dropped_mm3}};
}

std::string SurfaceText(const WrittenSurface& surface) {
  const surface::PieceFigures& pieces = surface.figures.pieces;
  std::string loose;
  if (pieces.dropped > 0)
    loose = fmt::format("; {} of {} pieces dropped, {:.2f} mm³", pieces.dropped, pieces.pieces,
                        pieces.dropped_mm3);
  else if (pieces.pieces > 1)
    loose = fmt::format(", in {} pieces", pieces.pieces);
  return fmt::format("{}: {} triangles, {:.0f} mm³{}{}{}", surface.file.string(), surface.figures.triangles,
                     surface.figures.volume_mm3,
                     surface.figures.watertight ? ", watertight" : ", not watertight", loose,
                     surface.from_balls ? "; of the packing's balls, since its solid is not known" : "");
}

}  // namespace osteon::session
