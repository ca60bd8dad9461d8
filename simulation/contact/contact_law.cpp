#include "simulation/contact/contact_law.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "simulation/contact/constrained_goal.h"
#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {
namespace {

// Weight of a pair: the square of the bone ball's overlap with the enlarged tool [m²]. It approximates the
// volume of the overlap (the lens): the missing factor, the pair's reduced radius, is nearly the same for all
// pairs.
double LensWeight(const CuttingParams& params, const NearPair& pair) {
  const double overlap_m = std::max(0.0, params.normal_enlargement_m - pair.gap_m);
  return overlap_m * overlap_m;
}

// A face of the bone: the holding planes whose normals lie within one cone, and the sums over these planes.
struct Face {
  Vector3 hold{Vector3::Zero()};          ///< sum of multiplier times normal n
  double multiplier{0.0};                 ///< sum of the multipliers
  double cutting{0.0};                    ///< part of `multiplier` that is due to cutting balls
  Vector3 raw_center_T{Vector3::Zero()};  ///< sum of the holding pairs' centres, weighted by multiplier
  double raw_radius{0.0};                 ///< sum of the tool balls' radii, weighted by multiplier
  double lens{0.0};                       ///< sum of LensWeight
  int known{-1};                          ///< index of this face in the frame before; -1: a new face
};

// Groups the holding planes by face. A plane belongs to the face of the frame before in whose cone it lies;
// if there is none, it belongs to a new face.
struct Faces {
  std::array<Face, kMaxFaces> face{};
  std::size_t count{0};
};
Faces FindFaces(const CuttingParams& params, const Candidates& candidates, const ConstrainedGoal& hold,
                const ContactMemory& memory) {
  Faces faces;
  // Sort the planes by falling multiplier, so that a new face forms around the plane that holds most. Use
  // insertion sort, because std::stable_sort allocates memory.
  std::array<int, 4> order{0, 1, 2, 3};
  const auto multiplier = [&](std::size_t place) {
    return hold.multiplier_m[static_cast<std::size_t>(order[place])];
  };
  for (std::size_t k = 1; k < static_cast<std::size_t>(hold.count); ++k)
    for (std::size_t j = k; j > 0 && multiplier(j) > multiplier(j - 1); --j)
      std::swap(order[j], order[j - 1]);
  for (int k = 0; k < hold.count; ++k) {
    const auto i = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
    const NearPair& pair = candidates.pairs[hold.plane[i]];
    const double m = hold.multiplier_m[i];
    int known = -1;
    double largest_cosine = kFaceCosine;
    for (int f = 0; f < memory.face_count; ++f) {
      const double cosine = pair.n.dot(Vector3(memory.face_n_G[static_cast<std::size_t>(f)]));
      if (cosine <= largest_cosine) continue;
      largest_cosine = cosine;
      known = f;
    }
    Face* face = nullptr;
    for (std::size_t f = 0; f < faces.count; ++f) {
      Face& other = faces.face[f];
      if (known >= 0 ? other.known == known
                     : other.known < 0 && pair.n.dot(other.hold) > kFaceCosine * other.hold.norm())
        face = &other;
    }
    if (face == nullptr) {
      face = &faces.face[faces.count++];
      face->known = known;
    }
    face->hold += m * pair.n;
    face->multiplier += m;
    if (pair.cutting) face->cutting += m;
    face->raw_center_T += m * pair.center_T_m;
    face->raw_radius += m * pair.tool_radius_m;
    face->lens += LensWeight(params, pair);
  }
  return faces;
}

}  // namespace

ContactBin FindBin(const Vector3& u_T, bool cutting) {
  const Vector3 size = u_T.cwiseAbs();
  const int axis = size.x() >= size.y() && size.x() >= size.z() ? 0 : size.y() >= size.z() ? 1 : 2;
  const int face = 2 * axis + (u_T[axis] < 0.0 ? 1 : 0);
  if (!cutting) return {.number = kCuttingBins + face, .off_centre = 1.0 - size[axis]};
  // divide the cube's face into thirds by one comparison each, so that all engines agree
  const auto third = [&](double x) { return 3.0 * x < -size[axis] ? 0 : 3.0 * x > size[axis] ? 2 : 1; };
  const double b = u_T[(axis + 1) % 3], c = u_T[(axis + 2) % 3];
  const int i = third(b), j = third(c);
  // the centre of an outer third lies two thirds of the way from the face's centre to its edge
  const double along = size[axis] + 2.0 / 3.0 * ((i - 1) * b + (j - 1) * c);
  const double length = std::sqrt(1.0 + 4.0 / 9.0 * ((i != 1) + (j != 1)));
  return {.number = 9 * face + 3 * i + j, .off_centre = 1.0 - along / length};
}

bool Nearer(const NearPair& a, const NearPair& b) {
  if (a.present != b.present) return a.present;
  if (a.score_m != b.score_m) return a.score_m < b.score_m;
  if (a.pair.bone_ball != b.pair.bone_ball) return a.pair.bone_ball < b.pair.bone_ball;
  return a.pair.tool_ball < b.pair.tool_ball;
}

void FaceSums::Add(double lens_m3, const Vector3& face_n, const NearPair& pair) {
  const double inside = pair.n.dot(face_n) - kFaceCosine;
  if (inside <= 0.0) return;
  const double w = lens_m3 * inside * inside;
  weight += w;
  n += w * pair.n;
  center_T += w * pair.center_T_m;
  radius += w * pair.tool_radius_m;
}

Candidates FindCandidates(const NearField& near, double tolerance_m) {
  Candidates all;
  for (const NearPair& pair : near.nearest)
    if (pair.present) all.pairs[all.count++] = pair;
  const auto nearest = all.pairs.begin() + static_cast<std::ptrdiff_t>(all.count);
  for (std::size_t k = 0; k < near.remembered.size(); ++k) {
    const NearPair& pair = near.remembered[k];
    if (!pair.present) continue;
    const auto known = std::find_if(all.pairs.begin(), nearest,
                                    [&](const NearPair& other) { return other.pair == pair.pair; });
    const auto index = known != nearest ? static_cast<std::size_t>(known - all.pairs.begin()) : all.count;
    if (index == all.count) all.pairs[all.count++] = pair;
    if (k < static_cast<std::size_t>(near.held_count)) all.held[all.held_count++] = index;
  }
  for (std::size_t i = 0; i < all.count; ++i) {
    const NearPair& pair = all.pairs[i];
    double room_m = tolerance_m;
    for (std::size_t j = 0; j < all.count; ++j)
      if (all.pairs[j].n.dot(pair.n) < kOppositeCosine)
        room_m = std::min(room_m, pair.gap_m + all.pairs[j].gap_m);
    all.gap_m[i] = YieldingGap(pair.gap_m, room_m, tolerance_m);
  }
  return all;
}

void ComputeForceCap(ContactSolution& held) {
  held.normal_m = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(held.goal.count); ++k)
    held.normal_m += held.goal.multiplier_m[k];
  held.force_multiplier_cap_m =
      ForceMultiplierCap(held.normal_m, held.goal.point_m.norm(), held.goal.slack_m);
}

ContactSolution SolveContacts(const Candidates& candidates, const ContactInput& input, bool turning) {
  // motion of a tool ball's centre from first contact to the tool's pose, with or without the tool's turn
  const auto motion = [&](const NearPair& pair) { return turning ? pair.motion_m : input.motion_G_m; };
  std::array<HalfSpace, kContactBins + kRememberedPairs> planes;
  for (std::size_t i = 0; i < candidates.count; ++i) {
    const NearPair& pair = candidates.pairs[i];
    planes[i] = {.n = pair.n, .offset = -(candidates.gap_m[i] + pair.n.dot(motion(pair)))};
  }
  ContactSolution held;
  held.goal = FindConstrainedGoal(std::span(planes.data(), candidates.count),
                                  std::span(candidates.held.data(), candidates.held_count));
  ComputeForceCap(held);
  if (held.normal_m <= 0.0 || input.friction <= 0.0) return held;

  Vector3 slip = Vector3::Zero();  // slip of the tool's surface, mean over the holding planes
  for (std::size_t k = 0; k < static_cast<std::size_t>(held.goal.count); ++k) {
    const NearPair& pair = candidates.pairs[held.goal.plane[k]];
    Vector3 surface_motion = motion(pair) + held.goal.point_m;
    if (turning) surface_motion -= pair.tool_radius_m * input.turn_G.cross(pair.n);
    slip += held.goal.multiplier_m[k] * surface_motion;
  }
  slip /= held.normal_m;
  const Vector3 n = held.goal.point_m.normalized();
  slip -= n.dot(slip) * n;
  const double size = slip.norm();
  if (size <= 0.0) return held;
  held.friction_m = -std::min(1.0, input.friction * held.force_multiplier_cap_m / size) * slip;
  // the step back by friction may violate another plane by micrometres: move out of it again
  for (std::size_t i = 0; i < candidates.count; ++i) planes[i].offset -= planes[i].n.dot(held.point_m());
  held.friction_m += FindConstrainedGoal(std::span(planes.data(), candidates.count)).point_m;
  return held;
}

void FillContacts(const CuttingParams& params, const NearField& near, const Candidates& candidates,
                  const ContactSolution& held, const ContactSolution& unturned, const ContactInput& input,
                  ContactMemory& memory, FrameSolution& solution) {
  const ConstrainedGoal& hold = held.goal;
  solution.delta = held.point_m();
  solution.shift = input.motion_G_m + unturned.point_m();
  for (int bin = kCuttingBins; bin < kContactBins; ++bin) {
    const NearPair& pair = near.nearest[static_cast<std::size_t>(bin)];
    if (pair.present)
      solution.shaft[static_cast<std::size_t>(solution.shaft_count++)] = {.n = pair.n, .gap_m = pair.gap_m};
  }

  // group the planes that hold the tool into faces; a face's direction is the mean normal of the balls around
  // it
  const Faces faces = FindFaces(params, candidates, hold, memory);
  // Each face gets a part of the friction in proportion to its multiplier, which tilts its direction. So
  // force and friction become zero together.
  Vector3 cutting = Vector3::Zero(), at = Vector3::Zero();  // at: displacement from the tool's pose
  solution.contact_count = 0;
  ContactMemory next;
  // this part of the force acts along the faces' own directions; the rest acts along the resultant, divided
  // among the faces by multiplier
  const double free_share = held.normal_m > 0.0 ? held.force_multiplier_cap_m / held.normal_m : 1.0;
  double largest = 0.0;
  for (std::size_t f = 0; f < faces.count; ++f) largest = std::max(largest, faces.face[f].multiplier);
  for (std::size_t f = 0; f < faces.count; ++f) {
    const Face& face = faces.face[f];
    const double size = face.hold.norm();
    if (size <= 0.0) continue;
    Vector3 n = face.hold / size;
    next.face_n_G[static_cast<std::size_t>(next.face_count++)] = n;
    Vector3 center_T = face.raw_center_T / face.multiplier;
    double radius = face.raw_radius / face.multiplier, weight = face.lens;
    if (face.known >= 0) {
      const FaceSums& sums = near.faces[static_cast<std::size_t>(face.known)];
      if (sums.weight > 0.0) {
        const double narrow = sums.n.norm() / sums.weight;
        const double exact = Exactness(largest / held.normal_m, WidthExactness(narrow));
        n = ((1.0 - exact) * sums.n.normalized() + exact * n).normalized();
        center_T = sums.center_T / sums.weight;
        radius = sums.radius / sums.weight;
      }
    }
    const double share = face.multiplier / held.normal_m;
    const Vector3 force = free_share * size * n + (1.0 - free_share) * share * hold.point_m;
    cutting += face.cutting / face.multiplier * force;
    const Vector3 with_friction = force + share * held.friction_m;
    const double multiplier = with_friction.norm();
    if (multiplier <= 0.0) continue;
    at += with_friction;
    solution.contacts[static_cast<std::size_t>(solution.contact_count++)] = {
        .n = with_friction / multiplier,
        .p_T_m = center_T - radius * (input.R_GT.transpose() * n),
        .multiplier_m = multiplier,
        .weight = weight,
        .cutting = face.cutting > 0.0};
  }
  solution.cutting_m = cutting.norm();
  solution.n = solution.cutting_m > 0.0 ? Vector3(cutting / solution.cutting_m) : Vector3::Zero();
  for (int c = 0; c < solution.contact_count; ++c) {
    SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    contact.gap_m = -contact.n.dot(at);
  }

  // then report the pairs that do not hold, nearest first: the tool may meet their planes before the next
  // frame
  std::array<std::size_t, kContactBins + kRememberedPairs> order{};
  std::array<double, kContactBins + kRememberedPairs> room{}, gap{};
  for (std::size_t i = 0; i < candidates.count; ++i) {
    order[i] = i;
    const NearPair& pair = candidates.pairs[i];
    gap[i] = candidates.gap_m[i] + pair.n.dot(pair.motion_m);  // gap at the tool's pose
    room[i] = gap[i] + pair.n.dot(hold.point_m);               // gap where the planes hold the tool
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(candidates.count),
            [&](std::size_t a, std::size_t b) { return room[a] != room[b] ? room[a] < room[b] : a < b; });
  for (std::size_t k = 0; k < static_cast<std::size_t>(hold.count); ++k)
    next.pairs[static_cast<std::size_t>(next.pair_count++)] = candidates.pairs[hold.plane[k]].pair;
  next.held_count = next.pair_count;
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const std::size_t i = order[k];
    const auto holding = hold.plane.begin() + hold.count;
    if (next.pair_count < kRememberedPairs && std::find(hold.plane.begin(), holding, i) == holding)
      next.pairs[static_cast<std::size_t>(next.pair_count++)] = candidates.pairs[i].pair;
    if (solution.contact_count >= kMaxContacts) continue;
    const NearPair& pair = candidates.pairs[i];
    bool covered = false;
    for (int c = 0; c < solution.contact_count; ++c) {
      // A reported contact covers a pair with nearly the same normal, which is then not reported. A cutting
      // contact does not cover a shaft's pair, because bone gives way at the cutting edge but not at the
      // shaft.
      const SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
      covered = covered || (contact.n.dot(pair.n) > kFaceCosine && (pair.cutting || !contact.cutting));
    }
    if (covered) continue;
    // the plane must not push the tool away from the pose at which the contacts hold it
    solution.contacts[static_cast<std::size_t>(solution.contact_count++)] = {
        .n = pair.n,
        .p_T_m = pair.center_T_m - pair.tool_radius_m * (input.R_GT.transpose() * pair.n),
        .gap_m = std::max(gap[i], -pair.n.dot(at)),
        .weight = LensWeight(params, pair),
        .cutting = pair.cutting};
  }
  next.friction = memory.friction;
  memory = next;
}

}  // namespace osteon::simulation
