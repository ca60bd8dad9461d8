#pragma once

#include <span>
#include <string>

#include "studies/validate/validation_rows.h"

namespace osteon::studies {

/// Draws one line for each row: the ratio simulated / measured on a logarithmic axis, and the measured
/// spread.
[[nodiscard]] std::string ValidationPlot(std::span<const ValidationRow> rows);

}  // namespace osteon::studies
