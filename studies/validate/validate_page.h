#pragma once

#include <span>
#include <string>

#include "studies/validate/validation_rows.h"

namespace osteon::studies {

/// The HTML page of `osteon validate`: plot, table, and for each row its source, its conditions, the effects
/// left out, and the ablations.
[[nodiscard]] std::string ValidationPage(std::span<const ValidationRow> rows,
                                         const std::string& command_line);

}  // namespace osteon::studies
