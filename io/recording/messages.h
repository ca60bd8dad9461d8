#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "simulation/engine/frame_record.h"

// Encodes and decodes the records of a recording as recording.proto's messages. Only messages.cpp,
// tick_message.cpp and frame_message.cpp include libprotobuf.

namespace osteon::io {

/// A file that the configuration was read from.
struct ConfigFile {
  std::string name;  ///< relative to ConfigSource::folder, e.g. cells/demo.yaml
  std::string content;
};

/// A cell's complete configuration: nothing else is needed to load it again.
struct ConfigSource {
  std::vector<ConfigFile> files;
  std::string cell_file;  ///< name of the cell's file among the files
  std::string tool_file;  ///< name of the file of a tool that replaces the cell's tool; empty: the cell's own
                          ///< tool is used
  /// diameter requested with that tool; none: the tool file's default
  std::optional<double> tool_diameter_m{};
  std::string gains_file{};  ///< name of a file that overrides the cell's gains; empty: none
  /// name of a file that replaces the cell's own measured figures; empty: none
  std::string identified_file{};
  /// folder that all files are in; empty unless a file refers to another by an absolute path
  std::string folder;
};

/// How finely a bone was packed (simulation::PackingLevel), and the demands that the packing was planned for.
struct PackingRecord {
  /// A demand that the packing does not meet.
  struct Unmet {
    std::string what;  ///< "error" [mm] or "rate" [Hz]
    double asked{0.0}, predicted{0.0};
    bool operator==(const Unmet&) const = default;
  };
  std::uint32_t kind{0};                 ///< simulation::PackingKind
  double spacing_m{0.0}, radius_m{0.0};  ///< spacing of the lattice; radius of its balls
  double surface_gap_m{0.0};             ///< largest gap between the surface and the balls
  std::uint32_t children{0};  ///< number of balls that a touched ball is split into; 0: none is split
  double zone_depth_m{0.0}, corner_m{0.0};  ///< as in simulation::PackingLevel
  double error_m{0.0}, rate_hz{0.0};        ///< requested depth error and frame rate
  bool timed{false};  ///< true: planned with frame times measured on this machine; false: by formulas alone
  double expected_error_m{0.0}, promised_error_m{0.0}, expected_frame_us{0.0};
  /// if zones were coarsened: median time of the frames that were too slow before
  double seen_frame_us{0.0};
  std::vector<Unmet> unmet;
  std::uint64_t balls{0};      ///< number of balls before the cut
  std::string balls_checksum;  ///< checksum of the balls' numbers, 16 digits
  bool operator==(const PackingRecord&) const = default;
};

/// The first message of a recording: the software, the machine and the cell of this run.
struct SessionInfo {
  rt::Nanoseconds stamp{0};    ///< when the session began, on the clock of the ticks
  std::string version;         ///< version of osteon
  std::string engine, device;  ///< engine of the simulation, and the device it runs on
  std::string scene, tool;
  double force_limit_N{0.0};
  std::vector<std::string> limits{};  ///< limits in force at the start, one line each
  std::string config_text;            ///< the configuration as it was read
  ConfigSource config{};
  rt::Nanoseconds utc{0};  ///< UTC at `stamp`, since 1970; 0 in virtual time
  std::string build{};     ///< commit, compiler, C library
  std::string machine{};   ///< processor, cores, system
  /// absent: the packing was loaded, or made exactly as the scene says
  std::optional<PackingRecord> packing{};
};

/// An event of the session as a line of text, e.g. a fault.
struct RecordedEvent {
  rt::Nanoseconds stamp{0};
  std::string text;
  /// Present only if this event coarsened the packing's zones: the new packing, used by all frames after
  /// frame `after_frame`.
  std::optional<PackingRecord> packing{};
  std::uint64_t after_frame{0};
};

/// Serialised google.protobuf.FileDescriptorSet of recording.proto, as MCAP embeds it.
[[nodiscard]] std::string RecordingDescriptorSet();

/// Each function overwrites `bytes` with the serialised message; the string's memory is reused.
void Encode(const SessionInfo& session, std::string& bytes);
void Encode(const control::TickRecord& record, std::string& bytes);
void Encode(const simulation::FrameRecord& record, std::string& bytes);
void Encode(const RecordedEvent& event, std::string& bytes);

/// Each function parses the output of Encode; the values are the same, bit for bit. Returns an empty string
/// on success, else the reason. Values that are not finite are accepted, because Encode writes them too.
[[nodiscard]] std::string Decode(std::span<const char> bytes, SessionInfo& session);
[[nodiscard]] std::string Decode(std::span<const char> bytes, control::TickRecord& record);
[[nodiscard]] std::string Decode(std::span<const char> bytes, simulation::FrameRecord& record);
[[nodiscard]] std::string Decode(std::span<const char> bytes, RecordedEvent& event);

}  // namespace osteon::io
