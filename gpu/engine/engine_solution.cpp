#include "gpu/engine/engine_impl.h"

#include <bit>

namespace osteon::gpu {

// Fills `candidates` and `near.faces` from the pairs and the sums of the faces that the device found at first
// contact, which is at fraction s of the tool's path. The result has the form of that of
// simulation::FindCandidates.
void VulkanEngine::Impl::ReadNearField(const Frame& done, double s) {
  candidates.count = done.candidate_count;
  candidates.held_count = 0;  // unused: the device has already solved which candidates hold the tool
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
    // Row 0: sums over the balls that cut; row 1: over the others. Column 0: weight; columns 1 to 3: weight ×
    // normal.
    const auto weight = [&](std::size_t row, std::size_t column) {
      return static_cast<double>(done.exact.face_sums[(row * kFaces + f) * 4 + column]) /
             (kUnitSubdivision * done.face_scale);
    };
    // Columns 0 to 2: weight × centre [m]; column 3: weight × radius [m].
    const auto weighted_place = [&](std::size_t row, std::size_t column) {
      return Total(done.face_sums[(row * kFaces + f) * kFaceColumns + column], done.face_point_scale) /
             kMillimetres;
    };
    const auto weighted_center = [&](std::size_t row) {
      return Vector3(weighted_place(row, 0), weighted_place(row, 1), weighted_place(row, 2));
    };
    simulation::FaceSums& face = near.faces[f];
    const double cutters = weight(0, 0);
    face.weight = cutters + weight(1, 0);
    face.n = Vector3(weight(0, 1) + weight(1, 1), weight(0, 2) + weight(1, 2), weight(0, 3) + weight(1, 3));
    face.center_T = weighted_center(0) + weighted_center(1);
    face.radius = weighted_place(0, 3) + weighted_place(1, 3);
    if (tool.cutter_count == 1) {  // the device's sums omit the position and radius of a single cutting ball
      face.center_T += cutters * tool.balls[0].center_T_m;
      face.radius += cutters * tool.balls[0].radius_m;
    }
  }
}

// Converts the device's results to SI units, and adds what the host computes: the force cap and the contacts.
simulation::FrameSolution VulkanEngine::Impl::Solution(const Frame& done) {
  simulation::FrameSolution s;
  s.contact_fraction = std::min(1.0, std::bit_cast<double>(done.contact_key));

  ReadNearField(done, s.contact_fraction);
  simulation::ContactSolution held;
  held.goal.count = static_cast<int>(done.hold_count);
  for (std::size_t k = 0; k < done.hold_count; ++k) {
    held.goal.plane[k] = done.hold_candidate[k];  // the same indices as in FindCandidates
    held.goal.multiplier_m[k] = done.exact.hold[k] / kMillimetres;
    candidates.pairs[done.hold_candidate[k]].n = Direction(done.exact.hold_n[k]);
  }
  held.friction_m = ToMetres(done.friction_mm);
  held.goal.point_m = ToMetres(done.exact.delta) - held.friction_m;
  held.goal.slack_m = done.friction_mm.w / kMillimetres;
  ComputeForceCap(held);
  const Vector3 from_m = memory.X_GP.translation(), to_m = X_GT.translation();
  s.origin_contact = from_m + s.contact_fraction * (to_m - from_m);
  const simulation::ContactInput asked{
      .R_GT = X_GT.linear(),
      .motion_G_m = to_m - s.origin_contact,
      .turn_G = (1.0 - s.contact_fraction) * LogRotation(X_GT.linear() * memory.X_GP.linear().transpose()),
      .friction = done.friction};
  simulation::ContactSolution unturned;
  unturned.friction_m = ToMetres(done.exact.shift) - asked.motion_G_m;
  FillContacts(params, near, candidates, held, unturned, asked, memory.contact, s);
  s.cutting_m = done.exact.cutting / kMillimetres;
  s.n = s.cutting_m > 0.0 ? Direction(done.exact.n) : Vector3::Zero();
  s.advance_m = done.exact.advance / kMillimetres;
  s.edge_work_J = done.exact.edge_work / kMillimetres;
  s.slide_fraction = done.exact.slid_share;
  s.turn_fraction = done.turns != 0 ? s.slide_fraction : 0.0;
  s.origin_slid =
      s.origin_contact + s.slide_fraction * (done.turns != 0 ? Vector3(asked.motion_G_m + s.delta) : s.shift);
  s.origin_end = s.origin_slid + ToMetres(done.exact.step);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    s.engaged_area_m2[m] =
        static_cast<double>(done.exact.engaged[2 * m]) / (kUnitSubdivision * done.area_scale) * 1e-6;
    s.engaged_moment_m3[m] =
        static_cast<double>(done.exact.engaged[2 * m + 1]) / (kUnitSubdivision * done.moment_scale) * 1e-9;
    s.removed_m3[m] = static_cast<double>(done.exact.removed[m]) * unit_mm3 * 1e-9;
  }
  return s;
}

}  // namespace osteon::gpu
