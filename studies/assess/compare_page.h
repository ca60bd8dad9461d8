#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "studies/assess/assess_result.h"

namespace osteon::studies {

/// Two sessions of a plan one above the other: score and points, coronal and axial section, map of the
/// deviation.
/// @returns an SVG document; an error where a picture could not be encoded.
[[nodiscard]] tl::expected<std::string, std::string> ComparisonSvg(const AssessResult& first,
                                                                   const AssessResult& second);

/// Writes FOLDER/compare.html, with a table of all figures, and FOLDER/compare.png, the picture alone. The
/// error names the file.
[[nodiscard]] tl::expected<void, std::string> WriteComparison(const AssessResult& first,
                                                              const AssessResult& second,
                                                              const std::string& command_line,
                                                              const std::filesystem::path& folder);

}  // namespace osteon::studies
