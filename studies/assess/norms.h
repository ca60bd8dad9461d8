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

/// Computes the medians of the metrics over sessions of a site's own experts.
/// @param guided  whether the assessed session, which the medians are compared with, was guided
/// @returns the medians; or an error that names a folder that cannot be used: it cannot be read, its session
///   is not finished or incomplete, or exactly one of its session and the assessed session was guided.
[[nodiscard]] tl::expected<Norms, std::string> ReadNorms(const std::vector<std::filesystem::path>& folders,
                                                         bool guided);

}  // namespace osteon::studies
