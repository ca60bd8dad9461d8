#include "studies/validate/validation_rows.h"

#include <algorithm>
#include <exception>

#include "base/interrupt.h"
#include "studies/validate/cell_rows.h"
#include "studies/validate/drill_rows.h"
#include "studies/validate/fitted_constants.h"

namespace osteon::studies {
namespace {

using Lab = ValidationLab;

// How each measurement is simulated, in the order of Measurements().
std::vector<ValidationItem> MakeItems() {
  const auto cavity = [](std::string_view id, Technique technique) {
    return ValidationItem{.id = id,
                          .simulate = [technique](Lab& lab) { return DiameterError(lab, technique); },
                          .cells = [technique](bool quick) { return DiameterErrorCells(technique, quick); }};
  };
  const auto wide = [](std::string_view id, const char* foam) {
    return ValidationItem{.id = id,
                          .simulate = [foam](Lab& lab) { return WideCavity(lab, foam); },
                          .cells = [foam](bool quick) { return WideCavityCells(foam, quick); }};
  };
  const auto thrust = [](std::string_view id, const char* material, double rpm) {
    return ValidationItem{.id = id, .simulate = [=](Lab& lab) { return Thrust(lab, material, rpm); }};
  };
  return {
      cavity("1-whirlwind", Technique::kWhirlwind),
      cavity("1-straight", Technique::kStraight),
      cavity("2-whirlwind", Technique::kWhirlwind),
      cavity("2-straight", Technique::kStraight),
      wide("3-low", "foam_10"),
      wide("3-high", "foam_20"),
      {.id = "5", .simulate = CentreShift, .cells = DemoCells},
      {.id = "7", .simulate = RemovedVolume, .cells = DemoCells},
      thrust("8-level", "cortical", 1000),
      thrust("8-1250", "cortical", 1250),
      thrust("8-1500", "cortical", 1500),
      {.id = "8-speed", .simulate = [](Lab& lab) { return ThrustSpeedRatio(lab, "cortical"); }},
      thrust("9-1000", "shell", 1000),
      thrust("9-1250", "shell", 1250),
      thrust("9-1500", "shell", 1500),
      {.id = "9-speed", .simulate = [](Lab& lab) { return ThrustSpeedRatio(lab, "shell"); }},
      {.id = "9-to-8", .simulate = SawboneOverCortex},
      {.id = "10-human", .simulate = [](Lab& lab) { return MeanTorque(lab, "cortical"); }},
      {.id = "10-sawbone", .simulate = [](Lab& lab) { return MeanTorque(lab, "shell"); }},
      {.id = "10-speed-human", .simulate = [](Lab& lab) { return TorqueSpeedRatio(lab, "cortical"); }},
      {.id = "10-speed-sawbone", .simulate = [](Lab& lab) { return TorqueSpeedRatio(lab, "shell"); }},
      {.id = "11-thrust", .simulate = [](Lab& lab) { return ThrustSpeedRatio(lab, "cortical", 0.0025); }},
      {.id = "11-torque", .simulate = [](Lab& lab) { return TorqueSpeedRatio(lab, "cortical", 0.0025); }},
      {.id = "12", .simulate = DrillingForce, .cells = DrillingForceCells},
      {.id = "13", .simulate = EnergyRatio},
      {.id = "14-depth", .simulate = DepthOfCutRatio},
      {.id = "14-speed", .simulate = CuttingSpeedRatio},
      {.id = "15", .simulate = BurForce, .cells = BurForceCells},
      {.id = "16", .simulate = FeedPerTurn, .cells = FeedPerTurnCells},
      {.id = "18", .simulate = ForceDifference, .cells = DemoCells},
      {.id = "19", .simulate = DragDifference},
      {.id = "20", .simulate = ReamingForce, .cells = DemoCells},
  };
}

}  // namespace

std::span<const ValidationItem> ValidationItems() {
  static const std::vector<ValidationItem> items = MakeItems();
  return items;
}

std::string_view NameOf(CompliantPart part) {
  switch (part) {
    case CompliantPart::kTool:
      return "tool";
    case CompliantPart::kLayer:
      return "layer";
    case CompliantPart::kMount:
      break;
  }
  return "mount";
}

const ComplianceVariant* Simulated::With(CompliantPart part) const {
  const auto found = std::ranges::find(compliance, part, &ComplianceVariant::part);
  return found == compliance.end() ? nullptr : &*found;
}

bool ValidationRow::fitted() const { return IsFittedTo(simulated.constants, measurement->id); }

std::optional<bool> ValidationRow::within() const {
  if (!error.empty() || !measurement->judged()) return {};
  return measurement->Contains(simulated.value);
}

std::string_view ValidationRow::verdict() const {
  if (!error.empty()) return "no result";
  if (fitted() || measurement->use == RowUse::kCalibrates) return "calibrates";
  const auto is_within = within();
  if (!is_within) return "not judged";
  return *is_within ? "within" : "misses";
}

std::vector<ValidationRow> RunValidation(ValidationLab& lab, std::span<const std::string> ids,
                                         const std::function<void(std::string_view)>& begins) {
  const auto chosen = [&](std::string_view id) {
    return ids.empty() || std::ranges::find(ids, id) != ids.end();
  };
  std::vector<CellTrialParams> cells;
  for (const ValidationItem& item : ValidationItems())
    if (chosen(item.id) && item.cells)
      for (CellTrialParams& cell : item.cells(lab.quick())) cells.push_back(std::move(cell));
  if (!cells.empty()) {
    begins("cells in virtual time");
    lab.Prepare(cells);
  }
  std::vector<ValidationRow> rows;
  for (const ValidationItem& item : ValidationItems()) {
    if (!chosen(item.id) || base::Interrupted()) continue;
    begins(item.id);
    ValidationRow row{.measurement = FindMeasurement(item.id), .simulated = {}};
    try {
      row.simulated = item.simulate(lab);
    } catch (const std::exception& error) {
      row.error = error.what();
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::span<const PublishedUse> PublishedUses() {
  static constexpr PublishedUse kUses[]{
      {.row = "1", .value = "0.3 and 1.6 mm", .where = "config/rubrics/rubric.yaml, diameter_error"},
      {.row = "17",
       .value = "0.554 kg, 6.45 N s/m, 135 N/m (srep18004)",
       .where = "hil/operator/hand_grid.cpp, the hand \"published\": every cell must be stable with it"},
      {.row = "18",
       .value = "7 % of a force (Pang 1991)",
       .where = "osteon failures 3 and others, osteon chart speed-accuracy: bound of a force's change"},
  };
  return kUses;
}

}  // namespace osteon::studies
