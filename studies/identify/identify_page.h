#pragma once

#include <string>

#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// The page of a result: verdict, summary, the response with error bars and the fitted arm, lag over speed,
/// force.
[[nodiscard]] std::string IdentifyPage(const IdentifyResult& result, const std::string& command_line);

}  // namespace osteon::studies
