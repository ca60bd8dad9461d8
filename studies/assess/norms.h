#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "studies/assess/session_reading.h"

namespace osteon::studies {

/// Median of a metric over expert sessions, in SI.
struct Norm {
  double median{0.0};
  int sessions{0};
};
using Norms = std::map<std::string, Norm>;

/// "with guidance (gain 0.5)" or "without guidance".
[[nodiscard]] std::string GuidanceText(const AssessedSession& session);

/// Medians of the metrics over sessions of a site's own experts.
/// @param guided  whether the session that they stand beside was guided
/// @returns an error that names the folder: it cannot be read, is not finished or not whole, or was guided
/// where the other was not, or the other way round.
[[nodiscard]] tl::expected<Norms, std::string> ReadNorms(const std::vector<std::filesystem::path>& folders,
                                                         bool guided);

}  // namespace osteon::studies
