#include "config/reading/sections/read_compliance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "config/reading/sections/compliance_params.h"
#include "config/reading/sections/read_limits.h"
#include "config/reading/sections/read_pose.h"
#include "hil/loops/mount_rule.h"
#include "safety/limits.h"
#include "simulation/tools/tool_compliance.h"

namespace osteon::config {
namespace {

// largest force at which the table of compliant parts states a layer's stiffness
constexpr double kTableForce_N = 20.0;

// Reads whether a part is compliant; off if the key is absent.
GivesWay ReadGivesWay(Reader& section, const char* key) {
  if (!section.Has(key)) return GivesWay::kOff;
  return static_cast<GivesWay>(section.Choice(key, {"off", "on", "auto"}));
}

// Reads section `bone_mount` and converts the mount's position to W. @param[out] source  source of the values
control::BoneMountParams ReadMount(Reader section, const Pose& X_WG, std::string& source) {
  control::BoneMountParams mount;
  source = section.Text("source");
  mount.p_WMo_m = section.Triple("at_mm", -kRoom_mm, kRoom_mm);
  if (IsInBoneFrame(section)) mount.p_WMo_m = X_WG * mount.p_WMo_m;
  mount.mass_kg = section.Number("mass_kg", 0.1, 500);
  mount.inertia_kg_m2 = section.Triple("inertia_kg_m2", 1e-4, 100);
  mount.stiffness_N_per_m = section.Triple("stiffness_N_per_mm", 0.1, 1e5);
  mount.stiffness_Nm_per_rad = section.Triple("stiffness_Nm_per_rad", 1, 1e7);
  mount.damping_ratio = section.Number("damping_ratio", 0, 2);
  if (section.Has("creep_N_per_mm")) {
    mount.creep_N_per_m = section.Number("creep_N_per_mm", 0.1, 1e6);
    mount.creep_tau_s = section.Number("creep_s", 0.01, 1e5);
  }
  return mount;
}

// Whether the generated bone has no cartilage (thickness 0), although its scene names a material for it.
bool IsCartilageWornOff(const CellConfig& cell) {
  if (cell.bone) return false;
  if (const auto* cup = std::get_if<simulation::AcetabulumShape>(&cell.scene.shape))
    return !(cup->cartilage_m > 0.0);
  const auto* head = std::get_if<simulation::FemoralHeadShape>(&cell.scene.shape);
  return head && !(head->cartilage_m > 0.0);
}

// The cell's surface layer. In a scene with cartilage, the cartilage is the first material.
control::SurfaceLayerParams LayerOf(const CellConfig& cell) {
  std::vector<simulation::Material> materials = cell.scene.materials;
  if (!materials.empty() && IsCartilageWornOff(cell)) materials.front().layer_N_per_m3 = 0.0;
  return SurfaceLayerOf(materials, cell.tool.tool, cell.cutting.engaged_layer_m);
}

// Radius of the cup that the tool enters. 0 if there is no cup, or if the cup is stated only in a packing
// file, which is not read here.
double CupRadiusOf(const CellConfig& cell) {
  if (cell.scene.zone.kind != simulation::ZoneParams::Kind::kCup) return 0.0;
  if (cell.bone) return cell.bone->cup ? cell.bone->cup->radius_m : 0.0;
  const auto* shape = std::get_if<simulation::AcetabulumShape>(&cell.scene.shape);
  return shape ? shape->cup_radius_m : 0.0;
}

// Largest push along the feed [N]: that of the operator's script; in a cell without simulation, the
// coupling's force limit.
double PushOf(const CellConfig& cell) {
  if (!cell.has_simulation) return cell.servo.wrench.max_force_N;
  return std::visit([](const auto& script) { return script.push_force_N; }, cell.script);
}

// Throws the refusal at its key of the section, if there is one.
void RefuseBy(const Reader& section, const std::optional<ComplianceRefusal>& refusal) {
  if (refusal) section.Refuse(refusal->key, refusal->text);
}

// The mass rule: the loop on a rigid bone must be stable up to the stiffness K (1 + m_v / m_eff), with the
// coupling's stiffness K, the virtual tool's mass m_v and the mount's effective mass m_eff at the site
// (hil/loops/mount_rule.h).
void CheckMountMass(const Reader& bone_mount, const CellConfig& cell) {
  if (!cell.has_simulation || cell.servo.law != control::Law::kAdmittance) return;
  const auto& hand = cell.simulated.hand;
  const hil::AdmittanceLoopParams rigid{
      .hand = {"operator", hand.stiffness_N_per_m, hand.damping_Ns_per_m, hand.mass_kg},
      .mass_kg = cell.servo.admittance.mass_kg.maxCoeff(),
      .damping_Ns_per_m = cell.servo.admittance.damping_Ns_per_m.minCoeff(),
      .arm = cell.simulated.servo,
      .period_s = cell.servo.period_s};
  const control::BoneMountParams& mount = *cell.servo.compliance.mount;
  const hil::MassRule rule =
      hil::CheckMass(rigid, cell.servo.coupling.max_stiffness_N_per_m, mount, cell.X_WG.translation());
  if (rule.kept) return;
  const std::string needed =
      std::isfinite(rule.min_mass_kg)
          ? fmt::format("at least {:.4g}", rule.min_mass_kg)
          : std::string(
                "none at this inertia and lever: a softer coupling, or more damping of the virtual tool");
  bone_mount.Refuse(
      "mass_kg", fmt::format("found {:g}, accepted {}: with so little mass the bone is to the virtual tool a "
                             "wall of {:.4g} N/mm, and the loop with the operator's hand of {:g} N/m is "
                             "unstable from {:.4g} N/mm",
                             mount.mass_kg, needed, 1e-3 * rule.stiffness_N_per_m, hand.stiffness_N_per_m,
                             1e-3 * rule.stable_up_to_N_per_m));
}

// A vibration mode of the mount, for rule 2: the sum of the damping of mount, virtual tool and hand must be
// at least the hand's stiffness times the arm's delay.
struct MountMode {
  std::string name;
  double critical_Ns_per_m;  // damping of the mode at the site if its damping ratio were 1
};

// The modes that move the site C: one along each axis, and one about each axis on which C does not lie.
std::vector<MountMode> ModesOf(const control::BoneMountParams& mount, const Vector3& p_WC) {
  std::vector<MountMode> modes;
  const Vector3 levers_m2 = SquaredLevers_m2(mount, p_WC);
  for (int axis = 0; axis < 3; ++axis) {
    modes.push_back({.name = fmt::format("along {}", "xyz"[axis]),
                     .critical_Ns_per_m = 2.0 * std::sqrt(mount.stiffness_N_per_m[axis] * mount.mass_kg)});
    if (levers_m2[axis] > 0.0)  // otherwise a turn about the axis does not move the site
      modes.push_back({.name = fmt::format("about {} at its lever of {:.4g} mm", "xyz"[axis],
                                           1e3 * std::sqrt(levers_m2[axis])),
                       .critical_Ns_per_m =
                           2.0 * std::sqrt(mount.stiffness_Nm_per_rad[axis] * mount.inertia_kg_m2[axis]) /
                           levers_m2[axis]});
  }
  return modes;
}

// Checks rules 2 and 3 for each mode. The hand is that of the simulated operator; in a cell without one, only
// the mount's own values are checked.
void CheckMount(const Reader& section, const CellConfig& cell) {
  const control::BoneMountParams& mount = *cell.servo.compliance.mount;
  const double T = cell.servo.period_s;
  const Reader bone_mount = Reader(section).Section("bone_mount");
  RefuseBy(bone_mount,
           CheckMountAlone(mount, cell.servo.coupling.max_stiffness_N_per_m, T, cell.X_WG.translation()));
  CheckMountMass(bone_mount, cell);
  if (!cell.has_simulation) return;
  const auto& hand = cell.simulated.hand;
  const hil::ServoArmParams& arm = cell.simulated.servo;
  // delay from the hand's force to the arm's motion: dead time, one period, and the servo's lag 2 zeta / w
  const double delay_s =
      (arm.dead_cycles + 1) * T + 2.0 * arm.damping_ratio / (2.0 * std::numbers::pi * arm.bandwidth_hz);
  // damping of the virtual tool, or of the impedance law
  const double damping = cell.servo.law == control::Law::kAdmittance
                             ? cell.servo.admittance.damping_Ns_per_m.minCoeff()
                             : cell.servo.impedance.damping_Ns_per_m.minCoeff();
  const double needed = hand.stiffness_N_per_m * delay_s;
  for (const MountMode& mode : ModesOf(mount, cell.X_WG.translation())) {
    if (mode.critical_Ns_per_m * mount.damping_ratio + damping + hand.damping_Ns_per_m >= needed) continue;
    bone_mount.Refuse(
        "damping_ratio",
        fmt::format("found {:g}, accepted at least {:.3g}: damping of the mount {}, of virtual tool and hand "
                    "must exceed the hand's {:g} N/m × {:.1f} ms",
                    mount.damping_ratio, (needed - damping - hand.damping_Ns_per_m) / mode.critical_Ns_per_m,
                    mode.name, hand.stiffness_N_per_m, 1e3 * delay_s));
  }
}

// Whether a part is compliant in the loop. With `auto`, it is if its effect matters.
bool IsOn(GivesWay asked, bool known, bool matters) {
  return known && (asked == GivesWay::kOn || (asked == GivesWay::kAuto && matters));
}

// The functions below describe the three parts. CompliancePartsOf adds the effect of each part.
CompliancePart ToolPart(const CellConfig& cell) {
  CompliancePart part{.name = "tool", .asked = cell.compliance.tool, .known = cell.tool.bending.has_value()};
  if (!part.known) return part;
  const simulation::ToolCompliance& c = cell.tool.bending->compliance;
  part.stiffness_N_per_m = c.lateral_N_per_m;
  part.force_N = cell.compliance.lateral_N;
  part.thrust_ratio = cell.compliance.push_N / c.buckling_N;
  return part;
}

CompliancePart LayerPart(const CellConfig& cell) {
  CompliancePart part{.name = "layer", .asked = cell.compliance.layer};
  const control::SurfaceLayerParams layer = LayerOf(cell);
  part.known = HasLayer(layer);
  if (!part.known) return part;
  part.force_N = cell.compliance.push_N;
  part.felt_at_N = std::min(part.force_N, kTableForce_N);
  part.stiffness_N_per_m = LayerTangent_N_per_m(layer, part.felt_at_N);
  part.seated_m2 = SeatedArea_m2(layer, cell.tool.tool, CupRadiusOf(cell));
  part.effect.gives_m = LayerDeflection_m(layer, part.force_N, part.seated_m2);
  return part;
}

CompliancePart MountPart(const CellConfig& cell) {
  CompliancePart part{
      .name = "mount", .asked = cell.compliance.mount, .known = cell.compliance.bone_mount.has_value()};
  if (!part.known) return part;
  part.force_N = cell.compliance.push_N;
  part.stiffness_N_per_m = cell.compliance.bone_mount->stiffness_N_per_m.minCoeff();
  return part;
}

}  // namespace

std::array<CompliancePart, 3> CompliancePartsOf(const CellConfig& cell) {
  std::array<CompliancePart, 3> parts{ToolPart(cell), LayerPart(cell), MountPart(cell)};
  for (CompliancePart& part : parts) {
    if (!part.known) continue;
    part.effect = simulation::EffectOf({.compliance_m_per_N = 1.0 / part.stiffness_N_per_m,
                                        .force_N = part.force_N,
                                        .gives_m = part.effect.gives_m,
                                        .stiffness_N_per_m = cell.servo.coupling.max_stiffness_N_per_m,
                                        .error_m = cell.compliance.error_m});
    part.on = IsOn(part.asked, part.known, part.effect.matters());
  }
  return parts;
}

std::optional<Reader> ReadCompliance(Reader& cell_section, CellConfig& cell) {
  if (!cell_section.Has("compliance")) return std::nullopt;
  Reader section = cell_section.Section("compliance");
  ComplianceConfig& compliance = cell.compliance;
  compliance.tool = ReadGivesWay(section, "tool");
  compliance.layer = ReadGivesWay(section, "layer");
  compliance.mount = ReadGivesWay(section, "mount");
  compliance.error_m = section.Has("error_mm") ? section.Number("error_mm", 0.001, 10) : 0.0;
  if (section.Has("bone_mount"))
    compliance.bone_mount = ReadMount(section.Section("bone_mount"), cell.X_WG, compliance.mount_source);
  return section;
}

void CompleteCompliance(const std::optional<Reader>& section, CellConfig& cell) {
  ComplianceConfig& compliance = cell.compliance;
  if (!(compliance.error_m > 0.0))
    compliance.error_m = cell.scene.fidelity ? cell.scene.fidelity->error_m : 0.1e-3;
  compliance.push_N = PushOf(cell);
  compliance.lateral_N = simulation::LateralForce_N(cell.servo.posture_load.lateral_N, compliance.push_N);
  if (!section) return;
  const std::array<CompliancePart, 3> parts = CompliancePartsOf(cell);
  const auto& [tool, layer, mount] = parts;
  // Refuses `on` for a part whose values are missing in the files. `what` names the missing values.
  const auto require = [&](const CompliancePart& part, const char* what) {
    if (part.asked == GivesWay::kOn && !part.known)
      section->Refuse(part.name, fmt::format("found on, accepted with {}", what));
  };
  require(tool, "`bending` in the tool's file");
  require(layer, "a tissue of the scene that has layer_N_per_mm3");
  require(mount, "`bone_mount` beside it");
  control::ComplianceParams& params = cell.servo.compliance;
  params.noticed_m = compliance.error_m;
  if (tool.on) {
    const ToolBendingConfig& bending = *cell.tool.bending;
    RefuseBy(*section, CheckToolLink(bending.compliance, bending.relaxation_s, compliance.push_N));
    params.tool = ToolLinkOf(bending.compliance, bending.relaxation_s, compliance.push_N);
  }
  if (layer.on) params.layer = LayerOf(cell);
  RefuseBy(*section, CheckMassless(params, cell.servo.coupling.max_stiffness_N_per_m, cell.servo.period_s));
  if (mount.on) {
    params.mount = compliance.bone_mount;
    CheckMount(*section, cell);
  }
}

}  // namespace osteon::config
