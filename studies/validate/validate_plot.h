#pragma once

#include <span>
#include <string>

#include "studies/validate/validation_rows.h"

namespace osteon::studies {

/// Draws a line for each row: simulated over measured, beside the measured spread, on a logarithmic axis.
[[nodiscard]] std::string ValidationPlot(std::span<const ValidationRow> rows);

}  // namespace osteon::studies
