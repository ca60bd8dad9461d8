#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "simulation/bone/material.h"
#include "studies/validate/cell_trial.h"
#include "studies/validate/constant_feed.h"

namespace osteon::studies {

/// Options of the runs of `osteon validate`.
struct LabParams {
  std::filesystem::path config_root;
  bool quick{false};  ///< coarse bones and short runs, as in the tests: seconds instead of minutes
  int jobs{0};        ///< number of cells that run at a time; 0: one per core
};

/// Makes the runs that the rows need. Each result is kept for further rows that need the same run.
class ValidationLab {
 public:
  explicit ValidationLab(LabParams params) : params_(std::move(params)) {}

  /// A material of the shipped files bone.yaml, sawbone.yaml or tooth.yaml.
  /// @throws std::invalid_argument naming it if there is none.
  [[nodiscard]] const simulation::Material& MaterialOf(const std::string& name);

  /// Returns the result of a drill at constant feed. @param params  config_root and packing_scale are
  /// replaced by the lab's
  [[nodiscard]] const ConstantFeedResult& Drill(ConstantFeedParams params);

  /// Runs several cells at the same time and keeps the results for Cell().
  void Prepare(std::span<const CellTrialParams> cells);
  /// Returns a cell's run; makes it unless Prepare() or an earlier call has made it.
  /// @throws std::runtime_error with the reason if the cell cannot be run, or stopped with a fault.
  [[nodiscard]] const CellTrial& Cell(const CellTrialParams& params);

  [[nodiscard]] bool quick() const { return params_.quick; }
  [[nodiscard]] const std::filesystem::path& config_root() const { return params_.config_root; }

 private:
  LabParams params_;
  std::vector<simulation::Material> materials_;
  std::map<std::string, ConstantFeedResult> drills_;
  std::map<std::string, tl::expected<CellTrial, std::string>> cells_;
};

}  // namespace osteon::studies
