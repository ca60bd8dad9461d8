#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "report/thin_curve.h"
#include "safety/fault.h"
#include "studies/diff/excited_figures.h"
#include "studies/diff/run_figure.h"

namespace osteon::studies {

/// The data of one recording that `osteon diff` compares with those of another, gathered in one pass.
struct RunFigures {
  io::SessionInfo session;
  std::vector<RunFigure> figures;
  safety::FaultSet faults;            ///< faults that occurred in any tick
  std::vector<std::uint64_t> limits;  ///< number of ticks in which each limit acted (safety::Limit)
  std::string end;                    ///< the last event: how the run ended
  std::uint64_t ticks{0};             ///< number of ticks
  std::uint64_t hash{0};              ///< hash over all ticks, without the times that the machine took
  std::string end_error;              ///< why the recording has no proper end; empty: it has one
  rt::Nanoseconds first{0};           ///< stamp of the first tick
  report::ThinCurve force_N, depth_mm, removed_mm3;  ///< force on the hand; depth of the cut; removed volume
  std::optional<ExcitedFigures> excited{};           ///< of a recording of `osteon identify`
};

/// Reads a recording. The error names file, byte and reason.
[[nodiscard]] tl::expected<RunFigures, std::string> ReadRunFigures(const std::filesystem::path& recording);

}  // namespace osteon::studies
