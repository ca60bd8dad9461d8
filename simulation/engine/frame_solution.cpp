#include "simulation/engine/frame_solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "simulation/contact/constrained_goal.h"

namespace osteon::simulation {
namespace {

// A proxy's quaternion is normalised if its squared norm differs from 1 by more than this.
constexpr double kMaxNormError = 1e-12;

double Sum(const std::array<double, kMaxMaterials>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum;
}

// Mean of mu_c r over the engaged area [m]: cutting-force ratio times distance from the spindle's axis; 0 if
// nothing is engaged.
double CuttingArm(const std::vector<Material>& materials, const FrameSolution& solution) {
  const double area = Sum(solution.engaged_area_m2);
  if (area <= 0.0) return 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < materials.size(); ++i)
    moment += materials[i].cutting_force_ratio * solution.engaged_moment_m3[i];
  return moment / area;
}

// Force of the coupling on the cutting planes, at most max_force_N [N].
double CuttingForce_N(const CuttingParams& params, const FrameSolution& solution) {
  return std::min(params.stiffness_N_per_m * solution.cutting_m, params.max_force_N);
}

// Work that the spindle can do in the frame on an edge that is pressed into bone with the frame's cutting
// force [J].
double AvailableWork(const CuttingParams& params, const std::vector<Material>& materials,
                     const FrameSolution& solution, double spindle_rad_per_s, double dt_s) {
  return CuttingForce_N(params, solution) * std::abs(spindle_rad_per_s) * CuttingArm(materials, solution) *
         dt_s;
}

// Adds the contact law's contacts and their wrench to the model.
// @param engaged  the material with the largest engaged area; nothing: none is engaged
void AddContacts(const CuttingParams& params, const std::vector<Material>& materials, const MaterialMap& map,
                 std::optional<MaterialIndex> engaged, const Pose& X_WG, const Pose& X_WT, bool cutting,
                 double dt_s, const FrameSolution& solution, ContactModel& model) {
  const Pose X_GW = X_WG.inverse();
  const std::span solved(solution.contacts.data(), static_cast<std::size_t>(solution.contact_count));
  double weight_sum = 0.0;
  for (const SolvedContact& from : solved) weight_sum += from.weight;
  Wrench F_T_W;
  for (const SolvedContact& from : solved) {
    Contact& contact = model.contacts[static_cast<std::size_t>(model.contact_count++)];
    contact.stiffness_N_per_m = params.stiffness_N_per_m;
    const Vector3 n_W = X_WG.linear() * from.n, lever_W = X_WT.linear() * from.p_T_m;
    if (cutting && from.cutting)
      contact.advance_m_per_s = model.advance_m_per_s * std::max(0.0, from.n.dot(solution.n));
    // the bone that was cut in this frame is gone, so move the plane back, but at most until the gap is 0
    contact.gap_m = from.gap_m;
    if (from.gap_m < 0.0 && cutting)
      contact.gap_m = std::min(0.0, from.gap_m + contact.advance_m_per_s * dt_s);
    contact.p_TP_m = from.p_T_m;
    contact.n_W = n_W;
    const Vector3 p_W = X_WT.translation() + lever_W - contact.gap_m * n_W;
    contact.p_W_m = p_W;
    contact.material = from.cutting && engaged ? *engaged : map.At(X_GW * p_W);
    contact.mu = contact.material < materials.size() ? materials[contact.material].friction : 0.0;
    contact.weight = weight_sum > 0.0 ? from.weight / weight_sum : 0.0;
    const Vector3 f = params.stiffness_N_per_m * from.multiplier_m * n_W;
    F_T_W.f += f;
    F_T_W.t += lever_W.cross(f);
  }
  model.F_T_W = F_T_W;
}

// Friction coefficient for the next frame: the mean of the touched materials, weighted by engaged area. If
// nothing is engaged, the coefficient of the contact with the largest multiplier; if no contact holds, that
// of the nearest contact; without contacts, that of the first material.
double FrictionOf(const std::vector<Material>& materials, const FrameSolution& solution,
                  const ContactModel& model) {
  const double area_m2 = Sum(solution.engaged_area_m2);
  double friction = 0.0;
  for (std::size_t i = 0; i < materials.size(); ++i)
    friction += solution.engaged_area_m2[i] * materials[i].friction;
  if (area_m2 > 0.0) return friction / area_m2;
  const std::span solved(solution.contacts.data(), static_cast<std::size_t>(solution.contact_count));
  if (solved.empty()) return materials.empty() ? 0.0 : materials[0].friction;
  const auto strongest = std::ranges::max_element(solved, {}, &SolvedContact::multiplier_m);
  return model.contacts[static_cast<std::size_t>(strongest - solved.begin())].mu;
}

// Whether the pose is finite and its matrix a rotation.
bool IsPose(const Pose& X) {
  return X.matrix().allFinite() &&
         (X.linear() * X.linear().transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         X.linear().determinant() > 0.0;
}

// Checks a count or index of a carved state. @throws std::invalid_argument if it is negative or above its
// limit.
template <class Value>
void CheckAtMost(const char* what, Value found, std::int64_t max) {
  if (static_cast<std::int64_t>(found) >= 0 && static_cast<std::int64_t>(found) <= max) return;
  throw std::invalid_argument(fmt::format("carved state: {}: found {}, accepted 0 … {}", what, found, max));
}

}  // namespace

double MaxSlide(const CuttingParams& params, const FrameInput& input) {
  const bool advances = params.law == RemovalLaw::kRate && input.spindle_rad_per_s != 0.0 && input.dt_s > 0.0;
  return params.max_slide_m * (advances ? kSlideShare : 1.0);
}

Vector3 ComputeAdvanceStep(const CuttingParams& params, const FrameInput& input,
                           const FrameSolution& solution, const Vector3& origin_goal) {
  const bool cutting = input.spindle_rad_per_s != 0.0 && input.dt_s > 0.0;
  const bool held_by_shaft_alone = solution.advance_m <= 0.0 && solution.delta != Vector3::Zero();
  if (params.law == RemovalLaw::kImmediate && cutting && !held_by_shaft_alone)
    return origin_goal - solution.origin_slid;
  return -solution.advance_m * solution.n;
}

Vector3 ComputeAdvanceEnd(const FrameSolution& solution) {
  Vector3 step = solution.step;
  for (int i = 0; i < solution.shaft_count; ++i) {
    const ShaftPlane& shaft = solution.shaft[static_cast<std::size_t>(i)];
    const double gap_m = shaft.gap_m + shaft.n.dot(solution.origin_slid - solution.origin_contact);
    const double closing_m = -shaft.n.dot(step) - std::max(0.0, gap_m);
    if (closing_m > 0.0) step += closing_m * shaft.n;
  }
  return solution.origin_slid + step;
}

std::vector<Material> MaterialsUnderTool(const Bone& bone, const Tool& tool, const CuttingParams& params) {
  return SplitCuttingEnergy(bone.materials, params.edge_force ? CuttingEdges(tool) : 0);
}

double PloughingWork(const CuttingParams& params, const std::vector<Material>& materials,
                     const FrameSolution& solution, double spindle_rad_per_s, double dt_s) {
  if (params.law == RemovalLaw::kImmediate || solution.cutting_m <= 0.0 || dt_s <= 0.0) return 0.0;
  double per_pass_J = 0.0;
  for (std::size_t i = 0; i < materials.size(); ++i)
    per_pass_J += materials[i].edge_force_N_per_m * solution.engaged_area_m2[i];
  if (per_pass_J <= 0.0) return 0.0;
  return std::min(std::abs(spindle_rad_per_s) * dt_s / (2.0 * std::numbers::pi) * per_pass_J,
                  AvailableWork(params, materials, solution, spindle_rad_per_s, dt_s));
}

FrameAdvance ComputeAdvance(const CuttingParams& params, const std::vector<Material>& materials,
                            const FrameSolution& solution, double spindle_rad_per_s, double dt_s,
                            double energy_lead_J) {
  const double x = solution.cutting_m;  // penetration into the cutting planes [m]
  if (x <= 0.0 || spindle_rad_per_s == 0.0 || dt_s <= 0.0) return {};
  double work_per_m = 0.0;  // work per advance [J/m]
  for (std::size_t i = 0; i < materials.size(); ++i)
    work_per_m += materials[i].specific_cutting_energy_J_per_m3 * solution.engaged_area_m2[i];
  const double available_J = AvailableWork(params, materials, solution, spindle_rad_per_s, dt_s);
  if (params.law == RemovalLaw::kImmediate) return {.advance_m = x, .edge_work_J = available_J};
  // if there are no mass points around the bone balls, these do not hold the tool: advance without work
  const double max_m = std::max(0.0, params.max_slide_m - solution.slide_m);
  if (work_per_m <= 0.0) return {.advance_m = std::min(x, max_m), .edge_work_J = 0.0};
  const double ploughing_J = PloughingWork(params, materials, solution, spindle_rad_per_s, dt_s);
  const double work_J = available_J - ploughing_J;
  // work that may remove more bone, after part of the energy lead has been paid back
  const double paid_J = std::max(0.0, work_J - energy_lead_J * std::min(1.0, dt_s / kEnergyLeadSeconds));
  const double linear_m = paid_J / work_per_m;  // advance if the force stayed constant
  if (linear_m <= 0.0) return {.advance_m = 0.0, .edge_work_J = work_J, .ploughing_work_J = ploughing_J};
  // penetration in excess of the one at which the coupling's force equals the edges' force
  const double beyond_m = ploughing_J > 0.0 ? x * (work_J / available_J) : x;
  const double advance_m = std::min(beyond_m * -std::expm1(-linear_m / beyond_m), max_m);
  return {
      .advance_m = advance_m, .edge_work_J = work_J * advance_m / linear_m, .ploughing_work_J = ploughing_J};
}

void BookRemoved(const CuttingParams& params, const std::vector<Material>& materials,
                 const std::array<double, kMaxMaterials>& removed_m3, double edge_work_J,
                 FrameMemory& memory) {
  double work_J = 0.0;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    memory.removed_volume_m3 += removed_m3[i];
    memory.removed_mass_kg += removed_m3[i] * materials[i].density_kg_per_m3;
    work_J += removed_m3[i] * materials[i].specific_cutting_energy_J_per_m3;
  }
  memory.cutting_work_J += work_J;
  memory.energy_lead_J = params.law == RemovalLaw::kRate ? memory.energy_lead_J + work_J - edge_work_J : 0.0;
}

ContactModel FinishFrame(const CuttingParams& params, const std::vector<Material>& materials,
                         const MaterialMap& map, const Pose& X_WG, const FrameInput& input,
                         const FrameSolution& solution, FrameMemory& memory) {
  const Pose X_WT = input.X_WT;
  const Pose X_GT = X_WG.inverse() * X_WT;
  const Matrix3 R_WG = X_WG.linear();

  // the proxy turns by the fractions of its two paths: up to first contact, and along the slide
  const double turned =
      solution.contact_fraction + (1.0 - solution.contact_fraction) * solution.turn_fraction;
  Eigen::Quaterniond q_P(memory.X_GP.linear());
  const Eigen::Quaterniond q_T(X_GT.linear());
  // Normalise: while the tool is held without turning, each conversion from matrix to quaternion and back
  // would enlarge the matrix's error.
  if (std::abs(q_P.squaredNorm() - 1.0) > kMaxNormError) q_P.normalize();
  memory.X_GP.linear() = q_P.slerp(turned, q_T).toRotationMatrix();
  memory.X_GP.translation() = solution.origin_end;
  memory.has_proxy = true;
  ++memory.frame;

  BookRemoved(params, materials, solution.removed_m3, solution.edge_work_J, memory);
  memory.cutting_work_J += solution.ploughing_work_J;

  ContactModel model;
  model.X_WP = X_WG * memory.X_GP;
  model.p_WS_m = Vector3(X_WG * solution.origin_slid);
  model.contact_fraction = solution.contact_fraction;
  model.removed_volume_m3 = memory.removed_volume_m3;
  model.removed_mass_kg = memory.removed_mass_kg;
  model.cutting_work_J = memory.cutting_work_J;
  model.pose_stamp = input.stamp;
  model.frame = memory.frame;
  for (const double area : solution.engaged_area_m2) model.engaged_area_m2 += area;
  std::optional<MaterialIndex> engaged;
  if (model.engaged_area_m2 > 0.0)
    engaged = static_cast<MaterialIndex>(std::ranges::max_element(solution.engaged_area_m2) -
                                         solution.engaged_area_m2.begin());
  const bool cutting = input.spindle_rad_per_s != 0.0 && input.dt_s > 0.0;
  // use the frame's mean torque, from the work: the force falls while the bone gives way
  if (cutting)
    model.spindle_torque_Nm =
        (solution.edge_work_J + solution.ploughing_work_J) / (std::abs(input.spindle_rad_per_s) * input.dt_s);
  if (cutting) model.advance_m_per_s = solution.advance_m / input.dt_s;
  model.n_W = Vector3(R_WG * solution.n);

  AddContacts(params, materials, map, engaged, X_WG, X_WT, cutting, input.dt_s, solution, model);
  memory.contact.friction = FrictionOf(materials, solution, model);
  Wrench F_T_W = model.F_T_W;
  const double size_N = F_T_W.f.norm();
  if (size_N > params.max_force_N) {
    F_T_W.f *= params.max_force_N / size_N;
    F_T_W.t *= params.max_force_N / size_N;
  }
  model.F_T_W = F_T_W;
  return model;
}

void CombineParts(ContactModel& whole, const ContactModel& part, int k, int n) {
  const bool touched = k > 0 && whole.contact_fraction < 1.0;
  const double fraction = touched ? whole.contact_fraction : (k + part.contact_fraction) / n;
  whole = part;
  whole.contact_fraction = part.contact_fraction < 1.0 || touched ? fraction : 1.0;
}

void ToState(const FrameMemory& memory, CarvedState& state) {
  state.X_GP = memory.X_GP;
  state.has_proxy = memory.has_proxy;
  state.removed_volume_m3 = memory.removed_volume_m3;
  state.removed_mass_kg = memory.removed_mass_kg;
  state.cutting_work_J = memory.cutting_work_J;
  state.cutting_debt_J = memory.energy_lead_J;
  state.contact = memory.contact;
  state.frame = memory.frame;
}

FrameMemory ToMemory(const CarvedState& state) {
  return {.contact = state.contact,
          .X_GP = state.X_GP,
          .has_proxy = state.has_proxy,
          .removed_volume_m3 = state.removed_volume_m3,
          .removed_mass_kg = state.removed_mass_kg,
          .cutting_work_J = state.cutting_work_J,
          .energy_lead_J = state.cutting_debt_J,
          .frame = state.frame};
}

void CheckMemory(const CarvedState& state, std::size_t tool_balls) {
  const ContactMemory& contact = state.contact;
  CheckAtMost("contact pairs", contact.pair_count, kRememberedPairs);
  CheckAtMost("contact pairs that hold", contact.held_count,
              std::min<std::int64_t>(contact.pair_count, kMaxHolding));
  CheckAtMost("contact faces", contact.face_count, kMaxFaces);
  const auto places = static_cast<std::int64_t>((state.balls.size() + state.split_slots.size()) / 4);
  for (const ContactPair& pair :
       std::span(contact.pairs).first(static_cast<std::size_t>(contact.pair_count))) {
    CheckAtMost("bone ball of a contact pair", pair.bone_ball, places - 1);
    CheckAtMost("tool ball of a contact pair", pair.tool_ball, static_cast<std::int64_t>(tool_balls) - 1);
  }
  for (const PlainVector3& n :
       std::span(contact.face_n_G).first(static_cast<std::size_t>(contact.face_count)))
    if (!Vector3(n).allFinite())
      throw std::invalid_argument("carved state: direction of a contact face: found no finite one");
  if (!IsPose(state.X_GP))
    throw std::invalid_argument("carved state: proxy: found no pose, accepted a rotation and a finite place");
  for (const double value : {state.removed_volume_m3, state.removed_mass_kg, state.cutting_work_J,
                             state.cutting_debt_J, contact.friction})
    if (!std::isfinite(value))
      throw std::invalid_argument(
          fmt::format("carved state: totals: found {}, accepted finite numbers", value));
}

bool IsUsable(const FrameInput& input) {
  return IsPose(input.X_WT) && std::isfinite(input.spindle_rad_per_s) && std::isfinite(input.dt_s) &&
         input.dt_s >= 0.0 && input.dt_s <= 1.0;
}

}  // namespace osteon::simulation
