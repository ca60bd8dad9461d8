#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "kinematics/spatial.h"

// The file `session.json` in a procedure's folder (osteon.session/1). It names the plan, the cell and the
// bone; for each part of a recording, the tool and the carved states before and after; and the passes.
//
//     DIR/session.json   this file, replaced as a whole whenever its content changes
//         plan.yaml      the plan as it was read
//         run_1.mcap     a recording for each start of the session (`--resume` begins run_2.mcap)
//         state_1.carved carved states (simulation/files/carved_file.h), numbered as they were saved; never overwritten

namespace osteon::session {

/// A part of a recording in which one tool cut, beginning at a saved state. A change of tool and an undo each
/// begin a new segment.
struct SessionSegment {
  int tool_index{0};         ///< index in SessionFile::diameters_mm
  std::string recording;     ///< file in the session's folder
  rt::Nanoseconds begin{0};  ///< stamp of the first frame's pose, on the recording's clock
  /// Stamp of the last frame's pose; 0: not known, because the process was killed; the segment then ends with
  /// the recording.
  rt::Nanoseconds end{0};
  std::string begin_state;       ///< file of the carved state at its beginning; empty: the uncut bone
  std::string begin_state_hash;  ///< HashState of that state, 16 hexadecimal digits
  std::string end_state;         ///< file of the state at its end; empty: begin_state, since no pass ended
  std::string end_state_hash;    ///< empty as long as the segment is open
  double guidance_gain{0.0};     ///< factor on the plan's guidance gains; 0: without guidance
};

/// One pass: from the first bone that the turning tool removes until the tool has been clear for 0.5 s.
struct SessionPass {
  int number{0};  ///< from 1, in the order of the passes; an undone pass keeps its number
  int segment{0};
  int tool_index{0};
  rt::Nanoseconds begin{0}, end{0};  ///< stamps of frames' poses, on the recording's clock
  double cutting_s{0.0};             ///< time in which bone was removed
  double removed_mm3{0.0};
  std::string state;       ///< file of the carved state after the pass
  std::string state_hash;  ///< HashState of that state
  bool undone{false};      ///< true: counts in the session's time, not in its result
  /// Smallest height of the simulated head's centre over its planned place; negative: deeper. Absent: the
  /// session was made before this figure existed.
  std::optional<double> to_go_mm{};
};

/// A change of tool that the scripted operator of a simulated cell was to make, but did not.
struct MissedChange {
  int tool_index{0};   ///< index of the tool that was not taken
  std::string reason;  ///< what was missing, or the refusal
};

/// The gains of the cell at the session's start.
struct SessionGains {
  std::string law;  ///< "admittance" or "impedance"
  double stiffness_N_per_mm{0.0}, damping_Ns_per_m{0.0};
  std::array<double, 3> mass_kg{}, drag_Ns_per_m{};  ///< virtual tool by axis; zero under the impedance law
};

/// Returns the largest number N of the files PREFIX N EXTENSION in a folder, such as run_2.mcap; 0: no file.
[[nodiscard]] int LastNumber(const std::filesystem::path& folder, const std::string& prefix,
                             const std::string& extension);

/// The content of session.json.
struct SessionFile {
  std::string cell;       ///< name of the cell's file, without its ending
  std::string cell_file;  ///< path of the cell's file, as it was given
  std::string plan_file{"plan.yaml"};
  std::string plan_name;                     ///< name of the plan's file before copying; empty: older session
  std::string plan_checksum, cell_checksum;  ///< FNV-1a of 64 bits, 16 hexadecimal digits
  std::string bone_checksum;                 ///< HashState of the uncut bone
  std::string scene;
  std::string mesh_file;             ///< absolute path of the mesh that replaced the cell's bone; empty: none
  double mesh_scale{1.0};            ///< millimetres per unit of the mesh
  std::string tool;                  ///< name of the tool's kind, such as "reamer"
  std::vector<double> diameters_mm;  ///< diameters diameters of the plan's reamers
  std::string tool_change{"virtual"};  ///< "virtual" or "physical"
  std::string clock{"wall"};           ///< "wall" or "virtual"
  std::string began{};  ///< when the session was opened, UTC: "2026-11-29T09:30:00Z"; empty: virtual time, or
                        ///< an older session
  SessionGains gains;
  bool ended{false};  ///< the last run ended in order; false also while a run lasts
  std::vector<SessionSegment> segments;
  std::vector<SessionPass> passes;
  std::vector<MissedChange> missed_changes{};  ///< in the last run; empty with a person, and during a run
  std::optional<PlainPose> cup_X_GT;           ///< the tool's pose at `tell cup`, in the bone's frame G

  /// Returns the number of passes that were not undone.
  [[nodiscard]] int PassesLeft() const;
  /// Returns the file of the bone's state after the last pass that was not undone; empty: the uncut bone.
  [[nodiscard]] std::string LastState() const;
};

inline constexpr const char* kSessionFileName = "session.json";
inline constexpr std::string_view kSessionSchema{"osteon.session/1"};
/// The names of recordings and states before and after their numbers: run_2.mcap, state_1.carved.
inline constexpr const char *kRecordingPrefix = "run_", *kRecordingEnding = ".mcap", *kStatePrefix = "state_",
                            *kStateEnding = ".carved";

[[nodiscard]] std::string ToJson(const SessionFile& session);
/// Parses the text of session.json. The error names the key, what was found and what is accepted.
[[nodiscard]] tl::expected<SessionFile, std::string> ParseSession(const std::string& text);

/// Writes FOLDER/session.json, which appears complete or not at all.
[[nodiscard]] tl::expected<void, std::string> WriteSession(const std::filesystem::path& folder,
                                                           const SessionFile& session);
/// Reads FOLDER/session.json. The error names the file.
[[nodiscard]] tl::expected<SessionFile, std::string> ReadSession(const std::filesystem::path& folder);

/// Whether a segment's recording has begun. A process that was killed at once leaves no file, or a file that
/// does not start with the format's eight bytes.
[[nodiscard]] bool HasBegun(const std::filesystem::path& recording);
/// Returns the names of a session's recordings that have begun, each once, in their order.
[[nodiscard]] std::vector<std::string> BegunRecordings(const SessionFile& session,
                                                       const std::filesystem::path& folder);

/// Computes the checksum of a file's bytes that session.json keeps.
[[nodiscard]] std::string TextChecksum(const std::string& text);

}  // namespace osteon::session
