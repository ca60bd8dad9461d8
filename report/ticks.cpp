#include "report/ticks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/svg_text.h"

namespace osteon::report {
namespace {

// Whether a range is finite and wider than rounding.
bool Usable(Range range) {
  return std::isfinite(range.min) && std::isfinite(range.max) && range.max > range.min &&
         range.max - range.min > 1e-12 * std::max(std::abs(range.min), std::abs(range.max));
}

// Formats a tick of a logarithmic axis: as a plain number from 0.001 to 1e8, else with an exponent.
std::string PowerLabel(double value) {
  if (value >= 1e-3 && value < 1e8)
    return Number(value, value >= 1.0 ? 0 : static_cast<int>(std::ceil(-std::log10(value) - 1e-9)));
  return fmt::format("{:.0e}", value);
}

}  // namespace

double NiceStep(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

Ticks LinearTicks(Range range, int max_count) {
  Ticks ticks;
  if (!Usable(range) || max_count < 1) return ticks;
  double step = NiceStep((range.max - range.min) / max_count);
  // number of marks in the range for a step s, both ends included
  const auto count = [&range](double s) {
    return std::floor(range.max / s + 1e-9) - std::ceil(range.min / s - 1e-9) + 1.0;
  };
  while (count(step) > max_count) step = NiceStep(step * 1.5);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const double first = std::ceil(range.min / step - 1e-9);
  for (int i = 0; i < static_cast<int>(count(step)); ++i) {
    ticks.at.push_back((first + i) * step);
    const double size = std::max(std::abs(range.min), std::abs(range.max));
    const bool plain = decimals <= 6 && size < 1e9;
    ticks.labels.push_back(plain ? Number(ticks.at.back(), decimals)
                                 : fmt::format("{:.3g}", ticks.at.back()));
  }
  return ticks;
}

Ticks LogTicks(Range range, int max_count) {
  Ticks ticks;
  if (!Usable(range) || !(range.min > 0.0)) return ticks;
  const int first = static_cast<int>(std::floor(std::log10(range.min) + 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(range.max) + 1e-9));
  const int first_power = static_cast<int>(std::ceil(std::log10(range.min) - 1e-9));
  const int powers = std::max(last - first_power + 1, 1);
  // if there are too many powers of ten, only every n-th power has a text, and there are no marks between
  // powers
  const int every = std::max(1, (powers + max_count - 1) / std::max(max_count, 1));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, exponent);
      if (value < range.min * (1.0 - 1e-9) || value > range.max * (1.0 + 1e-9)) continue;
      const bool labelled = factor == 1.0 ? (exponent - first_power) % every == 0 : 3 * powers <= max_count;
      if (factor != 1.0 && every > 1) continue;
      ticks.at.push_back(value);
      ticks.labels.push_back(labelled ? PowerLabel(value) : std::string());
    }
  }
  return ticks;
}

Range NiceRange(Range range, int max_count) {
  if (!std::isfinite(range.min) || !std::isfinite(range.max) || range.max < range.min) return {0.0, 1.0};
  if (!Usable(range)) {
    const double margin = range.min == 0.0 ? 1.0 : 0.1 * std::abs(range.min);
    range = {range.min - margin, range.max + margin};
  }
  const double step = NiceStep((range.max - range.min) / std::max(max_count, 1));
  return {std::floor(range.min / step + 1e-9) * step, std::ceil(range.max / step - 1e-9) * step};
}

std::vector<std::vector<PlotPoint>> DecimateMinMax(std::span<const double> x, std::span<const double> y,
                                                   Range x_range, int columns) {
  std::vector<std::vector<PlotPoint>> runs;
  const double scale = columns / (x_range.max - x_range.min);
  std::vector<PlotPoint> run;
  // indices of the points of the current column that are kept
  std::size_t first = 0, least = 0, greatest = 0, last = 0;
  long column = -1;
  const auto flush_column = [&] {
    if (column < 0) return;
    std::size_t keep[4] = {first, least, greatest, last};
    std::sort(std::begin(keep), std::end(keep));
    for (std::size_t i = 0; i < 4; ++i)
      if (i == 0 || keep[i] != keep[i - 1]) run.push_back({x[keep[i]], y[keep[i]]});
    column = -1;
  };
  const auto flush_run = [&] {
    flush_column();
    if (!run.empty()) runs.push_back(std::move(run));
    run.clear();
  };
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      flush_run();
      continue;
    }
    if (x[i] < x_range.min || x[i] > x_range.max) continue;
    const long here =
        std::min(static_cast<long>((x[i] - x_range.min) * scale), static_cast<long>(columns) - 1);
    if (here != column) {
      flush_column();
      column = here;
      first = least = greatest = i;
    }
    if (y[i] < y[least]) least = i;
    if (y[i] > y[greatest]) greatest = i;
    last = i;
  }
  flush_run();
  return runs;
}

}  // namespace osteon::report
