#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "hil/faults/fault_matrix.h"

namespace osteon::app {

/// `osteon failures --faults`: every fault in every state of the cell, in virtual time.
struct FaultTableOptions {
  std::filesystem::path json{};  ///< empty: none
};

/// Runs the matrix and prints it as a table.
/// @returns the process's exit code: 0 each came to what is stated; 1 not so, or the file could not be
/// written; 130 ended by Ctrl-C.
[[nodiscard]] int RunFaultTable(const FaultTableOptions& options);

/// The table as it is printed: a row a fault, a column a state, the reactions as letters that its legend
/// explains, and below what is wrong.
[[nodiscard]] std::string FaultTableText(std::span<const hil::FaultVerdict> verdicts);

/// The JSON object, schema osteon.failures/1, with no scenario and the matrix in `faults`.
[[nodiscard]] std::string FaultTableJson(std::span<const hil::FaultVerdict> verdicts);

}  // namespace osteon::app
