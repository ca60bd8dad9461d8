#include "studies/validate/drill_rows.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::studies {
namespace {

constexpr double kFeed_m_per_s = 0.120 / 60.0;  // 120 mm/min
constexpr int kLips = 2;                        // number of lips of a twist drill
constexpr double kRadius_m = 0.0016;            // radius of MacAvelia's drill
// Volume that the drill removes per second.
constexpr double kRate_m3_per_s = std::numbers::pi * kRadius_m * kRadius_m * kFeed_m_per_s;

constexpr const char* kWithoutEdge = "without the edges' own force";

// The constants of a material on which its thrust and torque depend.
std::vector<std::string> ConstantsOf(const std::string& material) {
  return {material + ".cutting_energy", material + ".cutting_force_ratio", material + ".edge_force"};
}
// The constants of a material on which a ratio of two forces depends. The ratio changes with the quotient of
// edge force and cutting energy.
std::vector<std::string> RatioConstants(const std::string& material) {
  return {material + ".cutting_energy", material + ".edge_force"};
}

// Parameters with which the shipped drill is fed into a block.
struct DrillRun {
  double rpm{1000.0};
  double feed_m_per_s{kFeed_m_per_s};
  double diameter_m{0.0032};
  bool edge_force{true};
  bool bends{false};
};

// Returns the result of a drill run in this material, which may differ from the shipped materials.
const ConstantFeedResult& Drilled(ValidationLab& lab, const simulation::Material& material,
                                  const DrillRun& run) {
  return lab.Drill({.config_root = {},
                    .material = material,
                    .diameter_m = run.diameter_m,
                    .spindle_rad_per_s = run.rpm * kRpm,
                    .steps = {{.feed_m_per_s = run.feed_m_per_s, .depth_m = lab.quick() ? 0.003 : 0.005}},
                    .edge_force = run.edge_force,
                    .bends = run.bends});
}
// Returns the result of a drill run in a shipped material.
const ConstantFeedResult& Drilled(ValidationLab& lab, const std::string& material, const DrillRun& run) {
  return Drilled(lab, lab.MaterialOf(material), run);
}

std::string HowDrilled(const std::string& material) {
  return fmt::format("twist_drill.yaml at constant feed into a block of {}, CPU engine, 1 kHz", material);
}

// The only variant of a row with a drill: its value with a tool that bends.
std::vector<ComplianceVariant> WithBending(double simulated) {
  return {{.part = CompliantPart::kTool, .simulated = simulated}};
}

using Figure = double ConstantFeedResult::*;

// Ratio of a figure at 1500 rpm to the figure at 1000 rpm. Both runs have the same feed per second; an
// ablation has the same feed per turn.
Simulated SpeedRatio(ValidationLab& lab, const std::string& material, Figure figure, double diameter_m) {
  const auto at = [&](double rpm, double feed_m_per_s, bool edge_force, bool bends = false) {
    return Drilled(lab, material,
                   {.rpm = rpm,
                    .feed_m_per_s = feed_m_per_s,
                    .diameter_m = diameter_m,
                    .edge_force = edge_force,
                    .bends = bends}).*
           figure;
  };
  const double slow = at(1000, kFeed_m_per_s, true);
  return {
      .value = at(1500, kFeed_m_per_s, true) / slow,
      .how = HowDrilled(material),
      .constants = RatioConstants(material),
      .ablations = {{"same feed a turn instead of a second", at(1500, 1.5 * kFeed_m_per_s, true) / slow},
                    {kWithoutEdge, at(1500, kFeed_m_per_s, false) / at(1000, kFeed_m_per_s, false)}},
      .reason =
          "the chip's force is proportional to the feed a turn, the edge's own force does not depend on it; "
          "a ratio that still falls short of the measured one asks for a larger share of the edge, one above "
          "it for a smaller one: the law takes one sharpness and one ratio of thrust to torque",
      .compliance = WithBending(at(1500, kFeed_m_per_s, true, true) / at(1000, kFeed_m_per_s, true, true))};
}

// Converts a lip's depth of cut to the drill's feed [m/s].
double FeedOf(double depth_of_cut_m, double rpm) { return depth_of_cut_m * kLips * rpm / 60.0; }

// Thrust [N] in cortical bone at this depth of cut. A fast feed brings the whole point of the drill into the
// bone, then the feed follows from the depth of cut.
double ThrustAt(ValidationLab& lab, double depth_of_cut_m, double rpm, bool edge_force = true) {
  const double point_in_m = 0.0022, way_m = lab.quick() ? 0.0002 : 0.0004;
  return lab
      .Drill({.config_root = {},
              .material = lab.MaterialOf("cortical"),
              .diameter_m = 0.0032,
              .spindle_rad_per_s = rpm * kRpm,
              .steps = {{.feed_m_per_s = kFeed_m_per_s, .depth_m = point_in_m},
                        {.feed_m_per_s = FeedOf(depth_of_cut_m, rpm), .depth_m = point_in_m + way_m}},
              .edge_force = edge_force})
      .thrust_N;
}

// Cortical bone whose constants follow from MacAvelia's figures at 1000 rpm alone, unlike in the shipped
// files. Nothing is then fitted to the thrusts at 1250 and 1500 rpm.
simulation::Material FittedAtOneSpeed(ValidationLab& lab) {
  constexpr double kTorque_Nm = 0.1863, kThrust_N = 198.4;
  simulation::Material bone = lab.MaterialOf("cortical");
  // At this depth of cut, the forces of chip and edge are equal. It stays as shipped, because it comes from
  // James's saw (14-depth).
  const double chip_energy =
      bone.specific_cutting_energy_J_per_m3 - bone.edge_force_N_per_m / bone.measured_chip_m;
  const double edge_depth_m = bone.edge_force_N_per_m / chip_energy;
  bone.name = "cortical by the figures at 1000 rpm";
  bone.specific_cutting_energy_J_per_m3 =
      (kTorque_Nm * 1000.0 * kRpm + kThrust_N * kFeed_m_per_s) / kRate_m3_per_s;
  bone.cutting_force_ratio = kTorque_Nm / (kThrust_N * 2.0 / 3.0 * kRadius_m);
  bone.measured_chip_m = kFeed_m_per_s * 60.0 / 1000.0 / kLips;
  bone.edge_force_N_per_m = bone.specific_cutting_energy_J_per_m3 * edge_depth_m * bone.measured_chip_m /
                            (bone.measured_chip_m + edge_depth_m);
  return bone;
}

constexpr const char* kShellByTorque = "shell.cutting_energy of the torque alone";

// The epoxy shell with a cutting energy that follows from Sawbones' torques (row 10) alone. The shipped
// energy was fitted to the thrusts of row 9 as well (a change of 2 %), so it cannot be used to judge them.
// The edge force is scaled with the energy.
simulation::Material ShellByTorque(ValidationLab& lab) {
  double energy_J_per_m3 = 0.0;
  for (const auto& [rpm, torque_Nm] :
       {std::pair{1000.0, 0.0672}, std::pair{1250.0, 0.0610}, std::pair{1500.0, 0.0533}})
    energy_J_per_m3 += torque_Nm * rpm * kRpm / kRate_m3_per_s / 3.0;
  simulation::Material shell = lab.MaterialOf("shell");
  shell.edge_force_N_per_m *= energy_J_per_m3 / shell.specific_cutting_energy_J_per_m3;
  shell.specific_cutting_energy_J_per_m3 = energy_J_per_m3;
  shell.name = "shell by the torque alone";
  return shell;
}

}  // namespace

Simulated Thrust(ValidationLab& lab, const std::string& material_name, double rpm) {
  const bool is_shell = material_name == "shell";
  const simulation::Material material = is_shell ? ShellByTorque(lab) : lab.MaterialOf(material_name);
  Simulated row{
      .value = Drilled(lab, material, {.rpm = rpm}).thrust_N,
      .how = HowDrilled(material.name),
      .constants = ConstantsOf(material_name),
      .ablations = {{"1000 rpm", Drilled(lab, material, {}).thrust_N},
                    {kWithoutEdge, Drilled(lab, material, {.rpm = rpm, .edge_force = false}).thrust_N}},
      .reason =
          "thrust falls with the speed more than measured: thrust and torque share one ratio, and the torque "
          "falls more than the thrust in the measured figures",
      .compliance = WithBending(Drilled(lab, material, {.rpm = rpm, .bends = true}).thrust_N)};
  if (is_shell) {
    row.constants[0] = kShellByTorque;
    row.reason += ", and the simulated drill takes 9 % less thrust than the energy balance in closed form";
    row.ablations.push_back({"the shipped cutting energy, in which the thrusts of row 9 have a part of 2 %",
                             Drilled(lab, material_name, {.rpm = rpm}).thrust_N});
  }
  if (material_name == "cortical" && rpm != 1000.0)
    row.ablations.push_back({"energy and force ratio fitted to torque and thrust at 1000 rpm alone",
                             Drilled(lab, FittedAtOneSpeed(lab), {.rpm = rpm}).thrust_N});
  return row;
}

Simulated MeanTorque(ValidationLab& lab, const std::string& material) {
  const auto mean_Nmm = [&](bool bends) {
    double sum_Nm = 0.0;
    for (const double rpm : {1000.0, 1250.0, 1500.0})
      sum_Nm += Drilled(lab, material, {.rpm = rpm, .bends = bends}).torque_Nm;
    return 1e3 * sum_Nm / 3.0;
  };
  return {.value = mean_Nmm(false),
          .how = HowDrilled(material),
          .constants = ConstantsOf(material),
          .compliance = WithBending(mean_Nmm(true))};
}

Simulated ThrustSpeedRatio(ValidationLab& lab, const std::string& material, double diameter_m) {
  return SpeedRatio(lab, material, &ConstantFeedResult::thrust_N, diameter_m);
}

Simulated TorqueSpeedRatio(ValidationLab& lab, const std::string& material, double diameter_m) {
  return SpeedRatio(lab, material, &ConstantFeedResult::torque_Nm, diameter_m);
}

Simulated SawboneOverCortex(ValidationLab& lab) {
  const double cortex_N = Drilled(lab, "cortical", {}).thrust_N;
  const simulation::Material shell = ShellByTorque(lab);
  simulation::Material own_ratio = shell;
  // the cutting force ratio from the torque and thrust of Sawbones, instead of that of human cortex
  own_ratio.cutting_force_ratio = 0.0672 / (87.2 * 2.0 / 3.0 * 0.0016);
  own_ratio.name = "shell with its own force ratio";
  const double own_N = Drilled(lab, own_ratio, {}).thrust_N;
  return {.value = Drilled(lab, shell, {}).thrust_N / cortex_N,
          .how = HowDrilled(shell.name) + ", and of cortical",
          .constants = {kShellByTorque, "cortical.cutting_energy", "cortical.cutting_force_ratio",
                        "shell.cutting_force_ratio", "cortical.edge_force", "shell.edge_force"},
          .ablations = {{"the shell with the force ratio of its own figures", own_N / cortex_N},
                        {"the shipped cutting energy of the shell",
                         Drilled(lab, "shell", {}).thrust_N / cortex_N}},
          .reason =
              "both cutting energies are means over three speeds, between which the measured forces do "
              "not fall as one over the speed",
          .compliance = WithBending(Drilled(lab, shell, {.bends = true}).thrust_N /
                                    Drilled(lab, "cortical", {.bends = true}).thrust_N)};
}

Simulated EnergyRatio(ValidationLab& lab) {
  const auto energy = [&](const std::string& material) {
    return Drilled(lab, material, {.rpm = 200, .feed_m_per_s = 0.0005}).energy_J_per_m3;
  };
  const double foam = energy("foam_15");
  simulation::Material dense = lab.MaterialOf("cancellous");
  dense.specific_cutting_energy_J_per_m3 = 0.21e9;  // the upper end of the range in bone.yaml
  dense.name = "cancellous at the upper end of its assumed range";
  const double dense_J = Drilled(lab, dense, {.rpm = 200, .feed_m_per_s = 0.0005}).energy_J_per_m3;
  return {
      .value = energy("cancellous") / foam,
      .how = HowDrilled("cancellous") + ", and of foam_15; work of spindle and feed over the volume",
      .constants = {"cancellous.cutting_energy", "foam_15.cutting_energy"},
      .ablations = {{"cancellous bone of 0.21 J/mm³, the upper end of its assumed range", dense_J / foam}},
      .reason =
          "both energies are assumed: cancellous bone's lies between 0.03 and 0.21 J/mm³, and foam's "
          "is the epoxy shell's scaled by density"};
}

Simulated DepthOfCutRatio(ValidationLab& lab) {
  const double thin_N = ThrustAt(lab, 2e-6, 1000);
  return {
      .value = ThrustAt(lab, 10e-6, 1000) / thin_N,
      .how = "twist_drill.yaml at 2 and 10 µm a lip and 1000 rpm into cortical, CPU engine, 1 kHz",
      .constants = {"cortical.edge_force"},
      .ablations = {{"6 µm over 2 µm", ThrustAt(lab, 6e-6, 1000) / thin_N},
                    {kWithoutEdge, ThrustAt(lab, 10e-6, 1000, false) / ThrustAt(lab, 2e-6, 1000, false)}}};
}

Simulated CuttingSpeedRatio(ValidationLab& lab) {
  return {.value = ThrustAt(lab, 10e-6, 2000) / ThrustAt(lab, 10e-6, 500),
          .how = "twist_drill.yaml at 10 µm a lip, 500 and 2000 rpm, into cortical, CPU engine, 1 kHz",
          .constants = RatioConstants("cortical")};
}

}  // namespace osteon::studies
