#include "gpu/engine_impl.h"

#include <bit>

namespace osteon::gpu {

// What the device has found near the tool at first contact, a share s of the way: the same as
// simulation::FindCandidates makes, and the sums of the faces.
void VulkanEngine::Impl::ReadNearField(const Frame& done, double s) {
  candidates.count = done.candidate_count;
  candidates.held_count = 0;  // what holds is known already
  for (std::size_t c = 0; c < candidates.count; ++c) {
    const Candidate& found = done.candidates[c];
    const std::size_t t = found.tool_ball;
    candidates.gap_m[c] = found.yielding_gap_mm / kMillimetres;
    simulation::NearPair& pair = candidates.pairs[c];
    pair.pair = {.bone_ball = found.bone_ball, .tool_ball = tool.number[t]};
    pair.present = true;
    pair.cutting = t < tool.cutter_count;
    pair.n = Vector3(found.n_x, found.n_y, found.n_z).normalized();
    pair.gap_m = found.gap_mm / kMillimetres;
    pair.motion_m = (1.0 - s) * (goal_m[t] - start_m[t]);
    pair.center_T_m = tool.balls[t].center_T_m;
    pair.tool_radius_m = tool.balls[t].radius_m;
  }
  for (std::size_t f = 0; f < kFaces; ++f) {
    const auto sum = [&](std::size_t row, std::size_t column, double scale) {
      return Total(done.face_sums[(row * kFaces + f) * kFaceColumns + column], scale);
    };
    const auto vector = [&](std::size_t row, std::size_t column, double scale) {
      return Vector3(sum(row, column, scale), sum(row, column + 1, scale), sum(row, column + 2, scale));
    };
    const double weight = done.face_scale, place = done.face_point_scale;
    simulation::FaceSums& face = near.faces[f];
    const double cutters = sum(0, 0, weight);
    face.weight = cutters + sum(1, 0, weight);
    face.n = vector(0, 1, weight) + vector(1, 1, weight);
    face.center_T = vector(0, 4, place) / kMillimetres + vector(1, 4, place) / kMillimetres;
    face.radius = (sum(0, 7, place) + sum(1, 7, place)) / kMillimetres;
    if (tool.cutter_count == 1) {  // the same for all
      face.center_T += cutters * tool.balls[0].center_T_m;
      face.radius += cutters * tool.balls[0].radius_m;
    }
  }
}

simulation::FrameSolution VulkanEngine::Impl::Solution(const Frame& done) {
  simulation::FrameSolution s;
  s.contact_fraction = std::min(1.0f, std::bit_cast<float>(done.contact_bits));

  ReadNearField(done, s.contact_fraction);
  simulation::ContactHold held;
  held.hold.count = static_cast<int>(done.hold_count);
  for (std::size_t k = 0; k < done.hold_count; ++k) {
    held.hold.plane[k] = done.hold_candidate[k];  // the same list as FindCandidates makes
    held.hold.multiplier_m[k] = done.hold_mm[k] / kMillimetres;
  }
  held.friction_m = ToMetres(done.friction_mm);
  held.hold.point_m = ToMetres(done.delta) - held.friction_m;
  held.hold.slack_m = done.friction_mm.w / kMillimetres;
  WeighHold(held);
  const Vector3 from_m = memory.X_GP.translation(), to_m = X_GT.translation();
  s.origin_contact = from_m + s.contact_fraction * (to_m - from_m);
  const simulation::ContactInput asked{
      .R_GT = X_GT.linear(),
      .motion_G_m = to_m - s.origin_contact,
      .turn_G = (1.0 - s.contact_fraction) * LogRotation(X_GT.linear() * memory.X_GP.linear().transpose()),
      .friction = done.friction};
  simulation::ContactHold unturned;
  unturned.friction_m = ToMetres(done.shift_mm) - asked.motion_G_m;
  ReportContacts(params, near, candidates, held, unturned, asked, memory.contact, s);
  s.cutting_m = done.delta.w / kMillimetres;
  s.n = s.cutting_m > 0.0 ? Vector3(Direction(done.n).normalized()) : Vector3::Zero();
  s.advance_m = done.advance_mm / kMillimetres;
  s.edge_work_J = done.edge_work_Nmm / kMillimetres;
  s.slide_fraction = done.slid_share;
  s.turn_fraction = done.turns != 0 ? s.slide_fraction : 0.0;
  s.origin_slid =
      s.origin_contact + s.slide_fraction * (done.turns != 0 ? Vector3(asked.motion_G_m + s.delta) : s.shift);
  s.origin_end = s.origin_slid + ToMetres(done.step_mm);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    s.engaged_area_m2[m] = Total(done.engaged_sums[2 * m], done.area_scale) * 1e-6;
    s.engaged_moment_m3[m] = Total(done.engaged_sums[2 * m + 1], done.moment_scale) * 1e-9;
    s.removed_m3[m] = done.removed[m] * unit_mm3 * 1e-9;
  }
  return s;
}

}  // namespace osteon::gpu
