#include "config/reading/load_surgical_plan.h"

#include <stdexcept>

#include <fmt/format.h>

#include "base/units.h"
#include "config/reading/load_scene.h"
#include "config/reading/sections/read_bone.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

using procedure::GuidanceCeilings;
using procedure::GuidanceGains;
using procedure::SurgicalPlan;

constexpr double kMaxPlace_mm = 2000.0;  // largest accepted coordinate in G, in magnitude
constexpr std::size_t kMaxTools = 12;    // reamers or burrs of a plan

// Reads a point in the bone's frame G [m].
Vector3 ReadPosition(Reader& section, const std::string& key) {
  return section.Triple(key, -kMaxPlace_mm, kMaxPlace_mm);
}

// Reads a direction of the body. Its key is the word alone or the word with "_axis": "lateral" or
// "lateral_axis".
Vector3 BodyAxis(Reader& section, const std::string& word) {
  return section.Direction(section.Has(word) ? word : word + "_axis");
}

// Reads the pelvic tilt, and either landmarks or axes. Landmarks are stored in the plan, axes are returned.
// MakeFrame makes the pelvic frame from landmarks or axes after Finish().
procedure::PelvicFrame ReadPelvis(Reader& section, SurgicalPlan& plan) {
  procedure::PelvicFrame axes;
  // Either landmarks or axes are read. Keys of the other form are not read, so that Finish() refuses them as
  // unknown; the same holds for "lateral_axis" beside "lateral".
  if (!section.Has("asis_right_mm") && (section.Has("lateral") || section.Has("lateral_axis"))) {
    axes = {.lateral = BodyAxis(section, "lateral"),
            .anterior = BodyAxis(section, "anterior"),
            .superior = BodyAxis(section, "superior")};
  } else {
    plan.landmarks = procedure::PelvicLandmarks{.asis_right_m = ReadPosition(section, "asis_right_mm"),
                                                .asis_left_m = ReadPosition(section, "asis_left_mm"),
                                                .pubis_m = ReadPosition(section, "pubis_mm")};
  }
  if (section.Has("tilt_deg")) plan.tilt_rad = section.Number("tilt_deg", -45, 45);
  return axes;
}

// Reads the cup's place and angles, and the reamers. @returns the reamers' sections
std::vector<Reader> ReadCup(Reader& reader, Reader& section, SurgicalPlan& plan) {
  plan.centre_m = ReadPosition(section, "centre_mm");
  plan.cup_diameter_m = section.Number("diameter_mm", 20, 90);
  constexpr procedure::CupDefinition kDefinitions[] = {procedure::CupDefinition::kRadiographic,
                                                       procedure::CupDefinition::kOperative,
                                                       procedure::CupDefinition::kAnatomic};
  plan.definition = kDefinitions[section.Choice("definition", {"radiographic", "operative", "anatomic"})];
  plan.angles.inclination_rad = section.Number("inclination_deg", 0, 90);
  plan.angles.anteversion_rad = section.Number("anteversion_deg", -60, 90);
  std::vector<Reader> reamers = reader.Sections("reamers", 1, kMaxTools);
  for (Reader& reamer : reamers)
    plan.tools.push_back({.diameter_m = reamer.Number("diameter_mm", 20, 90),
                          .height_m = reamer.Number("height_mm", -20, 20)});
  return reamers;
}

// Reads the opening's end and axis, its target tissue, and the burrs. @returns the burrs' sections
std::vector<Reader> ReadOpening(Reader& reader, Reader& section, SurgicalPlan& plan) {
  plan.kind = procedure::PlanKind::kOpening;
  plan.centre_m = ReadPosition(section, "centre_mm");
  plan.axis_G = section.Direction("axis");
  plan.target = section.Text("target");
  std::vector<Reader> burrs = reader.Sections("burrs", 1, kMaxTools);
  for (Reader& burr : burrs) {
    const double diameter_m = burr.Number("diameter_mm", 0.3, 20),
                 height_m = burr.Number("height_mm", -20, 20);
    plan.cup_diameter_m = burr.Number("width_mm", 0.3, 60);
    plan.tools.push_back({.diameter_m = diameter_m,
                          .height_m = height_m,
                          .around_m = 0.5 * (plan.cup_diameter_m - diameter_m)});
  }
  return burrs;
}

// Makes the frame of an opening. Its superior axis is the opening's axis; the other two axes are as near to x
// and y of G as possible.
procedure::PelvicFrame FrameOfOpening(const Vector3& axis_G) {
  const Matrix3 R_GC = RotationFromZTo(axis_G);
  return {.lateral = R_GC.col(0), .anterior = R_GC.col(1), .superior = axis_G};
}

// Returns the material of the scene's region that the plan names.
std::string TargetMaterial(const Reader& opening, const std::string& target,
                           const simulation::SceneParams& scene) {
  std::string accepted;
  for (const simulation::RegionWatch& region : scene.events.regions) {
    if (region.name == target) return region.material;
    accepted += (accepted.empty() ? "" : ", ") + region.name;
  }
  opening.Refuse("target", fmt::format("found {}, accepted a region of the scene's events: {}", target,
                                       accepted.empty() ? "it has none" : accepted));
}

void ReadCone(Reader section, GuidanceGains::Cone& cone) {
  cone.free_rad = section.Number("free_deg", 0.1, 45);
  cone.stop_rad = section.Number("stop_deg", 0.1, 60);
  cone.ease_rad = section.Number("ease_deg", 0.01, 10);
  cone.stiffness_Nm_per_rad =
      section.Number("stiffness_Nm_per_rad", 0, GuidanceCeilings::kConeStiffness_Nm_per_rad);
  cone.cap_Nm = section.Number("cap_Nm", 0, GuidanceCeilings::kConeCap_Nm);
}

void ReadLateral(Reader section, GuidanceGains::Lateral& lateral) {
  lateral.free_m = section.Number("free_mm", 0, 50);
  lateral.stop_m = section.Number("stop_mm", 0.1, 100);
  lateral.widening_rad = section.Number("widening_deg", 0, 60);
  lateral.ease_m = section.Number("ease_mm", 0.01, 10);
  lateral.stiffness_N_per_m =
      section.Number("stiffness_N_per_mm", 0, 1e-3 * GuidanceCeilings::kLateralStiffness_N_per_m);
  lateral.cap_N = section.Number("cap_N", 0, GuidanceCeilings::kLateralCap_N);
}

void ReadDepth(Reader section, GuidanceGains::Depth& depth) {
  depth.soft_m = section.Number("soft_mm", -10, 20);
  depth.ease_m = section.Number("ease_mm", 0.01, 10);
  depth.stiffness_N_per_m =
      section.Number("stiffness_N_per_mm", 0, 1e-3 * GuidanceCeilings::kDepthStiffness_N_per_m);
  depth.cap_N = section.Number("cap_N", 0, GuidanceCeilings::kDepthCap_N);
}

// Refuses a stop that does not lie beyond the end of the free range. @param unit  factor from SI to the key's
// unit
void CheckStop(const Reader& section, const char* key, double free, double stop, double unit) {
  if (stop > free) return;
  section.Refuse(key, fmt::format("found {:.6g}, accepted more than where the guidance begins ({:.6g})",
                                  stop * unit, free * unit));
}

// The sections of the guidance that have a stop. CheckStops requires that each stop lies beyond the section's
// free range.
struct GuidanceSections {
  Reader cone, lateral;
  std::optional<Reader> cup_cone;  // only in the plan of a cup
};

GuidanceSections ReadGuidance(Reader section, bool is_opening, GuidanceGains& gains) {
  GuidanceSections sections{
      .cone = section.Section("cone"), .lateral = section.Section("lateral"), .cup_cone = {}};
  gains.gain = section.Number("gain_ratio", 0, 1);
  ReadCone(sections.cone, gains.cone);
  ReadLateral(sections.lateral, gains.lateral);
  ReadDepth(section.Section("depth"), gains.depth);
  gains.return_m_per_s = section.Number("return_mm_per_s", 1, 250);
  gains.return_rad_per_s = section.Number("return_rad_per_s", 0.01, 10);
  gains.spindle = section.Choice("spindle", {"stop_outside", "free"}) == 0
                      ? GuidanceGains::OutsideSpindle::kStop
                      : GuidanceGains::OutsideSpindle::kFree;
  if (is_opening) return sections;
  sections.cup_cone = section.Section("cup_cone");
  gains.cup_cone = {.free_rad = sections.cup_cone->Number("free_deg", 0.1, 45),
                    .stop_rad = sections.cup_cone->Number("stop_deg", 0.1, 60)};
  return sections;
}

void CheckStops(const GuidanceSections& sections, const GuidanceGains& gains) {
  CheckStop(sections.cone, "stop_deg", gains.cone.free_rad, gains.cone.stop_rad, 1.0 / kDegree);
  if (sections.cup_cone)
    CheckStop(*sections.cup_cone, "stop_deg", gains.cup_cone.free_rad, gains.cup_cone.stop_rad,
              1.0 / kDegree);
  CheckStop(sections.lateral, "stop_mm", gains.lateral.free_m, gains.lateral.stop_m, 1e3);
}

// Checks that the tools' diameters rise and that their widths do not fall.
void CheckSequence(const std::vector<Reader>& sections, const std::vector<procedure::PlannedTool>& tools) {
  for (std::size_t i = 0; i < tools.size(); ++i) {
    const procedure::PlannedTool& tool = tools[i];
    if (tool.around_m < 0.0)
      sections[i].Refuse("width_mm",
                         fmt::format("found {:.6g}, accepted the burr's diameter ({:.6g}) and more",
                                     1e3 * tool.width_m(), 1e3 * tool.diameter_m));
    if (i == 0) continue;
    const procedure::PlannedTool& previous = tools[i - 1];
    if (!(tool.diameter_m > previous.diameter_m))
      sections[i].Refuse("diameter_mm", fmt::format("found {:.6g} after {:.6g}, accepted diameters that rise",
                                                    1e3 * tool.diameter_m, 1e3 * previous.diameter_m));
    if (tool.width_m() < previous.width_m())
      sections[i].Refuse("width_mm",
                         fmt::format("found {:.6g} after {:.6g}, accepted widths that do not fall",
                                     1e3 * tool.width_m(), 1e3 * previous.width_m()));
  }
}

// Makes the pelvic frame from the plan's landmarks, or else checks the axes that were read.
procedure::PelvicFrame MakeFrame(Reader& pelvis, const procedure::PelvicFrame& axes,
                                 const SurgicalPlan& plan) {
  try {
    if (plan.landmarks) return procedure::FrameOf(*plan.landmarks, plan.side);
    procedure::CheckFrame(axes, plan.side);
    return axes;
  } catch (const std::invalid_argument& error) {
    pelvis.Refuse(plan.landmarks           ? "pubis_mm"
                  : pelvis.Has("anterior") ? "anterior"
                                           : "anterior_axis",
                  error.what());
  }
}

simulation::CutSite ReadMeshCup(Reader cup) {
  return {.center_m = cup.Triple("center_mm", -2000, 2000),
          .axis = cup.Direction("outward_axis"),
          .radius_m = cup.Number("radius_mm", 0.5, 60)};
}

// Reads the plan's bone: a mesh or packing with its cup, or the cup of a mesh that the command will name.
// @param scene  replaced by the bone's own scene, if it names one
void ReadPlannedBone(Reader bone, std::filesystem::path& scene, SurgicalPlanConfig& config) {
  if (bone.Has("mesh") || bone.Has("packing"))
    config.bone = ReadBone(bone, scene);
  else
    config.mesh_cup = ReadMeshCup(bone.Section("cup"));
}

// Returns the site of the plan's bone, without making the bone's packing. Refuses a packing file without
// `cup`, since the site in a packing file is not known before that file is read.
simulation::CutSite SiteOf(const Reader& reader, const SurgicalPlanConfig& config) {
  if (!config.bone && !config.mesh_cup) return simulation::MakeSceneSolid(config.scene).site;
  if (config.bone && !config.bone->cup)
    reader.Refuse("bone",
                  "found a packing without cup, accepted one with its cup: the plan is held against it");
  simulation::CutSite site = config.bone ? *config.bone->cup : *config.mesh_cup;
  site.axis = Vector3(site.axis).normalized();
  return site;
}

}  // namespace

SurgicalPlanConfig LoadSurgicalPlan(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  SurgicalPlanConfig config;
  SurgicalPlan& plan = config.plan;
  plan.name = path.stem().string();
  std::filesystem::path scene = reader.File("scene", "scenes");
  if (reader.Has("bone")) ReadPlannedBone(reader.Section("bone"), scene, config);
  const bool is_opening = reader.Has("kind") && reader.Choice("kind", {"cup", "opening"}) == 1;
  std::optional<Reader> pelvis;
  procedure::PelvicFrame axes;
  if (!is_opening) {
    plan.side =
        reader.Choice("side", {"right", "left"}) == 0 ? procedure::Side::kRight : procedure::Side::kLeft;
    pelvis = reader.Section("pelvis");
    axes = ReadPelvis(*pelvis, plan);
    plan.native_centre_m = ReadPosition(reader, "native_centre_mm");
  }
  Reader goal = reader.Section(is_opening ? "opening" : "cup");
  const std::vector<Reader> tools =
      is_opening ? ReadOpening(reader, goal, plan) : ReadCup(reader, goal, plan);
  plan.tool_change = reader.Choice("tool_change", {"virtual", "physical"}) == 0
                         ? procedure::ToolChange::kVirtual
                         : procedure::ToolChange::kPhysical;
  std::optional<GuidanceSections> guidance;
  if (reader.Has("guidance")) guidance = ReadGuidance(reader.Section("guidance"), is_opening, plan.guidance);
  reader.Finish();
  if (guidance) CheckStops(*guidance, plan.guidance);
  CheckSequence(tools, plan.tools);

  config.scene = LoadScene(scene);
  if (is_opening) {
    plan.axis_G.normalize();
    plan.pelvis = FrameOfOpening(plan.axis_G);
    plan.target = TargetMaterial(goal, plan.target, config.scene);
  } else {
    plan.pelvis = procedure::Tilted(MakeFrame(*pelvis, axes, plan), plan.tilt_rad);
    plan.axis_G = plan.pelvis.ToG(procedure::CupAxis_N(plan.definition, plan.angles)).normalized();
  }
  config.site = SiteOf(reader, config);
  if (const std::string wrong = procedure::SiteError(plan, config.site); !wrong.empty())
    goal.Refuse(is_opening ? "axis" : "anteversion_deg", wrong);
  return config;
}

}  // namespace osteon::config
