#include "simulation/contact_law.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation/cutting_math.h"
#include "simulation/hold_point.h"

namespace osteon::simulation {
namespace {

/// Two pairs face each other across a gap where the angle between their normals is above 143 degrees.
constexpr double kOppositeCosine = -0.8;

double LensOf(const CuttingParams& params, const NearPair& pair) {
  // of the overlap alone: the pair's reduced radius is much the same for all
  const double over = std::max(0.0, params.normal_enlargement_m - pair.gap_m);
  return over * over;
}

// All pairs that may hold, each once, in an order of their own.
std::vector<const NearPair*> Candidates(const NearField& near) {
  std::vector<const NearPair*> all;
  all.reserve(kContactBins + kRememberedPairs);
  for (const NearPair& pair : near.nearest)
    if (pair.present) all.push_back(&pair);
  const std::size_t nearest = all.size();
  for (const NearPair& pair : near.remembered) {
    if (!pair.present) continue;
    const bool known = std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(nearest),
                                   [&](const NearPair* other) { return other->pair == pair.pair; });
    if (!known) all.push_back(&pair);
  }
  return all;
}

// Half-spaces of the candidates about the tool's pose.
std::vector<HalfSpace> Planes(const std::vector<const NearPair*>& pairs, double tolerance_m) {
  std::vector<HalfSpace> planes;
  planes.reserve(pairs.size());
  for (const NearPair* pair : pairs) {
    // what faces it: a hole or slot that is tighter than the tolerance is as wide as the tolerance
    double room_m = tolerance_m;
    for (const NearPair* other : pairs)
      if (other->n.dot(pair->n) < kOppositeCosine) room_m = std::min(room_m, pair->gap_m + other->gap_m);
    const double gap_m = pair->gap_m + 0.5 * (tolerance_m - room_m);
    planes.push_back({.n = pair->n, .offset = -(gap_m + pair->n.dot(pair->motion_m))});
  }
  return planes;
}

// A face: the planes that hold within one cone, and what is reported of them.
struct Face {
  Vector3 hold{Vector3::Zero()};  ///< sum of multiplier n
  double multiplier{0.0};         ///< the sum of multipliers
  Vector3 cutting{Vector3::Zero()};
  Vector3 raw_center_T{Vector3::Zero()};  ///< of the holding pairs themselves, multiplier-weighted
  double raw_radius{0.0}, lens{0.0};
  int known{-1};  ///< number in the memory; -1: new
};

// The planes that hold, by face: that of the frame before whose cone they are in, else a new one.
std::vector<Face> Faces(const CuttingParams& params, const std::vector<const NearPair*>& pairs,
                        const HoldPoint& hold, const ContactMemory& memory) {
  std::vector<Face> faces;
  // strongest first, so that a new face forms around what holds most
  std::array<int, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.begin() + hold.count, [&](int a, int b) {
    return hold.multiplier_m[static_cast<std::size_t>(a)] > hold.multiplier_m[static_cast<std::size_t>(b)];
  });
  for (int k = 0; k < hold.count; ++k) {
    const auto i = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
    const NearPair& pair = *pairs[hold.plane[i]];
    const double m = hold.multiplier_m[i];
    int known = -1;
    double nearest = kFaceCosine;
    for (int f = 0; f < memory.face_count; ++f) {
      const double cosine = pair.n.dot(Vector3(memory.face_n_G[static_cast<std::size_t>(f)]));
      if (cosine <= nearest) continue;
      nearest = cosine;
      known = f;
    }
    Face* face = nullptr;
    for (Face& other : faces)
      if (known >= 0 ? other.known == known
                     : other.known < 0 && pair.n.dot(other.hold) > kFaceCosine * other.hold.norm())
        face = &other;
    if (face == nullptr) {
      faces.push_back({.known = known});
      face = &faces.back();
    }
    face->hold += m * pair.n;
    face->multiplier += m;
    if (pair.cutting) face->cutting += m * pair.n;
    face->raw_center_T += m * pair.center_T_m;
    face->raw_radius += m * pair.tool_radius_m;
    face->lens += LensOf(params, pair);
  }
  return faces;
}

}  // namespace

int ContactBin(const Vector3& u_T, bool cutting) {
  const Vector3 size = u_T.cwiseAbs();
  const int axis = size.x() >= size.y() && size.x() >= size.z() ? 0 : size.y() >= size.z() ? 1 : 2;
  const int face = 2 * axis + (u_T[axis] < 0.0 ? 1 : 0);
  if (!cutting) return kCuttingBins + face;
  // thirds of the cube's face: one compare each, so that both engines agree
  const auto third = [&](double x) { return 3.0 * x < -size[axis] ? 0 : 3.0 * x > size[axis] ? 2 : 1; };
  return 9 * face + 3 * third(u_T[(axis + 1) % 3]) + third(u_T[(axis + 2) % 3]);
}

bool Nearer(const NearPair& a, const NearPair& b) {
  if (a.present != b.present) return a.present;
  if (a.gap_m != b.gap_m) return a.gap_m < b.gap_m;
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

void SolveContact(const CuttingParams& params, const NearField& near, const ContactInput& input,
                  ContactMemory& memory, FrameSolution& solution) {
  const std::vector<const NearPair*> pairs = Candidates(near);
  const std::vector<HalfSpace> planes = Planes(pairs, params.contact_tolerance_m);
  const HoldPoint hold = FindHoldPoint(planes);

  for (int bin = kCuttingBins; bin < kContactBins; ++bin) {
    const NearPair& pair = near.nearest[static_cast<std::size_t>(bin)];
    if (pair.present)
      solution.shaft[static_cast<std::size_t>(solution.shaft_count++)] = {.n = pair.n, .gap_m = pair.gap_m};
  }

  // friction: slip of the touching surface, less what the cone can hold
  Vector3 friction = Vector3::Zero();
  double normal = 0.0;
  Vector3 slip = Vector3::Zero();
  for (int k = 0; k < hold.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const NearPair& pair = *pairs[hold.plane[i]];
    const double m = hold.multiplier_m[i];
    normal += m;
    slip += m * (pair.motion_m + hold.point_m - pair.tool_radius_m * input.turn_G.cross(pair.n));
  }
  if (normal > 0.0 && input.friction > 0.0) {
    slip /= normal;
    const Vector3 n = hold.point_m.normalized();
    slip -= n.dot(slip) * n;
    const double size = slip.norm();
    if (size > 0.0) friction = -std::min(1.0, input.friction * normal / size) * slip;
    // the way back may lead into another plane, by micrometres: out again
    std::vector<HalfSpace> from_there = planes;
    for (HalfSpace& plane : from_there) plane.offset -= plane.n.dot(hold.point_m + friction);
    friction += FindHoldPoint(from_there).point_m;
  }

  // faces: what holds, along the mean normal of the balls around
  const std::vector<Face> faces = Faces(params, pairs, hold, memory);
  Vector3 held = Vector3::Zero(), cutting = Vector3::Zero();
  solution.contact_count = 0;
  ContactMemory next;
  for (const Face& face : faces) {
    const double size = face.hold.norm();
    if (size <= 0.0) continue;
    Vector3 n = face.hold / size;
    next.face_n_G[static_cast<std::size_t>(next.face_count++)] = n;
    Vector3 center_T = face.raw_center_T / face.multiplier;
    double radius = face.raw_radius / face.multiplier, weight = face.lens;
    if (face.known >= 0) {
      const FaceSums& sums = near.faces[static_cast<std::size_t>(face.known)];
      if (sums.weight > 0.0) {
        n = sums.n.normalized();
        center_T = sums.center_T / sums.weight;
        radius = sums.radius / sums.weight;
      }
    }
    held += size * n;
    cutting += face.cutting.norm() * n;
    SolvedContact& contact = solution.contacts[static_cast<std::size_t>(solution.contact_count++)];
    contact = {.n = n,
               .p_T_m = center_T - radius * (input.R_GT.transpose() * n),
               .multiplier_m = size,
               .weight = weight,
               .cutting = face.cutting.squaredNorm() > 0.0};
  }
  solution.cutting_m = cutting.norm();
  solution.n = solution.cutting_m > 0.0 ? Vector3(cutting / solution.cutting_m) : Vector3::Zero();
  // each contact takes its share of the friction along: its direction tilts, and lifts off with its normal
  // force
  for (int c = 0; c < solution.contact_count; ++c) {
    SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    const Vector3 v =
        contact.multiplier_m * contact.n + contact.multiplier_m / std::max(normal, 1e-30) * friction;
    contact.multiplier_m = v.norm();
    contact.n = v / contact.multiplier_m;
  }
  Vector3 at = Vector3::Zero();  // from the tool's pose, where all contacts hold it
  for (int c = 0; c < solution.contact_count; ++c) {
    const SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    at += contact.multiplier_m * contact.n;
  }
  for (int c = 0; c < solution.contact_count; ++c) {
    SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    contact.gap_m = -contact.n.dot(at);
  }
  solution.delta = hold.point_m + friction;

  // the rest, nearest first: planes that the servo loop may meet before the next frame
  std::vector<std::size_t> order(pairs.size());
  std::vector<double> room(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    order[i] = i;
    room[i] = planes[i].n.dot(hold.point_m) - planes[i].offset;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return room[a] < room[b]; });
  for (const std::size_t i : order) {
    if (next.pair_count < kRememberedPairs)
      next.pairs[static_cast<std::size_t>(next.pair_count++)] = pairs[i]->pair;
    if (solution.contact_count >= kMaxContacts) continue;
    const NearPair& pair = *pairs[i];
    bool covered = false;
    for (int c = 0; c < solution.contact_count; ++c)
      covered = covered || solution.contacts[static_cast<std::size_t>(c)].n.dot(pair.n) > kFaceCosine;
    if (covered) continue;
    // never in the way of where the contacts hold the tool
    solution.contacts[static_cast<std::size_t>(solution.contact_count++)] = {
        .n = pair.n,
        .p_T_m = pair.center_T_m - pair.tool_radius_m * (input.R_GT.transpose() * pair.n),
        .gap_m = std::max(-planes[i].offset, -pair.n.dot(at)),
        .weight = LensOf(params, pair),
        .cutting = pair.cutting};
  }
  next.friction = memory.friction;
  memory = next;
}

}  // namespace osteon::simulation
