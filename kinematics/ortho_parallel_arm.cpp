#include "kinematics/ortho_parallel_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "kinematics/two_links.h"

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi, kTurn = 2.0 * kPi;

[[noreturn]] void Refuse(const std::string& name, double found, const char* accepted) {
  throw std::invalid_argument("arm: " + name + ": found " + base::NumberText(found) + ", accepted " +
                              accepted);
}

// A joint value chosen by FitToLimits, and how far it is beyond the limits (<= 0: within).
struct FittedJoint {
  double q, beyond;
};

// Chooses between q and its equivalents one turn away: the one within the limits or, if none is, the one
// least beyond them.
FittedJoint FitToLimits(double q, const JointLimits& limit) {
  q = q > kPi ? q - kTurn : q < -kPi ? q + kTurn : q;
  if (q >= limit.lower_rad && q <= limit.upper_rad) return {q, 0.0};
  const double other = q < limit.lower_rad ? q + kTurn : q - kTurn;
  const double beyond = std::max(limit.lower_rad - q, q - limit.upper_rad);
  const double beyond_other = std::max(limit.lower_rad - other, other - limit.upper_rad);
  return beyond_other < beyond ? FittedJoint{other, beyond_other} : FittedJoint{q, beyond};
}

// Returns the value nearest to `seed` among q and its equivalents, up to two turns away, that are within the
// limits.
double NearestEquivalent(double q, const JointLimits& limit, double seed) {
  double best = q;
  for (const double other : {q - 2.0 * kTurn, q - kTurn, q + kTurn, q + 2.0 * kTurn})
    if (other >= limit.lower_rad && other <= limit.upper_rad &&
        std::abs(other - seed) < std::abs(best - seed))
      best = other;
  return best;
}

// An angle, stored as its cosine and sine.
struct Angle {
  double c, s;
};

Angle Sum(const Angle& a, const Angle& b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }
Angle AngleOf(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
double Radians(const Angle& a) { return std::atan2(a.s, a.c); }

// Returns the parameters. @throws std::invalid_argument if a length, a sign or a limit is out of range.
const OrthoParallelParams& Validated(const OrthoParallelParams& params) {
  for (const auto& [name, value] : {std::pair{"a1_m", params.a1_m},
                                    {"a2_m", params.a2_m},
                                    {"b_m", params.b_m},
                                    {"c1_m", params.c1_m},
                                    {"c4_m", params.c4_m}})
    if (!std::isfinite(value)) Refuse(name, value, "a finite length");
  for (const auto& [name, value] : {std::pair{"c2_m", params.c2_m}, {"c3_m", params.c3_m}})
    if (!(std::isfinite(value) && value > 0.0)) Refuse(name, value, "> 0");
  for (std::size_t i = 0; i < 6; ++i) {
    const JointLimits& limit = params.limits[i];
    const std::string of = " of A" + std::to_string(i + 1);
    if (std::abs(params.sign[i]) != 1.0) Refuse("sign" + of, params.sign[i], "1 or -1");
    if (!(std::abs(params.offset_rad[i]) <= kPi))
      Refuse("offset" + of + " [rad]", params.offset_rad[i], "-pi … pi");
    if (!(std::abs(limit.lower_rad) <= kTurn))
      Refuse("lower position limit" + of + " [rad]", limit.lower_rad, "-2 pi … 2 pi");
    if (!(limit.upper_rad > limit.lower_rad && limit.upper_rad <= kTurn))
      Refuse("upper position limit" + of + " [rad]", limit.upper_rad, "above the lower one … 2 pi");
  }
  return params;
}

}  // namespace

OrthoParallelArm::OrthoParallelArm(const OrthoParallelParams& params)
    : params_(Validated(params)),
      chain_(ChainFrom(params)),
      fore_m_(std::hypot(params.a2_m, params.c3_m)),
      fore_rad_(std::atan2(params.a2_m, params.c3_m)) {}

JacobianN<6> OrthoParallelArm::JacobianAt(const Joints& q, const Vector3& p_F) const OSTEON_RT {
  const SerialChain<6>::Posture posture = chain_.ComputePosture(q);
  return chain_.JacobianAt(posture, posture.X_BF * p_F);
}

int OrthoParallelArm::Configuration(const Joints& q) const OSTEON_RT {
  const auto theta = [&](int i) {
    const auto joint = static_cast<std::size_t>(i);
    return params_.sign[joint] * q[i] - params_.offset_rad[joint];
  };
  const double gamma = theta(2) + fore_rad_;
  // distance of the wrist in front of A1, in the arm's plane
  const double front =
      params_.a1_m + params_.c2_m * std::sin(theta(1)) + fore_m_ * std::sin(theta(1) + gamma);
  return (front < 0.0 ? 1 : 0) + (std::sin(gamma) < 0.0 ? 2 : 0) + (std::sin(theta(4)) < 0.0 ? 4 : 0);
}

// More than 60 lines, because this follows one paper's derivation of the eight solutions, in its order and
// with its symbols.
OrthoParallelSolutions OrthoParallelArm::Solve(const Pose& X_BF, const Joints& seed) const OSTEON_RT {
  OrthoParallelSolutions result;
  const Vector3 wrist = X_BF.translation() - params_.c4_m * X_BF.linear().col(2);
  if (!std::isfinite(X_BF.linear().sum() + wrist.sum())) {
    result.out_of_reach_m = std::numeric_limits<double>::quiet_NaN();
    return result;
  }

  // a wrist nearer to A1 than |b| is in no arm plane
  const double from_axis = std::hypot(wrist.x(), wrist.y()), b = params_.b_m;
  if (from_axis < std::abs(b) - kFreeJoint) {
    result.out_of_reach_m = from_axis - std::abs(b);
    return result;
  }
  const double front = std::sqrt(std::max(0.0, (from_axis - b) * (from_axis + b)));
  // value of theta_i that corresponds to the seed, for a joint that a singularity leaves free
  const auto free_theta = [&](std::size_t i) {
    return std::remainder(params_.sign[i] * seed[static_cast<int>(i)] - params_.offset_rad[i], kTurn);
  };

  result.out_of_reach_m = std::numeric_limits<double>::infinity();
  for (unsigned side = 0; side < 2; ++side) {
    // the arm plane with the wrist in front of A1, or behind it
    const double x_1 = side == 0 ? front : -front, square_m2 = from_axis * from_axis;
    std::array<double, 6> theta{};
    Angle turn;
    if (from_axis < kFreeJoint) {
      theta[0] = free_theta(0);
      turn = AngleOf(theta[0]);
    } else {
      turn = {(x_1 * wrist.x() + b * wrist.y()) / square_m2, (x_1 * wrist.y() - b * wrist.x()) / square_m2};
      theta[0] = Radians(turn);
    }

    // in this plane the two links connect A2 with the wrist
    const double x = x_1 - params_.a1_m, z = wrist.z() - params_.c1_m, reach = std::hypot(x, z);
    const TwoLinks links = SolveTwoLinks(params_.c2_m, fore_m_, reach);
    if (std::abs(links.out_of_reach_m) < std::abs(result.out_of_reach_m))
      result.out_of_reach_m = links.out_of_reach_m;
    if (links.out_of_reach_m != 0.0) continue;
    const double elbow_rad = std::atan2(links.sin_elbow, links.cos_elbow);

    for (unsigned bent_back = 0; bent_back < 2; ++bent_back) {
      const Angle gamma{links.cos_elbow, bent_back == 0 ? links.sin_elbow : -links.sin_elbow};
      const double along = params_.c2_m + fore_m_ * gamma.c, across = fore_m_ * gamma.s;
      Angle tilt;
      if (reach < kFreeJoint) {  // equal links, folded
        theta[1] = free_theta(1);
        tilt = AngleOf(theta[1]);
      } else {
        tilt = {(z * along + x * across) / (reach * reach), (x * along - z * across) / (reach * reach)};
        theta[1] = Radians(tilt);
      }
      theta[2] = (bent_back == 0 ? elbow_rad : -elbow_rad) - fore_rad_;

      // axes of the forearm; A4, A5 and A6 make the remaining rotation from the forearm to the flange
      const Angle pitch = Sum(Sum(tilt, gamma), {params_.c3_m / fore_m_, -params_.a2_m / fore_m_});
      const Vector3 x_c(turn.c * pitch.c, turn.s * pitch.c, -pitch.s), y_c(-turn.s, turn.c, 0.0);
      const Vector3 z_c(turn.c * pitch.s, turn.s * pitch.s, pitch.c);
      const WristAngles hand = SolveWrist(x_c, y_c, z_c, X_BF.linear(), free_theta(3));
      theta[3] = hand.turn, theta[4] = hand.tilt, theta[5] = hand.twist;
      SetPair(theta, result.configuration[side + 2u * bent_back],
              result.configuration[side + 2u * bent_back + 4u]);
    }
  }
  return result;
}

// Sets two postures: the given one with positive wrist tilt, and the flipped one, with A5 negated and A4 and
// A6 half a turn away.
void OrthoParallelArm::SetPair(const std::array<double, 6>& theta, OrthoParallelSolution& straight,
                               OrthoParallelSolution& flipped) const OSTEON_RT {
  straight.exists = flipped.exists = true;
  const auto set = [this](std::size_t i, double angle, OrthoParallelSolution& solution) {
    const FittedJoint fitted =
        FitToLimits(params_.sign[i] * (angle + params_.offset_rad[i]), params_.limits[i]);
    solution.q[static_cast<int>(i)] = fitted.q;
    if (fitted.beyond <= 0.0) return;
    solution.beyond = static_cast<std::uint8_t>(solution.beyond | 1u << i);
    if (!(fitted.beyond > solution.beyond_rad)) return;
    solution.beyond_rad = fitted.beyond;
    solution.worst_joint = static_cast<int>(i);
  };
  for (std::size_t i = 0; i < 3; ++i) set(i, theta[i], straight);
  flipped = straight;
  for (std::size_t i = 3; i < 6; ++i) {
    set(i, theta[i], straight);
    set(i, i == 4 ? -theta[i] : theta[i] - std::copysign(kPi, theta[i]), flipped);
  }
}

bool OrthoParallelArm::Nearest(const OrthoParallelSolutions& solutions, const Joints& seed,
                               Joints& q) const OSTEON_RT {
  Joints best = seed;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const OrthoParallelSolution& solution : solutions.configuration) {
    if (!solution.valid()) continue;
    Joints candidate;
    for (int i = 0; i < 6; ++i)
      candidate[i] = NearestEquivalent(solution.q[i], params_.limits[static_cast<std::size_t>(i)], seed[i]);
    const double distance = (candidate - seed).squaredNorm();
    if (!(distance < best_distance)) continue;
    best = candidate;
    best_distance = distance;
  }
  if (!std::isfinite(best_distance)) return false;
  q = best;
  return true;
}

bool OrthoParallelArm::Inverse(const Pose& X_BF, const Joints& seed, Joints& q) const OSTEON_RT {
  return Nearest(Solve(X_BF, seed), seed, q);
}

}  // namespace osteon::kinematics
