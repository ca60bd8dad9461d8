#include "simulation/tools/tool_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

constexpr double kJoin_m = 1e-9;  // largest distance between ends that are accepted as joined
using Point2 = Eigen::Vector2d;   // (r, z)

[[noreturn]] void Refuse(std::size_t piece, const std::string& what) {
  throw std::invalid_argument(fmt::format("tool outline: piece {}: {}", piece + 1, what));
}

/// Area [m²] of the piece's surface of revolution about the axis.
double Area(const ProfilePiece& p) {
  if (p.sphere_radius_m > 0.0) return 2.0 * std::numbers::pi * p.sphere_radius_m * (p.front_z_m - p.back_z_m);
  return std::numbers::pi * (p.front_r_m + p.back_r_m) *
         std::hypot(p.front_r_m - p.back_r_m, p.front_z_m - p.back_z_m);
}

/// The point of the piece that is nearest to q, in the half plane (r, z).
Point2 NearestPointOn(const ProfilePiece& piece, const Point2& q) {
  const Point2 front(piece.front_r_m, piece.front_z_m), back(piece.back_r_m, piece.back_z_m);
  if (piece.sphere_radius_m > 0.0) {
    const Point2 center(0.0, piece.sphere_z_m), out = q - center;
    const double far = out.norm();
    const Point2 on = center + (far > 0.0 ? Point2(out * (piece.sphere_radius_m / far))
                                          : Point2(0.0, piece.sphere_radius_m));
    if (on.y() <= front.y() && on.y() >= back.y()) return on;
    return (q - front).squaredNorm() <= (q - back).squaredNorm() ? front : back;
  }
  const Point2 along = back - front;
  return front + std::clamp((q - front).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
}

// The point in front of which the fraction u of the piece's area lies, and the outward normal there.
std::pair<Point2, Point2> PointAndNormalAt(const ProfilePiece& p, double u) {
  if (p.sphere_radius_m > 0.0) {
    const double z = p.front_z_m + u * (p.back_z_m - p.front_z_m), dz = z - p.sphere_z_m;
    const double r = std::sqrt(std::max(0.0, p.sphere_radius_m * p.sphere_radius_m - dz * dz));
    return {{r, z}, Point2(r, dz) / p.sphere_radius_m};
  }
  const double dr = p.back_r_m - p.front_r_m, dz = p.back_z_m - p.front_z_m;
  // the area from the cone's apex grows with the square of the radius
  const double r =
      std::sqrt(p.front_r_m * p.front_r_m + u * (p.back_r_m * p.back_r_m - p.front_r_m * p.front_r_m));
  const double t = std::abs(dr) > kJoin_m ? (r - p.front_r_m) / dr : u;
  return {{p.front_r_m + t * dr, p.front_z_m + t * dz}, Point2(-dz, dr).normalized()};
}

}  // namespace

ToolProfile::ToolProfile(std::vector<ProfilePiece> pieces) : pieces_(std::move(pieces)) {
  if (pieces_.empty()) throw std::invalid_argument("tool outline: no piece");
  double z = 0.0, r = pieces_.front().front_r_m;  // point at which the next piece has to begin
  if (std::abs(r) > kJoin_m) Refuse(0, fmt::format("found a hole of {:.6g} mm at the apex", r * 1e3));
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const ProfilePiece& p = pieces_[i];
    if (!Eigen::Vector4d(p.front_z_m, p.front_r_m, p.back_z_m, p.back_r_m).allFinite() ||
        !std::isfinite(p.sphere_radius_m + p.sphere_z_m + p.gap_m + p.metal_ratio))
      Refuse(i, "found a number that is not finite");
    if (std::abs(p.front_z_m - z) > kJoin_m || std::abs(p.front_r_m - r) > kJoin_m)
      Refuse(i, fmt::format(
                    "begins at z {:.6g}, r {:.6g} mm, accepted where the one before ends: {:.6g}, {:.6g}",
                    p.front_z_m * 1e3, p.front_r_m * 1e3, z * 1e3, r * 1e3));
    z = p.back_z_m, r = p.back_r_m;
    if (z > p.front_z_m) Refuse(i, fmt::format("runs forward by {:.6g} mm", (z - p.front_z_m) * 1e3));
    if (r < 0.0) Refuse(i, fmt::format("found a radius of {:.6g} mm", r * 1e3));
    if (std::abs(r - p.front_r_m) < kJoin_m && p.front_z_m - z < kJoin_m) Refuse(i, "has no length");
    if (!(p.metal_ratio > 0.0 && p.metal_ratio <= 1.0))
      Refuse(i, fmt::format("metal ratio: found {:.6g}, accepted more than 0 … 1", p.metal_ratio));
    if (!(p.gap_m > 0.0)) Refuse(i, fmt::format("gap: found {:.6g} mm, accepted more than 0", p.gap_m * 1e3));
    if (p.sphere_radius_m > 0.0)
      for (const Point2& end : {Point2(p.front_r_m, p.front_z_m), Point2(p.back_r_m, p.back_z_m)})
        if (std::abs(std::hypot(end.x(), end.y() - p.sphere_z_m) - p.sphere_radius_m) > kJoin_m)
          Refuse(i, "an end lies off its sphere");
    largest_r_m_ = std::max({largest_r_m_, r, p.front_r_m});
    if (p.sphere_radius_m > 0.0 && p.front_z_m >= p.sphere_z_m && z <= p.sphere_z_m)
      largest_r_m_ = std::max(largest_r_m_, p.sphere_radius_m);
  }
  end_z_m_ = z - 2.0 * r;
  if (!(z < 0.0) || !(largest_r_m_ > 0.0)) throw std::invalid_argument("tool outline: encloses nothing");
}

double ToolProfile::RadiusAt(double z_m) const {
  double largest = 0.0;
  for (const ProfilePiece& p : pieces_) {
    if (z_m > p.front_z_m || z_m < p.back_z_m) continue;
    if (p.sphere_radius_m > 0.0) {
      const double dz = z_m - p.sphere_z_m;
      largest = std::max(largest, std::sqrt(std::max(0.0, p.sphere_radius_m * p.sphere_radius_m - dz * dz)));
    } else {
      const double dz = p.back_z_m - p.front_z_m;
      const double at = dz == 0.0 ? std::max(p.front_r_m, p.back_r_m)
                                  : p.front_r_m + (z_m - p.front_z_m) / dz * (p.back_r_m - p.front_r_m);
      largest = std::max(largest, at);
    }
  }
  return largest;
}

SurfacePoint ToolProfile::NearestSurface(const Vector3& p_m) const {
  // Work in the half plane (r, z) through the point and the axis: find the nearest point of all pieces, of
  // the part in the holder, and of its end face.
  const Point2 q(std::hypot(p_m.x(), p_m.y()), p_m.z());
  const Vector3 out =
      q.x() > 0.0 ? Vector3(p_m.x() / q.x(), p_m.y() / q.x(), 0.0) : Vector3(Vector3::UnitX());
  const ProfilePiece& last = pieces_.back();
  const ProfilePiece holder{.front_z_m = last.back_z_m,
                            .front_r_m = last.back_r_m,
                            .back_z_m = end_z_m_,
                            .back_r_m = last.back_r_m};
  Point2 nearest(std::min(q.x(), last.back_r_m), end_z_m_);  // the face at the holder's end
  double min_distance_m = (q - nearest).norm();
  const auto consider = [&](const Point2& on) {
    const double distance = (q - on).norm();
    if (distance < min_distance_m) min_distance_m = distance, nearest = on;
  };
  for (const ProfilePiece& piece : pieces_) consider(NearestPointOn(piece, q));
  if (last.back_r_m > 0.0) consider(NearestPointOn(holder, q));
  const double radius = q.y() >= last.back_z_m ? RadiusAt(q.y()) : last.back_r_m;
  const bool inside = q.y() <= 0.0 && q.y() >= end_z_m_ && q.x() < radius;
  return {.p_m = nearest.x() * out + nearest.y() * Vector3::UnitZ(),
          .distance_m = inside ? -min_distance_m : min_distance_m};
}

Eigen::AlignedBox3d ToolProfile::Bounds() const {
  return {Vector3(-largest_r_m_, -largest_r_m_, end_z_m_), Vector3(largest_r_m_, largest_r_m_, 0.0)};
}

std::vector<SurfaceSample> ToolProfile::Sample(std::size_t count, std::uint64_t seed) const {
  constexpr std::size_t kMin = 64;  // smallest number of samples on a piece
  // The number of samples is proportional to area over gap, because the depth of a scallop between two balls
  // grows with the square of their spacing.
  double total = 0.0;
  for (const ProfilePiece& piece : pieces_) total += Area(piece) / piece.gap_m;
  std::vector<SurfaceSample> samples;
  samples.reserve(count + (kMin + 64) * pieces_.size());
  const auto add = [&](const ProfilePiece& piece, const Point2& at, const Point2& normal, double turn,
                       bool edge) {
    const double phi = 2.0 * std::numbers::pi * turn;
    const Vector3 out(std::cos(phi), std::sin(phi), 0.0);
    samples.push_back({.p_m = at.x() * out + at.y() * Vector3::UnitZ(),
                       .normal = normal.x() * out + normal.y() * Vector3::UnitZ(),
                       .gap_m = piece.gap_m,
                       .cutting = piece.cutting,
                       .edge = edge});
  };
  // R2 sequence: the two-dimensional golden ratio (M. Roberts, The Unreasonable Effectiveness of Quasirandom
  // Sequences, 2018)
  constexpr double kA1 = 0.7548776662466927, kA2 = 0.5698402909980532;
  const auto fraction = [](double x) { return x - std::floor(x); };
  // Start of the sequence. The golden ratio spreads the starts of different seeds.
  const double start = 0.5 + 0.6180339887498949 * static_cast<double>(seed % 1'000'003);
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const ProfilePiece& piece = pieces_[k];
    const double share = Area(piece) / piece.gap_m / total;
    const auto n =
        std::max(std::max(kMin, count / 8), static_cast<std::size_t>(share * static_cast<double>(count)));
    for (std::size_t i = 1; i <= n; ++i) {
      const auto [at, normal] = PointAndNormalAt(piece, fraction(start + kA1 * static_cast<double>(i)));
      add(piece, at, normal, fraction(start + kA2 * static_cast<double>(i)), false);
    }
    // Samples on the piece's two edges, where the gap is largest: a ring for each edge, or a single point at
    // the apex.
    for (const bool back : {false, true}) {
      const auto [at, normal] = PointAndNormalAt(piece, back ? 1.0 : 0.0);
      const bool apex = at.x() <= kJoin_m;
      Point2 mean = normal;
      if (apex)
        mean = Point2::UnitY();
      else if (back && k + 1 < pieces_.size())
        mean = (normal + PointAndNormalAt(pieces_[k + 1], 0.0).second).normalized();
      else if (!back && k > 0)
        mean = (normal + PointAndNormalAt(pieces_[k - 1], 1.0).second).normalized();
      const std::size_t ring = apex ? 1 : std::max(4 * kMin, n / 8);
      for (std::size_t i = 0; i < ring; ++i)
        add(piece, at, mean, fraction(start + static_cast<double>(i) / static_cast<double>(ring)), true);
    }
  }
  return samples;
}

}  // namespace osteon::simulation
