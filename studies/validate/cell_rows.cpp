#include "studies/validate/cell_rows.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "config/reading/load.h"
#include "studies/transparency/transparency.h"

namespace osteon::studies {
namespace {

constexpr double kReamer_m = 0.050;  // diameter of the demo's reamer

void AddAll(const std::vector<std::string>& more, std::vector<std::string>& to) {
  to.insert(to.end(), more.begin(), more.end());
}

// If `quick`, makes the bone coarse and the run short, as in the tests.
CellTrialParams ShortenedIfQuick(CellTrialParams cell, bool quick) {
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

// A cell with an acetabulum of foam only. It has no epoxy shell, because the measured reamer has cut the
// shell away. The run takes twice the demo's time, so that the head is seated in the denser foam as well.
CellTrialParams FoamCup(const std::string& foam, bool quick, std::vector<std::string> set) {
  AddAll({"scene.shape.cartilage_mm=0", "scene.shape.subchondral_mm=0"}, set);
  CellTrialParams cell = ShortenedIfQuick(
      {.cell = "demo", .set = std::move(set), .tissues = {{.tissue = "cancellous", .material = foam}}},
      quick);
  cell.seconds = 20.0;
  return cell;
}

// The overrides that make the demo's hand use this technique.
std::vector<std::string> TechniqueSet(Technique technique) {
  if (technique == Technique::kStraight) return {"script.tilt_deg=0"};
  return {};
}

// Diameter [mm] of the cavity after a run that ended without a fault and with its head seated.
double DiameterOf_mm(ValidationLab& lab, const CellTrialParams& cell) {
  const CellTrial& trial = lab.Cell(cell);
  if (!trial.fit) throw std::runtime_error("no cavity: " + trial.fit_refused);
  if (trial.seated_m <= 0.0)
    throw std::runtime_error(fmt::format("the head ends {:.2f} mm above the cup's centre, accepted below it",
                                         -1e3 * trial.seated_m));
  return 2e3 * trial.fit->radius_m;
}

// Difference between the diameters of cavity and reamer [mm].
double ErrorOf_mm(ValidationLab& lab, const CellTrialParams& cell) {
  return std::abs(DiameterOf_mm(lab, cell) - 1e3 * kReamer_m);
}

// A function that changes a cell so that one of its parts yields.
using Change = CellTrialParams (*)(CellTrialParams);

CellTrialParams Rigid(CellTrialParams cell) { return cell; }
CellTrialParams Bending(CellTrialParams cell) {
  cell.set.emplace_back("compliance.tool=on");
  return cell;
}
CellTrialParams Yielding(CellTrialParams cell) {
  cell.set.emplace_back("compliance.layer=on");
  return cell;
}
// Replaces the demo by the cell pelvis_mount: there the bone is on an elastic mount, and the depth limit
// moves with the bone.
CellTrialParams OnMount(CellTrialParams cell) {
  if (cell.cell != "demo")
    throw std::invalid_argument("a mount: found cell " + cell.cell + ", accepted demo");
  cell.cell = "pelvis_mount";
  return cell;
}

// A part, and the function that makes this part of a cell yield.
struct PartChange {
  CompliantPart part;
  Change change;
};
constexpr PartChange kBending{CompliantPart::kTool, Bending}, kYielding{CompliantPart::kLayer, Yielding},
    kOnMount{CompliantPart::kMount, OnMount};

// A row's quantity, simulated once with each part that yields. A variant without a result does not affect the
// row's value.
std::vector<ComplianceVariant> Variants(const std::vector<PartChange>& parts,
                                        const std::function<double(Change)>& simulate) {
  std::vector<ComplianceVariant> variants;
  for (const PartChange& part : parts) {
    ComplianceVariant variant{.part = part.part};
    try {
      variant.simulated = simulate(part.change);
    } catch (const std::exception& error) {
      variant.error = error.what();
    }
    variants.push_back(std::move(variant));
  }
  return variants;
}

// Mean of ErrorOf_mm over both densities of foam.
double MeanError_mm(ValidationLab& lab, const std::vector<std::string>& set, Change change = Rigid) {
  return 0.5 * (ErrorOf_mm(lab, change(FoamCup("foam_10", lab.quick(), set))) +
                ErrorOf_mm(lab, change(FoamCup("foam_20", lab.quick(), set))));
}

// Overrides for two ablations: a hand with the largest tremor of the shipped sweep, and an arm with masses,
// friction and a flexible mount.
const std::vector<std::string> kTremor{"operator.tremor_N=4"};
const std::vector<std::string> kDynamic{"simulated_arm.level=dynamic"};

std::vector<std::string> Joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  AddAll(b, a);
  return a;
}

// Overrides for a reamer of 61 mm, with a cup and a bone of matching size.
std::vector<std::string> WideSet() {
  return {"tool_diameter_mm=61", "scene.shape.cup_radius_mm=29.5", "scene.shape.width_mm=90",
          "depth_limit.at_mm=[620, 0, 160]"};
}

// How the cavity's diameter is simulated in its rows, as text for the page.
constexpr const char* kCellHow =
    "cell demo in virtual time: arm, hand and servo loop, CPU engine; sphere fitted to the cut balls";

CellTrialParams DemoCell(bool quick) { return ShortenedIfQuick({}, quick); }

// One figure of the demo's own run in bone.
Simulated OfDemo(ValidationLab& lab, double (*figure)(const CellTrial&)) {
  lab.Prepare(DemoCells(lab.quick()));
  const auto simulate = [&](Change change) { return figure(lab.Cell(change(DemoCell(lab.quick())))); };
  return {.value = simulate(Rigid),
          .how = "cell demo in virtual time: arm, hand and servo loop, CPU engine",
          .constants = {"cartilage.cutting_energy", "cortical.cutting_energy", "cancellous.cutting_energy",
                        "cortical.cutting_force_ratio"},
          .compliance = Variants({kBending, kYielding, kOnMount}, simulate)};
}

// Returns the trial. Throws if its hand never pressed in full, because feed and force are then not known.
const CellTrial& PressedInFull(const CellTrial& trial) {
  if (trial.pressed_s == 0.0) throw std::runtime_error("the hand never pressed in full");
  return trial;
}

// A cell whose script pushes and approaches with these forces. If push_N is empty, the script keeps its own
// forces.
CellTrialParams Pressing(const char* cell, bool quick, const std::string& push_N, const char* approach_N) {
  CellTrialParams trial{.cell = cell};
  if (!push_N.empty())
    trial.set = {"script.push_force_N=" + push_N, fmt::format("script.approach_force_N={}", approach_N)};
  return ShortenedIfQuick(std::move(trial), quick);
}

// The largest force of the hand with the shipped script. The ablation uses the published force. @param cells
// in the order of PressingCells
Simulated ScriptForce(ValidationLab& lab, const std::vector<CellTrialParams>& cells,
                      const std::string& published) {
  const CellTrial &shipped = lab.Cell(cells[0]), &gentle = lab.Cell(cells[1]);
  return {.value = shipped.peak_hand_N,
          .how = fmt::format("cell {} in virtual time with its own script, CPU engine", cells[0].cell),
          .ablations = {{fmt::format("the script presses with {} N", published), gentle.peak_hand_N}},
          .reason = fmt::format("the force is the script's, not the model's: with the published one the tool "
                                "removes {:.3g} mm³ in the same time for {:.3g} mm³",
                                1e9 * gentle.removed_m3, 1e9 * shipped.removed_m3),
          .compliance =
              Variants({kBending}, [&](Change change) { return lab.Cell(change(cells[0])).peak_hand_N; })};
}

// Three cells: with its own script, with the published force, and with a tool that bends.
std::vector<CellTrialParams> PressingCells(const char* cell, bool quick, const std::string& published_N,
                                           const char* approach_N) {
  const CellTrialParams shipped = Pressing(cell, quick, "", "");
  return {shipped, Pressing(cell, quick, published_N, approach_N), Bending(shipped)};
}

}  // namespace

std::vector<CellTrialParams> DiameterErrorCells(Technique technique, bool quick) {
  const std::vector<std::string> set = TechniqueSet(technique);
  std::vector<CellTrialParams> cells;
  for (const char* foam : {"foam_10", "foam_20"}) {
    for (const auto& variant : {set, Joined(set, kTremor), Joined(set, kDynamic)})
      cells.push_back(FoamCup(foam, quick, variant));
    cells.push_back(Bending(FoamCup(foam, quick, set)));
    cells.push_back(OnMount(FoamCup(foam, quick, set)));
  }
  return cells;
}

Simulated DiameterError(ValidationLab& lab, Technique technique) {
  lab.Prepare(DiameterErrorCells(technique, lab.quick()));
  const std::vector<std::string> set = TechniqueSet(technique);
  return {.value = MeanError_mm(lab, set),
          .how = kCellHow,
          .constants = {"foam_10.cutting_energy", "foam_20.cutting_energy", "foam_10.cutting_force_ratio",
                        "foam_20.cutting_force_ratio"},
          .ablations = {{"a hand that trembles with 4 N", MeanError_mm(lab, Joined(set, kTremor))},
                        {"an arm with masses, friction and a flexible mount",
                         MeanError_mm(lab, Joined(set, kDynamic))}},
          .reason =
              "the head is a rigid ball whose whole surface cuts, and a stiff arm guides it: the path "
              "error of hand and arm, the reamer's bending and the bone's mount give only what the variants "
              "show, chatter and gaps between teeth give the rest",
          .compliance =
              Variants({kBending, kOnMount}, [&](Change change) { return MeanError_mm(lab, set, change); })};
}

std::vector<CellTrialParams> WideCavityCells(const std::string& foam, bool quick) {
  const CellTrialParams rigid = FoamCup(foam, quick, WideSet());
  return {rigid, FoamCup(foam, quick, Joined(WideSet(), kTremor)), Bending(rigid), OnMount(rigid)};
}

Simulated WideCavity(ValidationLab& lab, const std::string& foam) {
  lab.Prepare(WideCavityCells(foam, lab.quick()));
  const auto cells = WideCavityCells(foam, lab.quick());
  return {
      .value = DiameterOf_mm(lab, cells[0]),
      .how = kCellHow,
      .constants = {foam + ".cutting_energy", foam + ".cutting_force_ratio"},
      .ablations = {{"a hand that trembles with 4 N", DiameterOf_mm(lab, cells[1])}},
      .reason = "as row 1-whirlwind: the rigid head leaves its own diameter, and what the hand's path adds",
      .compliance = Variants({kBending, kOnMount},
                             [&](Change change) { return DiameterOf_mm(lab, change(cells[0])); })};
}

std::vector<CellTrialParams> DemoCells(bool quick) {
  const CellTrialParams demo = DemoCell(quick);
  return {demo, Bending(demo), Yielding(demo), OnMount(demo)};
}

std::vector<CellTrialParams> FeedPerTurnCells(bool quick) {
  std::vector<CellTrialParams> cells = DemoCells(quick);
  cells.push_back(ShortenedIfQuick({.cell = "demo", .set = {"script.push_force_N=60"}}, quick));
  return cells;
}

Simulated CentreShift(ValidationLab& lab) {
  Simulated row = OfDemo(lab, [](const CellTrial& trial) {
    if (!trial.fit) throw std::runtime_error("no cavity: " + trial.fit_refused);
    return 1e3 * trial.centre_shift_m;
  });
  row.reason = "the script ends the cut after its time";
  return row;
}

Simulated RemovedVolume(ValidationLab& lab) {
  return OfDemo(lab, [](const CellTrial& trial) { return 1e9 * trial.removed_m3; });
}

Simulated FeedPerTurn(ValidationLab& lab) {
  lab.Prepare(FeedPerTurnCells(lab.quick()));
  const auto feed_um = [](const CellTrial& trial) { return 1e6 * PressedInFull(trial).feed_per_turn_m; };
  Simulated row = OfDemo(lab, feed_um);
  row.ablations = {
      {"a hand that presses with 60 N", feed_um(lab.Cell(FeedPerTurnCells(lab.quick()).back()))}};
  row.reason =
      "the script's 120 N feed the reamer through soft tissue faster than the regime in which chips are "
      "sheared: there the rate law's constant energy is an extrapolation; the teeth of a reamer share a "
      "turn's feed";
  return row;
}

Simulated ForceDifference(ValidationLab& lab) {
  return OfDemo(lab, [](const CellTrial& trial) { return 1e2 * PressedInFull(trial).force_difference; });
}

Simulated ReamingForce(ValidationLab& lab) {
  return OfDemo(lab, [](const CellTrial& trial) { return trial.peak_hand_N; });
}

std::vector<CellTrialParams> DrillingForceCells(bool quick) {
  return PressingCells("thin_plate", quick, "12.45", "10");
}

Simulated DrillingForce(ValidationLab& lab) {
  const auto cells = DrillingForceCells(lab.quick());
  lab.Prepare(cells);
  return ScriptForce(lab, cells, "12.45");
}

std::vector<CellTrialParams> BurForceCells(bool quick) { return PressingCells("molar", quick, "1.03", "1"); }

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
