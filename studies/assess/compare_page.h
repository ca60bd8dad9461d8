#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "studies/assess/assess_result.h"

namespace osteon::studies {

/// The mark beside a session's score: "without guidance", "with guidance (gain 0.5), not finished".
[[nodiscard]] std::string MarkOf(const AssessResult& result);

/// Says why the scores of two sessions must not be ranked: only one of them was guided, or one is not
/// finished. Empty if they may be ranked.
[[nodiscard]] std::string WhyNotRanked(const AssessResult& first, const AssessResult& second);

/// Draws two sessions of the same plan, one above the other: score, whether the session was guided, points,
/// coronal and axial section, map of the deviation.
/// @returns an SVG document, or an error if a picture could not be encoded.
[[nodiscard]] tl::expected<std::string, std::string> ComparisonSvg(const AssessResult& first,
                                                                   const AssessResult& second);

/// Writes FOLDER/compare.html, with a table of all figures, and FOLDER/compare.png, only the picture. The
/// error names the file.
[[nodiscard]] tl::expected<void, std::string> WriteComparison(const AssessResult& first,
                                                              const AssessResult& second,
                                                              const std::string& command_line,
                                                              const std::filesystem::path& folder);

}  // namespace osteon::studies
