#include "studies/validate/cell_rows.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "config/reading/load.h"
#include "studies/transparency/transparency.h"

namespace osteon::studies {
namespace {

constexpr double kReamer_m = 0.050;

void AddAll(const std::vector<std::string>& more, std::vector<std::string>& to) {
  to.insert(to.end(), more.begin(), more.end());
}

// Coarse bone and a short run, as in the tests.
CellTrialParams Hastened(CellTrialParams cell, bool quick) {
  if (!quick) return cell;
  cell.seconds = 3.0;
  cell.as_packed = true;
  AddAll({"scene.packing.surface_gap_mm=0.2", "scene.packing.max_surface_gap_mm=0.5",
          "scene.events.min_wall_mm=0"},
         cell.set);
  if (cell.cell == "demo")
    AddAll({"scene.packing.spacing_mm=3", "scene.packing.sample_spacing_mm=1",
            "scene.mass_points.spacing_mm=1.5"},
           cell.set);
  else
    AddAll({"scene.packing.spacing_mm=0.8", "scene.packing.sample_spacing_mm=0.5",
            "scene.mass_points.spacing_mm=0.5"},
           cell.set);
  return cell;
}

// An acetabulum of foam alone: its epoxy shell is reamed away. Twice the demo's time, so that the head is
// seated in the denser foam as well.
CellTrialParams FoamCup(const std::string& foam, bool quick, std::vector<std::string> set) {
  AddAll({"scene.shape.cartilage_mm=0", "scene.shape.subchondral_mm=0"}, set);
  CellTrialParams cell = Hastened(
      {.cell = "demo", .set = std::move(set), .tissues = {{.tissue = "cancellous", .material = foam}}},
      quick);
  cell.seconds = 20.0;
  return cell;
}

std::vector<std::string> TechniqueSet(Technique technique) {
  if (technique == Technique::kStraight) return {"script.tilt_deg=0"};
  return {};
}

// Diameter of the cavity of a run that ended in order, with its head seated [mm].
double DiameterOf_mm(ValidationLab& lab, const CellTrialParams& cell) {
  const CellTrial& trial = lab.Cell(cell);
  if (!trial.fit) throw std::runtime_error("no cavity: " + trial.fit_refused);
  if (trial.seated_m <= 0.0)
    throw std::runtime_error(fmt::format("the head ends {:.2f} mm above the cup's centre, accepted below it",
                                         -1e3 * trial.seated_m));
  return 2e3 * trial.fit->radius_m;
}

double ErrorOf_mm(ValidationLab& lab, const CellTrialParams& cell) {
  return std::abs(DiameterOf_mm(lab, cell) - 1e3 * kReamer_m);
}

double MeanError_mm(ValidationLab& lab, const std::vector<std::string>& set) {
  return 0.5 * (ErrorOf_mm(lab, FoamCup("foam_10", lab.quick(), set)) +
                ErrorOf_mm(lab, FoamCup("foam_20", lab.quick(), set)));
}

// A hand that trembles as much as the shipped sweep's most, and an arm with masses, friction and a flexible
// mount.
const std::vector<std::string> kTremor{"operator.tremor_N=4"};
const std::vector<std::string> kDynamic{"simulated_arm.level=dynamic"};

std::vector<std::string> Both(std::vector<std::string> a, const std::vector<std::string>& b) {
  AddAll(b, a);
  return a;
}

std::vector<std::string> WideSet() {
  return {"tool_diameter_mm=61", "scene.shape.cup_radius_mm=29.5", "scene.shape.width_mm=90",
          "depth_limit.at_mm=[620, 0, 160]"};
}

constexpr const char* kCellHow =
    "cell demo in virtual time: arm, hand and servo loop, CPU engine; sphere fitted to the cut balls";

const CellTrial& Demo(ValidationLab& lab) { return lab.Cell(DemoCells(lab.quick()).front()); }

Simulated OfDemo(double value) {
  return {.value = value,
          .how = "cell demo in virtual time: arm, hand and servo loop, CPU engine",
          .constants = {"cartilage.cutting_energy", "cortical.cutting_energy", "cancellous.cutting_energy",
                        "cortical.cutting_force_ratio"}};
}

CellTrialParams Pressing(const char* cell, bool quick, const std::string& push_N, const char* approach_N) {
  CellTrialParams trial{.cell = cell};
  if (!push_N.empty())
    trial.set = {"script.push_force_N=" + push_N, fmt::format("script.approach_force_N={}", approach_N)};
  return Hastened(std::move(trial), quick);
}

// The greatest force of a shipped script's hand; as ablation with the published force.
Simulated ScriptForce(ValidationLab& lab, const std::vector<CellTrialParams>& cells,
                      const std::string& published) {
  const CellTrial &shipped = lab.Cell(cells[0]), &gentle = lab.Cell(cells[1]);
  return {.value = shipped.peak_hand_N,
          .how = fmt::format("cell {} in virtual time with its own script, CPU engine", cells[0].cell),
          .ablations = {{fmt::format("the script presses with {} N", published), gentle.peak_hand_N}},
          .reason = fmt::format("the force is the script's, not the model's: with the published one the tool "
                                "removes {:.3g} mm³ in the same time for {:.3g} mm³",
                                1e9 * gentle.removed_m3, 1e9 * shipped.removed_m3)};
}

}  // namespace

std::vector<CellTrialParams> DiameterErrorCells(Technique technique, bool quick) {
  const std::vector<std::string> set = TechniqueSet(technique);
  std::vector<CellTrialParams> cells;
  for (const char* foam : {"foam_10", "foam_20"})
    for (const auto& variant : {set, Both(set, kTremor), Both(set, kDynamic)})
      cells.push_back(FoamCup(foam, quick, variant));
  return cells;
}

Simulated DiameterError(ValidationLab& lab, Technique technique) {
  lab.Prepare(DiameterErrorCells(technique, lab.quick()));
  const std::vector<std::string> set = TechniqueSet(technique);
  return {.value = MeanError_mm(lab, set),
          .how = kCellHow,
          .constants = {"foam_10.cutting_energy", "foam_20.cutting_energy", "foam_10.cutting_force_ratio",
                        "foam_20.cutting_force_ratio"},
          .ablations = {{"a hand that trembles with 4 N", MeanError_mm(lab, Both(set, kTremor))},
                        {"an arm with masses, friction and a flexible mount",
                         MeanError_mm(lab, Both(set, kDynamic))}},
          .reason =
              "the head is a rigid ball whose whole surface cuts, and a stiff arm guides it: the path "
              "error of hand and arm gives only what the ablations show, chatter and gaps between teeth "
              "give the rest"};
}

std::vector<CellTrialParams> WideCavityCells(const std::string& foam, bool quick) {
  return {FoamCup(foam, quick, WideSet()), FoamCup(foam, quick, Both(WideSet(), kTremor))};
}

Simulated WideCavity(ValidationLab& lab, const std::string& foam) {
  lab.Prepare(WideCavityCells(foam, lab.quick()));
  const auto cells = WideCavityCells(foam, lab.quick());
  return {
      .value = DiameterOf_mm(lab, cells[0]),
      .how = kCellHow,
      .constants = {foam + ".cutting_energy", foam + ".cutting_force_ratio"},
      .ablations = {{"a hand that trembles with 4 N", DiameterOf_mm(lab, cells[1])}},
      .reason = "as row 1-whirlwind: the rigid head leaves its own diameter, and what the hand's path adds"};
}

std::vector<CellTrialParams> DemoCells(bool quick) { return {Hastened({}, quick)}; }

std::vector<CellTrialParams> FeedPerTurnCells(bool quick) {
  return {Hastened({}, quick), Hastened({.cell = "demo", .set = {"script.push_force_N=60"}}, quick)};
}

Simulated CentreShift(ValidationLab& lab) {
  const CellTrial& demo = Demo(lab);
  if (!demo.fit) throw std::runtime_error("no cavity: " + demo.fit_refused);
  Simulated row = OfDemo(1e3 * demo.centre_shift_m);
  row.reason = "the script ends the cut after its time";
  return row;
}

Simulated RemovedVolume(ValidationLab& lab) { return OfDemo(1e9 * Demo(lab).removed_m3); }

Simulated FeedPerTurn(ValidationLab& lab) {
  lab.Prepare(FeedPerTurnCells(lab.quick()));
  const auto feed_um = [&](const CellTrialParams& cell) {
    const CellTrial& trial = lab.Cell(cell);
    if (trial.pressed_s == 0.0) throw std::runtime_error("the hand never pressed in full");
    return 1e6 * trial.feed_per_turn_m;
  };
  const auto cells = FeedPerTurnCells(lab.quick());
  Simulated row = OfDemo(feed_um(cells[0]));
  row.ablations = {{"a hand that presses with 60 N", feed_um(cells[1])}};
  row.reason =
      "the script's 120 N feed the reamer through soft tissue faster than the regime in which chips are "
      "sheared: there the rate law's constant energy is an extrapolation; the teeth of a reamer share a "
      "turn's feed";
  return row;
}

Simulated ForceDifference(ValidationLab& lab) {
  const CellTrial& demo = Demo(lab);
  if (demo.pressed_s == 0.0) throw std::runtime_error("the hand never pressed in full");
  return OfDemo(1e2 * demo.force_difference);
}

Simulated ReamingForce(ValidationLab& lab) { return OfDemo(Demo(lab).peak_hand_N); }

std::vector<CellTrialParams> DrillingForceCells(bool quick) {
  return {Pressing("thin_plate", quick, "", ""), Pressing("thin_plate", quick, "12.45", "10")};
}

Simulated DrillingForce(ValidationLab& lab) {
  const auto cells = DrillingForceCells(lab.quick());
  lab.Prepare(cells);
  return ScriptForce(lab, cells, "12.45");
}

std::vector<CellTrialParams> BurForceCells(bool quick) {
  return {Pressing("molar", quick, "", ""), Pressing("molar", quick, "1.03", "1")};
}

Simulated BurForce(ValidationLab& lab) {
  const auto cells = BurForceCells(lab.quick());
  lab.Prepare(cells);
  return ScriptForce(lab, cells, "1.03");
}

Simulated DragDifference(ValidationLab& lab) {
  const config::CellConfig cell = config::LoadCell(lab.config_root() / "cells" / "demo.yaml");
  TransparencyOptions options;
  options.cell = "demo";
  options.points = lab.quick() ? 3 : 9;
  const TransparencyResult felt = MeasureTransparency(cell, options);
  double worst = 0.0;
  for (const TransparencyAxis& axis : felt.axes)
    worst = std::max(worst, std::abs(axis.fit.drag - axis.asked_drag) / axis.asked_drag);
  return {.value = 1e2 * worst,
          .how = "cell demo in free motion, as osteon transparency demo measures it; the worst of six axes"};
}

}  // namespace osteon::studies
