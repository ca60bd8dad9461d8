#include "simulation/methods/method_base.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {

MethodBase::MethodBase(Method method, const Bone& bone, const Tool& tool, const Pose& X_WG,
                       const CuttingParams& params)
    : tool_(tool),
      materials_(MaterialsUnderTool(bone, tool, params)),
      params_(params),
      method_(method),
      X_WG_(X_WG),
      map_(bone) {
  if (materials_.empty() || materials_.size() > kMaxMaterials)
    throw std::invalid_argument(
        fmt::format("bone: found {} materials, accepted 1 … {}", materials_.size(), kMaxMaterials));
  if (!CuttingHead(tool_)) throw std::invalid_argument("tool: found no cutting ball, accepted at least one");
}

ContactModel MethodBase::Step(const FrameInput& input) {
  if (!IsUsable(input)) {
    ContactModel refused;
    refused.status = EngineStatus::kBadInput;
    return refused;
  }
  const Pose X_WT = input.X_WT;
  const Pose X_GT = X_WG_.inverse() * X_WT;
  if (!memory_.has_proxy) memory_.X_GP = X_GT;
  const MethodFrame frame = Solve(memory_.X_GP, X_GT, input);

  // store the proxy for the next frame, and add up the removed volumes
  memory_.X_GP = frame.X_GP;
  memory_.has_proxy = true;
  ++memory_.frame;
  BookRemoved(params_, materials_, frame.removed_m3, frame.edge_work_J, memory_);
  memory_.cutting_work_J += frame.ploughing_work_J;

  ContactModel model;
  model.X_WP = X_WG_ * memory_.X_GP;
  model.contact_fraction = frame.contact_fraction;
  model.removed_volume_m3 = memory_.removed_volume_m3;
  model.removed_mass_kg = memory_.removed_mass_kg;
  model.cutting_work_J = memory_.cutting_work_J;
  model.pose_stamp = input.stamp;
  model.frame = memory_.frame;
  if (input.spindle_rad_per_s != 0.0 && input.dt_s > 0.0) {
    model.advance_m_per_s = frame.advance_m / input.dt_s;
    model.spindle_torque_Nm =
        (frame.edge_work_J + frame.ploughing_work_J) / (std::abs(input.spindle_rad_per_s) * input.dt_s);
  }
  for (const double area : frame.engaged.area_m2) model.engaged_area_m2 += area;
  if (!frame.touches) return model;

  const Matrix3 R_WG = X_WG_.linear();
  model.n_W = Vector3(R_WG * frame.n);
  model.F_T_W = Wrench{.f = R_WG * frame.force_N, .t = R_WG * frame.torque_Nm};
  if (frame.n.isZero()) return model;
  Contact& contact = model.contacts[0];
  model.contact_count = 1;
  contact.p_TP_m = Vector3(X_GT.inverse() * frame.point_m);
  contact.n_W = model.n_W;
  const Vector3 on_bone_m = frame.point_m + frame.depth_m * frame.n;
  contact.p_W_m = Vector3(X_WG_ * on_bone_m);
  contact.gap_m = -frame.depth_m;
  contact.stiffness_N_per_m = params_.stiffness_N_per_m;
  contact.weight = 1.0;
  contact.material = frame.touch_cuts && model.engaged_area_m2 > 0.0
                         ? static_cast<MaterialIndex>(std::ranges::max_element(frame.engaged.area_m2) -
                                                      frame.engaged.area_m2.begin())
                         : map_.At(on_bone_m);
  contact.mu = contact.material < materials_.size() ? materials_[contact.material].friction : 0.0;
  if (frame.touch_cuts) contact.advance_m_per_s = model.advance_m_per_s;
  return model;
}

CarvedState MethodBase::Snapshot() const {
  CarvedState state;
  SaveBone(state);
  ToState(memory_, state);
  return state;
}

void MethodBase::Restore(const CarvedState& state) {
  LoadBone(state);
  memory_ = ToMemory(state);
}

// Measures the area as the reference engine does: the item's volume, if it lies in a layer at the surface of
// the nearest cutting ball, divided by the layer's depth.
void MethodBase::AddEngaged(const EngagedItem& item, double layer_m, std::size_t found_by,
                            const ToolPoints& at, const Vector3& spindle_axis, MethodFrame& frame) const {
  // skip an item that was already counted for a ball with a lower index
  for (std::size_t t = 0; t < found_by; ++t)
    if (tool_.balls[t].cutting && std::abs((item.p_m - at[t]).norm() - tool_.balls[t].radius_m) < layer_m)
      return;
  double nearest_gap_m = layer_m;
  // cosine of the angle between the nearest ball's surface at the item and the contact's plane
  double projection = 0.0;
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if (!tool_.balls[t].cutting) continue;
    const Vector3 out = item.p_m - at[t];
    const double distance = out.norm(), gap = distance - tool_.balls[t].radius_m;
    if (std::abs(gap) >= layer_m || gap >= nearest_gap_m) continue;
    nearest_gap_m = gap;
    projection = distance > 0.0 ? std::max(0.0, -frame.n.dot(out) / distance) : 0.0;
  }
  const double area = item.volume_m3 / layer_m * projection;
  frame.engaged.area_m2[item.material] += area;
  frame.engaged.moment_m3[item.material] += area * (item.p_m - at.back()).cross(spindle_axis).norm();
}

void MethodBase::Advance(const FrameInput& input, double slide_m, MethodFrame& frame) const {
  FrameSolution solution;
  solution.n = frame.n;
  solution.cutting_m = frame.touch_cuts ? frame.depth_m : 0.0;
  solution.slide_m = slide_m;
  solution.engaged_area_m2 = frame.engaged.area_m2;
  solution.engaged_moment_m3 = frame.engaged.moment_m3;
  const FrameAdvance advance = ComputeAdvance(params_, materials_, solution, input.spindle_rad_per_s,
                                              input.dt_s, memory_.energy_lead_J);
  frame.advance_m = advance.advance_m;
  frame.edge_work_J = advance.edge_work_J;
  frame.ploughing_work_J = advance.ploughing_work_J;
}

void MethodBase::PushAlongNormal(const Vector3& origin_T, MethodFrame& frame) const {
  frame.force_N = std::min(params_.stiffness_N_per_m * frame.depth_m, params_.max_force_N) * frame.n;
  frame.torque_Nm = (frame.point_m - origin_T).cross(frame.force_N);
}

}  // namespace osteon::simulation
