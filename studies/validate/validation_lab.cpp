#include "studies/validate/validation_lab.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "config/reading/load.h"

namespace osteon::studies {
namespace {

constexpr double kQuickScale = 2.0;  // factor on the spacings of packings in a quick run

// Text that is equal only for equal drill runs. A material with changed figures must have a name of its own.
std::string KeyOf(const ConstantFeedParams& p) {
  std::string key =
      fmt::format("{} {} {} {} {} {} {} rad/s", p.material.name, p.material.specific_cutting_energy_J_per_m3,
                  p.material.cutting_force_ratio, p.edge_force, p.bends, p.diameter_m, p.spindle_rad_per_s);
  for (const FeedStep& step : p.steps) key += fmt::format(" {} {}", step.feed_m_per_s, step.depth_m);
  return key;
}

}  // namespace

const simulation::Material& ValidationLab::MaterialOf(const std::string& name) {
  if (materials_.empty())
    for (const char* file : {"bone.yaml", "sawbone.yaml", "tooth.yaml"})
      for (simulation::Material& material : config::LoadMaterials(params_.config_root / "materials" / file))
        materials_.push_back(std::move(material));
  const auto found = std::ranges::find(materials_, name, &simulation::Material::name);
  if (found == materials_.end())
    throw std::invalid_argument(fmt::format("material {}: not in the shipped files", name));
  return *found;
}

const ConstantFeedResult& ValidationLab::Drill(ConstantFeedParams params) {
  params.config_root = params_.config_root;
  params.packing_scale = params_.quick ? kQuickScale : 1.0;
  const std::string key = KeyOf(params);
  const auto known = drills_.find(key);
  if (known != drills_.end()) return known->second;
  return drills_.emplace(key, DrillAtConstantFeed(params)).first->second;
}

void ValidationLab::Prepare(std::span<const CellTrialParams> cells) {
  std::vector<const CellTrialParams*> todo;
  for (const CellTrialParams& cell : cells)
    if (!cells_.contains(cell.Key()) &&
        std::ranges::none_of(todo, [&](const auto* other) { return other->Key() == cell.Key(); }))
      todo.push_back(&cell);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  // runs one cell after another until none is left; an exception is stored as the cell's error
  const auto work = [&] {
    for (std::size_t i = next++; i < todo.size(); i = next++) {
      tl::expected<CellTrial, std::string> trial = tl::make_unexpected(std::string());
      try {
        trial = RunCellTrial(params_.config_root, *todo[i]);
      } catch (const std::exception& error) {
        trial = tl::make_unexpected(std::string(error.what()));
      }
      const std::scoped_lock lock(mutex);
      cells_.emplace(todo[i]->Key(), std::move(trial));
    }
  };
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const auto jobs = static_cast<std::size_t>(std::max(1, params_.jobs > 0 ? params_.jobs : cores));
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < std::min(jobs, todo.size()); ++i) threads.emplace_back(work);
  work();
}

const CellTrial& ValidationLab::Cell(const CellTrialParams& params) {
  Prepare(std::span(&params, 1));
  const auto& trial = cells_.at(params.Key());
  if (!trial) throw std::runtime_error(trial.error());
  if (!trial->faults.empty())
    throw std::runtime_error(fmt::format("cell {} stopped: {}", params.cell, trial->faults.front()));
  return *trial;
}

}  // namespace osteon::studies
