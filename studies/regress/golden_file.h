#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "studies/regress/scenario_trace.h"

namespace osteon::studies {

/// A configuration file that a trace depends on.
struct GoldenSource {
  std::string path;      ///< path relative to the configuration's root
  std::string checksum;  ///< checksum of the file's bytes: FNV-1a, 16 hexadecimal digits

  bool operator==(const GoldenSource&) const = default;
};

/// The origin of a golden trace.
struct GoldenHead {
  std::string scenario;
  /// "2026-11-23 commit 0123: why", one for each time that the trace was accepted, the oldest first.
  std::vector<std::string> reasons;
  std::string build, machine, engine;
  std::vector<GoldenSource> sources;
};

/// The content of a golden file: the accepted trace and where it comes from.
struct Golden {
  GoldenHead head;
  ScenarioTrace trace;
};

/// Writes the file's text. Values are rounded to DecimalsOf, far below any tolerance; the hash is exact.
///
///     osteon golden trace 1
///     scenario reaming_lbr
///     reason 2026-11-23 commit 0123456789ab: first trace
///     build …
///     …
///     event 1012 state haptic
///     columns q_cmd_1_rad …
///     sample 1020 -0.1132003 …
///     digests 1003
///     AbCdEfGhIjKlMn …           seven parts of two characters (base64) per tick, eight ticks per line
///     end
[[nodiscard]] std::string GoldenText(const Golden& golden);

/// Parses the text of a golden file. The text is not trusted: every count, number, name and size is checked.
/// @param name  the file's name, for errors
/// @returns an error "file:line: what was found, what is accepted".
[[nodiscard]] tl::expected<Golden, std::string> ParseGolden(const std::string& text, const std::string& name);

/// Reads a golden file. A file larger than 8 MiB is not read.
/// @returns an error that names the file
[[nodiscard]] tl::expected<Golden, std::string> ReadGolden(const std::filesystem::path& file);

/// Reads only the reasons, even from a file of another version of the format; none if there is no file.
[[nodiscard]] std::vector<std::string> ReadReasons(const std::filesystem::path& file);

}  // namespace osteon::studies
