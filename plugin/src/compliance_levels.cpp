#include "plugin/src/compliance_levels.h"

#include <fmt/format.h>

#include "config/reading/sections/compliance_params.h"
#include "plugin/src/convert.h"
#include "plugin/src/result.h"

namespace osteon::plugin {
namespace {

constexpr double kMinPeriod_s = 1e-4, kMaxTick_s = 0.02;  // accepted range of period_s

void CheckRange(const char* name, double value, double least, double most) {
  if (!(value >= least && value <= most))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("{}: found {}, accepted {} … {}", name, value, least, most));
}

Vector3 Triple(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

void CopyTo(double (&to)[3], const PlainVector3& from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }

/// Returns the parameters of the bone's mount. @throws std::invalid_argument if a value is out of range.
control::BoneMountParams MountOf(const OsteonComplianceParams& params) {
  control::BoneMountParams mount;
  mount.p_WMo_m = Triple(params.mount_point_m);
  mount.mass_kg = params.mount_mass_kg;
  mount.inertia_kg_m2 = Triple(params.mount_inertia_kg_m2);
  mount.stiffness_N_per_m = Triple(params.mount_stiffness_N_per_m);
  mount.stiffness_Nm_per_rad = Triple(params.mount_stiffness_Nm_per_rad);
  mount.damping_ratio = params.mount_damping_ratio;
  mount.creep_N_per_m = params.mount_creep_N_per_m;
  mount.creep_tau_s = params.mount_creep_s;
  control::Validate(mount);
  return mount;
}

/// @throws Failure if there is a refusal, with `prefix`, the refused key and the refusal's text.
void ThrowRefusal(const char* prefix, const std::optional<config::ComplianceRefusal>& refusal) {
  if (refusal)
    throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("{}{}: {}", prefix, refusal->key, refusal->text));
}

}  // namespace

std::optional<control::Compliance> MakeCompliance(const OsteonComplianceParams& params,
                                                  const BoneSource& bone, const ToolSource& tool,
                                                  const CouplingFigures& coupling) {
  control::ComplianceParams levels;
  CheckRange("period_s", params.period_s, kMinPeriod_s, kMaxTick_s);
  CheckRange("push_N", params.push_N, 0.0, 1e4);
  CheckRange("noticed_m", params.noticed_m, 1e-6, 0.1);
  levels.noticed_m = params.noticed_m;
  if (params.tool != 0) {
    if (!tool.compliance)
      throw Failure(
          OSTEON_ERROR_ARGUMENT,
          fmt::format("tool: found {}, which counts as rigid; accepted a tool with `bending` in its file",
                      tool.tool.name));
    ThrowRefusal("", config::CheckToolLink(*tool.compliance, tool.relaxation_s, params.push_N));
    levels.tool = config::ToolLinkOf(*tool.compliance, tool.relaxation_s, params.push_N);
  }
  if (params.layer != 0) {
    levels.layer = config::SurfaceLayerOf(bone.bone.materials, tool.tool, coupling.engaged_layer_m);
    if (!config::HasLayer(*levels.layer))
      throw Failure(
          OSTEON_ERROR_ARGUMENT,
          fmt::format("layer: found no soft tissue in bone {}, accepted one with a material that has "
                      "layer_N_per_mm3",
                      bone.bone.name));
  }
  ThrowRefusal("", config::CheckMassless(levels, coupling.stiffness_N_per_m, params.period_s));
  if (params.mount != 0) {
    levels.mount = MountOf(params);
    ThrowRefusal("mount_", config::CheckMountAlone(*levels.mount, coupling.stiffness_N_per_m, params.period_s,
                                                   Vector3(bone.bone.site.center_m)));
  }
  if (!levels.any()) return std::nullopt;
  return control::Compliance(levels, params.period_s);
}

Pose HeadInBone(const Deflected& deflected, const Pose& X_GT) noexcept {
  const control::ComplianceRecord& r = deflected.record;
  if (!r.present) return X_GT;
  control::Vector6 bend;
  bend << Vector3(r.bend_m), Vector3(r.bend_rad);
  return Pose(r.X_WM).inverse() * X_GT * control::BentHead(bend);
}

OsteonDeflection DeflectionOf(const Deflected& deflected) noexcept {
  const control::ComplianceRecord& r = deflected.record;
  OsteonDeflection result{};
  result.head = FromPose(r.X_ME);
  result.bone = FromPose(r.X_WM);
  if (!r.present) return result;
  CopyTo(result.bend_m, r.bend_m);
  CopyTo(result.bend_rad, r.bend_rad);
  CopyTo(result.layer_m, r.layer_m);
  CopyTo(result.mount_m, r.mount_m);
  CopyTo(result.mount_rad, r.mount_rad);
  CopyTo(result.mount_m_per_s, r.mount_m_per_s);
  CopyTo(result.mount_rad_per_s, r.mount_rad_per_s);
  result.gives_way = 1;
  result.noticed = deflected.noticed ? 1 : 0;
  result.beyond_limit = deflected.beyond_limit ? 1 : 0;
  return result;
}

}  // namespace osteon::plugin
