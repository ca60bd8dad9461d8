// Reams the shipped acetabulum with Eigen's types: hand and reamer are a mass of 2 kg, which is pressed with
// 40 N along the cup's axis. The bone stops the mass, and lets it in as it is cut.
//
//     find_package(osteon 1.0 REQUIRED)
//     find_package(Eigen3 REQUIRED NO_MODULE)
//     target_link_libraries(mine PRIVATE osteon::osteon Eigen3::Eigen)
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <osteon.h>
#include <Eigen/Geometry>

namespace {

struct Destroy {
  void operator()(OsteonBone* bone) const { osteon_bone_destroy(bone); }
  void operator()(OsteonTool* tool) const { osteon_tool_destroy(tool); }
  void operator()(OsteonSession* session) const { osteon_session_destroy(session); }
};

// Ends the program with the library's text if a call has failed.
void Check(OsteonResult result) {
  if (result == OSTEON_OK) return;
  std::fprintf(stderr, "%s: %s\n", osteon_result_text(result), osteon_last_error());
  std::exit(1);
}

Eigen::Isometry3d ToEigen(const OsteonPose& pose) {
  const double* q = pose.orientation_wxyz;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  X.translation() = Eigen::Map<const Eigen::Vector3d>(pose.position_m);
  return X;
}

OsteonPose FromEigen(const Eigen::Isometry3d& X) {
  const Eigen::Quaterniond q(X.linear());
  const Eigen::Vector3d p = X.translation();
  return {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace

int main() {
  OsteonBoneParams bone_params;
  osteon_bone_params_default(&bone_params);
  OsteonBone* made_bone = nullptr;
  Check(osteon_bone_create(OSTEON_ABI, &bone_params, &made_bone));
  const std::unique_ptr<OsteonBone, Destroy> bone(made_bone);

  OsteonToolParams tool_params;
  osteon_tool_params_default(&tool_params);
  OsteonTool* made_tool = nullptr;
  Check(osteon_tool_create(OSTEON_ABI, &tool_params, &made_tool));
  const std::unique_ptr<OsteonTool, Destroy> tool(made_tool);

  OsteonSettings settings;
  osteon_settings_default(&settings);
  settings.lockstep = 1;
  OsteonSession* made_session = nullptr;
  Check(osteon_session_create(OSTEON_ABI, bone.get(), tool.get(), &settings, &made_session));
  const std::unique_ptr<OsteonSession, Destroy> session(made_session);

  OsteonPose start;  // the apex 17 mm below the site's centre, still free of bone
  Check(osteon_bone_approach(bone.get(), -0.017, &start));
  Eigen::Isometry3d X_GT = ToEigen(start);
  const Eigen::Vector3d push_N = 40.0 * X_GT.linear().col(2);  // the feed
  const double mass_kg = 2.0, damping_Ns_per_m = 60.0, dt_s = 0.001;
  Eigen::Vector3d v_GT = Eigen::Vector3d::Zero();
  for (int ms = 0; ms <= 4000; ++ms) {
    const OsteonPose pose = FromEigen(X_GT);
    Check(osteon_session_step(session.get(), &pose, osteon_tool_spindle_rad_per_s(tool.get()), dt_s));
    OsteonTwist twist{};
    Eigen::Map<Eigen::Vector3d>(twist.linear_m_per_s) = v_GT;
    OsteonWrench wrench;
    Check(osteon_session_evaluate(session.get(), &pose, &twist, &wrench));
    const Eigen::Map<const Eigen::Vector3d> force_N(wrench.force_N);
    // the mass moves under the push, the bone's force and the hand's damping
    v_GT += dt_s / mass_kg * (push_N + force_N - damping_Ns_per_m * v_GT);
    X_GT.translation() += dt_s * v_GT;
    if (ms % 1000 != 0) continue;
    OsteonFigures figures;
    Check(osteon_session_figures(session.get(), &figures));
    std::printf("%4.1f s  fed %6.2f mm  force %6.1f N  removed %7.1f mm3\n", 1e-3 * ms,
                1e3 * (ToEigen(start).inverse() * X_GT).translation().z(), force_N.norm(),
                1e9 * figures.removed_volume_m3);
  }
  return 0;
}
