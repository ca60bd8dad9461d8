#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "studies/faults/fault_matrix.h"

namespace osteon::studies {

/// Options of `osteon failures --faults`: every fault in every state of the cell, in virtual time.
struct FaultTableOptions {
  std::filesystem::path json{};  ///< empty: none
};

/// Runs the matrix and prints it as a table.
/// @returns the process's exit code: 0 every case had the stated outcome; 1 otherwise, or the file could not
/// be written; 130 ended by Ctrl-C.
[[nodiscard]] int RunFaultTable(const FaultTableOptions& options);

/// The printed table: a row per fault, a column per state, the reactions as letters with a legend, and below
/// it the cases that are wrong.
[[nodiscard]] std::string FaultTableText(std::span<const FaultVerdict> verdicts);

/// JSON object, schema osteon.failures/1, without scenarios and with the matrix in `faults`.
[[nodiscard]] std::string FaultTableJson(std::span<const FaultVerdict> verdicts);

}  // namespace osteon::studies
