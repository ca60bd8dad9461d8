#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/scenario_trace.h"

namespace osteon::app {

/// A configuration file that a trace depends on.
struct GoldenSource {
  std::string path;      ///< below the configuration's root
  std::string checksum;  ///< of its bytes: FNV-1a, 16 hexadecimal digits

  bool operator==(const GoldenSource&) const = default;
};

/// Where a golden trace is from.
struct GoldenHead {
  std::string scenario;
  std::vector<std::string>
      reasons;  ///< "2026-11-23 commit 0123: why", the oldest first: each time that it was accepted
  std::string build, machine, engine;
  std::vector<GoldenSource> sources;
};

struct Golden {
  GoldenHead head;
  ScenarioTrace trace;
};

/// The file's text. Values are rounded to DecimalsOf, which is far below any tolerance; the hash is not.
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
///     AbCdEfGhIjKlMn …           seven parts of two characters (base64) a tick, eight ticks a line
///     end
[[nodiscard]] std::string GoldenText(const Golden& golden);

/// Reads such a text. Nothing of it is trusted: every count, number and name is checked, and how much there
/// may be.
/// @param name  of the file, for errors
/// @returns an error "file:line: what was found, what is accepted".
[[nodiscard]] tl::expected<Golden, std::string> ParseGolden(const std::string& text, const std::string& name);

/// @returns an error that names the file. Of a file beyond 8 MiB nothing is read.
[[nodiscard]] tl::expected<Golden, std::string> ReadGolden(const std::filesystem::path& file);

/// The reasons alone, also of a file that is no golden trace of this version any more; none of a file that
/// there is not.
[[nodiscard]] std::vector<std::string> ReadReasons(const std::filesystem::path& file);

}  // namespace osteon::app
