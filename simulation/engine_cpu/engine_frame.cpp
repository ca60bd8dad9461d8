#include <algorithm>
#include <cmath>

#include "simulation/contact/cutting_math.h"
#include "simulation/engine_cpu/engine_impl.h"

// Computes a frame pass by pass, in the order of ReferenceEngine::StepPart.

namespace osteon::simulation {
namespace {

// Makes the result of a frame that needs more listed pairs than the lists have room for; the bone is
// unchanged.
ContactModel Overloaded() {
  ContactModel refused;
  refused.status = EngineStatus::kOverloaded;
  return refused;
}

}  // namespace

// Adds the time since the previous call to a stage, if the caller wants the stages timed.
void CpuEngine::Impl::EndStage(CpuStage stage) {
  if (!cpu.time_stages) return;
  const auto now = std::chrono::steady_clock::now();
  stats.stage_s[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - stage_began).count();
  stage_began = now;
}

// Places the tool's balls and its origin at a pose.
void CpuEngine::Impl::SetPlaces(const Pose& X_GP, cpu::ToolPlacement& to) const {
  double R[9], p[3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R[3 * i + j] = X_GP.linear()(i, j);
    p[i] = X_GP.translation()[i];
  }
  kernels.place(R, p, balls.view(), to.places());
}

ContactModel CpuEngine::Impl::ComputeFrame(const FrameInput& input) {
  if (cpu.time_stages) stage_began = std::chrono::steady_clock::now();
  const Pose X_GT = X_WG.inverse() * Pose(input.X_WT);
  const Matrix3 R_GT = X_GT.linear();
  FrameSolution solution;

  const double path_m = PlaceTool(X_GT);
  if (!FindContact(path_m, solution)) return Overloaded();
  const bool turning = SolveContacts(input, R_GT, solution);
  const double slide_m = SlideTool(input, turning, solution);
  MeasureEngagement(R_GT.col(2), solution);
  EndStage(CpuStage::kEngagement);
  Advance(input, solution);
  EndStage(CpuStage::kFinish);
  if (input.spindle_rad_per_s != 0.0) {
    const Vector3 step = solution.origin_end - solution.origin_slid;
    const double v[3] = {step.x(), step.y(), step.z()};
    kernels.shifted(slid.places(), v, balls.count(), end.places());
    // index of the only tool ball that cuts; -1: all cutting balls cut
    std::int32_t only = -1;
    if (params.cutters == Cutters::kContactSphere)
      only = static_cast<std::int32_t>(TouchingBall(solution.contact_fraction));
    Remove(only, slide_m + step.norm(), solution);
  }
  ContactModel model = FinishFrame(params, materials, map, X_WG, input, solution, memory);
  if (split) model.balls_not_split = split->refused();
  EndStage(CpuStage::kFinish);
  lists.MakeAhead(contact, list_reach);
  EndStage(CpuStage::kLists);
  return model;
}

// Places the tool's balls at the proxy and at the tool's pose, and computes up to which distance from the
// tool this frame needs balls and points. @returns the path of the tool point that moves farthest [m].
double CpuEngine::Impl::PlaceTool(const Pose& X_GT) {
  SetPlaces(memory.X_GP, start);
  SetPlaces(X_GT, goal);
  const double path_m = LongestWay(start, goal);
  // With the rate law, the tool moves at most max_slide from first contact. With the immediate law, it then
  // moves on to its pose. That takes at most max_slide for the slide, max_slide to return from the slide, and
  // path_m.
  const bool goes_on = params.law == RemovalLaw::kImmediate;
  const double way_mm = 1e3 * (goes_on ? 2.0 * params.max_slide_m + path_m : params.max_slide_m);
  const double ball_mm = std::max(1e3 * params.normal_enlargement_m, way_mm),
               point_mm = std::max(1e3 * params.engaged_layer_m, way_mm);
  // with the immediate law, lists reach farther by half the path plus 0.1 mm, so that a slightly longer path
  // in the next frame needs no new lists
  const double more_mm = goes_on ? 500.0 * path_m + 0.1 : 0.0;
  const double farthest_mm = std::max(ball_mm, point_mm) + more_mm + lists.max_skin_mm();
  rounding_mm = balls.UpdateRounding(start, goal, static_cast<float>(bone.max_radius_mm()),
                                     static_cast<float>(farthest_mm));
  reach = {.ball_mm = ball_mm + 2.0 * rounding_mm, .point_mm = point_mm + 2.0 * rounding_mm};
  list_reach = {.ball_mm = reach.ball_mm + more_mm + 2.0 * rounding_mm,
                .point_mm = reach.point_mm + more_mm + 2.0 * rounding_mm};
  lists.AddDisplacement(1e3 * kernels.farthest(last_contact.places(), start.places(), 0, balls.count()));
  EndStage(CpuStage::kPlace);
  return path_m;
}

// Pass 1: finds first contact. It is found with the present list if the tool is still within the list's skin
// there, because the list then holds every pair that touches. Otherwise the box tree finds it, and a new list
// is built with the tool at first contact.
// @returns false if there are more pairs than the lists have room for; the bone is then unchanged.
bool CpuEngine::Impl::FindContact(double path_m, FrameSolution& solution) {
  if (!lists.Serves(start, reach) && !lists.MakeAt(start, list_reach)) return false;
  EndStage(CpuStage::kLists);
  const cpu::ContactPass pass = MakeContactPass(start, goal, 0.0, path_m);
  double first = kNoContact;
  for (std::int32_t k = 0; k < memory.contact.pair_count; ++k) {
    const ContactPair& pair = memory.contact.pairs[static_cast<std::size_t>(k)];
    first = std::min(first, kernels.pair_contact(pass, pair.bone_ball, pair.tool_ball));
  }
  first = kernels.first_contact(pass, first);
  // places the tool at a fraction of its path: at its end, if there is no contact
  const auto go_to = [&](double fraction) {
    solution.contact_fraction = std::min(1.0, fraction);
    kernels.between(start.places(), goal.places(), solution.contact_fraction, balls.count(),
                    contact.places());
  };
  go_to(first);
  EndStage(CpuStage::kContact);
  if (!lists.Serves(contact)) {
    go_to(FirstContactOnWay(pass));
    EndStage(CpuStage::kContact);
    if (!lists.MakeAt(contact, list_reach)) return false;
    EndStage(CpuStage::kLists);
  } else {
    lists.AddDisplacement(1e3 * kernels.farthest(start.places(), contact.places(), 0, balls.count()));
  }
  last_contact.CopyFrom(contact);
  solution.origin_contact = contact.Origin();
  return true;
}

ContactInput CpuEngine::Impl::ContactInputOf(const Matrix3& R_GT, double contact_fraction,
                                             bool cutting) const {
  return {.R_GT = R_GT,
          .motion_G_m = goal.Origin() - contact.Origin(),
          .turn_G = (1.0 - contact_fraction) * LogRotation(R_GT * memory.X_GP.linear().transpose()),
          .friction = cutting ? 0.0 : memory.contact.friction};
}

// Pass 2: finds the closest target that violates no plane of the pairs near the tool.
// @returns whether the frame's path includes a turn of the tool.
bool CpuEngine::Impl::SolveContacts(const FrameInput& input, const Matrix3& R_GT, FrameSolution& solution) {
  const ContactInput asked = ContactInputOf(R_GT, solution.contact_fraction, input.spindle_rad_per_s != 0.0);
  const bool turning = asked.turn_G != Vector3::Zero();
  FindNearField(R_GT);
  EndStage(CpuStage::kNearField);
  const Candidates candidates = FindCandidates(near, params.contact_tolerance_m);
  const ContactSolution held = simulation::SolveContacts(candidates, asked, true);
  FillContacts(params, near, candidates, held,
               turning ? simulation::SolveContacts(candidates, asked, false) : held, asked, memory.contact,
               solution);
  EndStage(CpuStage::kLaw);
  return turning;
}

// Slides the tool from first contact towards the target of the contact law. @returns the length of the slide
// [m]: the path of the tool point that moves farthest.
double CpuEngine::Impl::SlideTool(const FrameInput& input, bool turning, FrameSolution& solution) {
  const auto shift = [this](const cpu::ToolPlacement& from, const Vector3& by, cpu::ToolPlacement& to) {
    const double v[3] = {by.x(), by.y(), by.z()};
    kernels.shifted(from.places(), v, balls.count(), to.places());
  };
  shift(goal, solution.delta, target);
  if (turning) shift(contact, solution.shift, straight);
  const double max_m = MaxSlide(params, input);
  const Slid full =
      SlideTo(target, (turning ? kTurnToleranceShare : 1.0) * params.contact_tolerance_m, max_m);
  const Slid unturned = turning ? SlideTo(straight, params.contact_tolerance_m, max_m) : full;
  // if bone prevents the turn, the tool still slides without turning
  const bool turns = SlidesTurning(full.stopped, full.way_m, unturned.way_m, kRotationBias_m);
  const Slid& chosen = turns ? full : unturned;
  solution.slide_fraction = chosen.fraction;
  solution.turn_fraction = turns ? chosen.fraction : 0.0;
  solution.slide_m = chosen.way_m;
  kernels.between(contact.places(), (turns ? target : straight).places(), chosen.fraction, balls.count(),
                  slid.places());
  solution.origin_slid = slid.Origin();
  EndStage(CpuStage::kSlide);
  return chosen.way_m;
}

// Pass 3, first half: computes how far the cutting edge advances into bone.
void CpuEngine::Impl::Advance(const FrameInput& input, FrameSolution& solution) {
  const FrameAdvance advance =
      ComputeAdvance(params, materials, solution, input.spindle_rad_per_s, input.dt_s, memory.energy_lead_J);
  solution.advance_m = advance.advance_m;
  solution.edge_work_J = advance.edge_work_J;
  solution.ploughing_work_J = advance.ploughing_work_J;
  solution.step = ComputeAdvanceStep(params, input, solution, goal.Origin());
  solution.origin_end = ComputeAdvanceEnd(solution);
}

}  // namespace osteon::simulation
