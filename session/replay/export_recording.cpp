#include "session/replay/export_recording.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/write_text.h"
#include "io/recording/recording_reader.h"
#include "io/recording/recovery.h"
#include "session/foxglove/bone_copy.h"
#include "session/procedure/session_cut.h"
#include "session/process/exit_code.h"
#include "session/replay/export_tables.h"
#include "session/replay/recorded_surface.h"
#include "session/summary/chart_files.h"

namespace osteon::session {
namespace {

// Shows a progress bar if the output is a terminal; in a file it would add many lines.
void ShowProgress(double share) {
  constexpr int kWidth = 40;  // width of the bar in characters
  static const bool is_terminal = isatty(STDERR_FILENO) != 0;
  if (!is_terminal) return;
  fmt::print(stderr, "\r[{:{}}] {:3.0f} %", std::string(static_cast<std::size_t>(share * kWidth), '#'),
             kWidth, 100.0 * share);
  if (share >= 1.0) fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
}

// Prints what a recovery has kept, lost and found damaged. @param file  the recovered recording
void PrintRecovery(const io::Recovery& recovery, const std::filesystem::path& file) {
  if (recovery.was_whole) {
    fmt::print("  {:<12} the recording is whole: nothing to recover\n", "Recovered");
    return;
  }
  fmt::print("  {:<12} {}: {} messages, ticks from {:.3f} s to {:.3f} s\n", "Recovered", file.string(),
             recovery.messages, recovery.first_s, recovery.last_s);
  fmt::print("  {:<12} {} bytes {}; {} ticks missing in between\n", "Lost", recovery.tail_bytes,
             recovery.closed ? "behind the recording's end" : "of a message that was cut off",
             recovery.missing_ticks);
  if (recovery.unchecked > 0)
    fmt::print("  {:<12} {} messages of the chunk that was being written: complete, but no CRC covers them\n",
               "Unchecked", recovery.unchecked);
  for (const io::McapDamage& damage : recovery.damage)
    fmt::print("  {:<12} byte {}: {}; {} bytes passed over\n", "Damaged", damage.offset, damage.reason,
               damage.bytes);
}

nlohmann::ordered_json ToJson(const io::Recovery& recovery) {
  nlohmann::ordered_json json{{"messages", recovery.messages},
                              {"unchecked_messages", recovery.unchecked},
                              {"missing_ticks", recovery.missing_ticks},
                              {"cut_off_bytes", recovery.tail_bytes},
                              {"damage", nlohmann::ordered_json::array()}};
  for (const io::McapDamage& damage : recovery.damage)
    json["damage"].push_back({{"byte", damage.offset}, {"bytes", damage.bytes}, {"reason", damage.reason}});
  return json;
}

// Checks the output paths before anything is done. @returns what is wrong; empty: nothing
std::string WrongPlace(const ExportOptions& options, const std::filesystem::path& folder) {
  if (std::string wrong = ValidateOutputFolder("--out", folder); !wrong.empty()) return wrong;
  if (std::string wrong = ValidateSurfaceFile(options.surface); !wrong.empty()) return wrong;
  if (!options.foxglove.empty()) {
    if (options.foxglove.extension() != ".mcap")
      return fmt::format("--foxglove: found {}, accepted a name that ends with .mcap",
                         options.foxglove.string());
    if (std::string wrong = ValidateOutputFile("--foxglove", options.foxglove); !wrong.empty()) return wrong;
  }
  return ValidateParentFolder("--json", options.json);
}

// Makes the cell of the recording, with its bone.
tl::expected<CellSetup, std::string> CellOf(const ExportOptions& options,
                                            const std::filesystem::path& source) {
  auto stream = io::RecordingStream::Open(source);
  if (!stream) return tl::make_unexpected(stream.error());
  if (const auto first = stream->Next(); !first) return tl::make_unexpected(first.error());
  auto setup = PrepareRecordedCell(stream->session, options.mesh);
  if (!setup) return tl::make_unexpected(source.string() + ": " + setup.error());
  return setup;
}

// The files made of the carved bone.
struct BoneFiles {
  std::optional<WrittenSurface> surface;
  std::optional<BoneCopy> copy;
};
// Writes the files of the carved bone that the options ask for. @param source  the complete recording
tl::expected<BoneFiles, std::string> WriteBone(const ExportOptions& options,
                                               const std::filesystem::path& source) {
  BoneFiles files;
  if (options.surface.empty() && options.foxglove.empty()) return files;
  const auto setup = CellOf(options, source);
  if (!setup) return tl::make_unexpected(setup.error());
  if (!options.surface.empty()) {
    auto written =
        WriteRecordedSurface(source, *setup, options.at_s, options.surface, options.drop_below_mm3);
    if (!written) return tl::make_unexpected(written.error());
    files.surface = std::move(*written);
  }
  if (!options.foxglove.empty()) {
    auto written = CopyWithBone(source, *setup, options.every_s, options.foxglove);
    if (!written) return tl::make_unexpected(written.error());
    files.copy = std::move(*written);
  }
  return files;
}

// Writes the passes of the recording's session, as one more table.
tl::expected<std::filesystem::path, std::string> WritePassesOf(const ExportOptions& options,
                                                               const std::filesystem::path& source,
                                                               const SessionFile& session,
                                                               const std::filesystem::path& folder) {
  auto stream = io::RecordingStream::Open(source);
  if (!stream) return tl::make_unexpected(stream.error());
  if (const auto first = stream->Next(); !first) return tl::make_unexpected(first.error());
  return WritePassTable(session, options.recording, stream->session.stamp, folder);
}

nlohmann::ordered_json ToJson(const BoneCopy& copy) {
  return {{"file", copy.file.string()},
          {"messages", copy.messages},
          {"bone_states", copy.states},
          {"triangles", copy.triangles},
          {"bytes", copy.bytes}};
}

}  // namespace

int RunExport(const ExportOptions& options) {
  const bool csv = options.csv || (!options.recover && options.surface.empty() && options.foxglove.empty());
  std::filesystem::path folder = options.out.empty() ? options.recording.parent_path() : options.out;
  if (folder.empty()) folder = ".";
  if (const std::string wrong = WrongPlace(options, folder); !wrong.empty()) return Fail("export", wrong);
  // do the checks that may refuse first, so that a wrong file leaves no folder behind
  if (const auto file = io::McapReader::Open(options.recording); !file) return Fail("export", file.error());
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Fail("export", folder.string() + ": cannot make the folder: " + error.message());
  const std::string stem = options.recording.stem().string();
  nlohmann::ordered_json json{{"schema", "osteon.export/1"}, {"recording", options.recording.string()}};

  // rebuild the complete recording first; everything else then comes from it
  std::filesystem::path source = options.recording;
  std::optional<io::Recovery> recovery;
  if (options.recover) {
    const std::filesystem::path whole = folder / (stem + "_recovered.mcap");
    auto recovered = io::RecoverRecording(options.recording, whole);
    if (!recovered) return Fail("export", recovered.error());
    recovery = std::move(*recovered);
    if (!recovery->was_whole) source = whole;
  }
  const bool recovered = recovery && !recovery->was_whole;

  std::optional<ExportedTables> tables;
  if (csv) {
    auto written = ExportTables(source, folder, stem, ShowProgress);
    ShowProgress(1.0);
    if (!written) {
      const bool of_the_recording = written.error().starts_with(source.string() + ": byte");
      return Fail(
          "export",
          written.error() + (of_the_recording ? "; `osteon export --recover` keeps what is sound" : ""),
          of_the_recording ? kBadInput : kFailed);
    }
    tables = std::move(*written);
    if (const auto session = FindSessionOf(options.recording)) {
      auto passes = WritePassesOf(options, source, *session, folder);
      if (!passes) return Fail("export", passes.error(), kFailed);
      tables->files.push_back(std::move(*passes));
    }
  }

  const auto bone = WriteBone(options, source);
  if (!bone) return Fail("export", bone.error());

  // print the results
  if (tables || recovery) {
    json["ticks"] = tables ? tables->ticks : recovery->ticks;
    json["frames"] = tables ? tables->frames : recovery->frames;
    json["events"] = tables ? tables->events : recovery->events;
    json["complete"] = recovery ? recovery->was_whole : tables->complete;
  }
  json["recovered"] = recovered;
  json["recovered_file"] = recovered ? nlohmann::ordered_json(source.string()) : nlohmann::ordered_json();
  if (recovery) json["recovery"] = ToJson(*recovery);
  json["tables"] = nlohmann::ordered_json::array();
  if (bone->surface) json["surface"] = SurfaceJson(*bone->surface);
  if (bone->copy) json["foxglove"] = ToJson(*bone->copy);
  fmt::print("Osteon export: {}\n", options.recording.string());
  if (recovery) PrintRecovery(*recovery, source);
  if (bone->surface)
    fmt::print("  {:<12} at {:.3f} s: {}\n", "Surface", bone->surface->time_s, SurfaceText(*bone->surface));
  if (bone->copy)
    fmt::print("  {:<12} {}: {} states of the bone among {} messages\n", "Foxglove",
               bone->copy->file.string(), bone->copy->states, bone->copy->messages);
  if (tables) {
    for (const auto& file : tables->files) json["tables"].push_back(file.string());
    fmt::print("  {:<12} {} ticks, {} frames, {} events\n", "Tables", tables->ticks, tables->frames,
               tables->events);
    for (const auto& file : tables->files) fmt::print("  {:<12} {}\n", "", file.string());
    if (!tables->complete)
      fmt::print("  {:<12} {}\n", "Torn",
                 tables->closed
                     ? fmt::format("{} bytes are behind the recording's end: somebody else wrote them, or "
                                   "another recording was here",
                                   tables->tail_bytes)
                     : fmt::format("the recording ends early; {} bytes at its end are of a message that is "
                                   "cut off",
                                   tables->tail_bytes));
  }
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return Fail("export", written.error(), kFailed);
  return 0;
}

}  // namespace osteon::session
