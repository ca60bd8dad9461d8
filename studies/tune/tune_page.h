#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "report/page.h"
#include "studies/tune/tune.h"
#include "studies/tune/tune_result.h"

namespace osteon::studies {

/// The verdict of a tuning in plain words: whether the cell is safe, with which gains, why, what to do next,
/// and last the reasons of Judge.
[[nodiscard]] report::ReportVerdict PlainVerdict(const TuneResult& result);

/// Writes gains.yaml into a folder. If the text is empty, there are no gains to use: then the file of an
/// earlier call is removed, because a user would take it for the result of this call. @returns an error that
/// names the file.
[[nodiscard]] tl::expected<void, std::string> WriteGains(const std::filesystem::path& folder,
                                                         const std::string& yaml);

/// Writes tune.json, .csv, .html, the pictures and gains.yaml into options.out, and a copy of the JSON
/// to options.json, if it is set. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteTuning(const TuneResult& result,
                                                          const TuneOptions& options);

}  // namespace osteon::studies
