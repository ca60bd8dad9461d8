#include "simulation/methods/ball_bone.h"

#include <limits>
#include <stdexcept>

#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {

std::vector<Ball> AsBalls(std::span<const MassPoint> points) {
  std::vector<Ball> balls;
  balls.reserve(points.size());
  for (const MassPoint& point : points) balls.push_back({.center_m = point.p_m, .radius_m = 0.0});
  return balls;
}

MaterialIndex NearestMaterial(std::span<const MassPoint> points, const LiveTree& tree, const Vector3& p_m) {
  MaterialIndex material = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  // double the search radius until it is at least the distance of the nearest point found
  for (double reach_m = 1e-3; reach_m < 1.0 && nearest_m > reach_m; reach_m *= 2.0)
    tree.ForEachNear(p_m, reach_m, 0.0, [&](std::uint32_t i) {
      const double distance_m = (Vector3(points[i].p_m) - p_m).norm();
      if (distance_m >= nearest_m) return;
      nearest_m = distance_m;
      material = points[i].material;
    });
  return material;
}

BallBone::BallBone(const Bone& bone, const Solid* solid)
    : points_(bone.points),
      cleared_(bone.points.size(), 0),
      ball_tree_(bone.balls),
      point_tree_(AsBalls(bone.points)) {
  balls_.reserve(bone.balls.size());
  for (const Ball& ball : bone.balls) {
    const Vector3 center = ball.center_m;
    const MaterialIndex material =
        solid ? solid->MaterialAt(center) : NearestMaterial(points_, point_tree_, center);
    const double density =
        material < bone.materials.size() ? bone.materials[material].density_kg_per_m3 : 0.0;
    balls_.push_back({.center_m = center, .radius_m = ball.radius_m, .density_kg_per_m3 = density});
  }
}

std::vector<Ball> BallBone::Left() const {
  std::vector<Ball> left;
  for (const LiveBall& ball : balls_)
    if (ball.radius_m > 0.0) left.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  return left;
}

void BallBone::Replace(std::uint32_t index, const Vector3& center_m, double radius_m) {
  balls_[index].center_m = center_m;
  balls_[index].radius_m = radius_m;
  if (radius_m <= 0.0)
    ball_tree_.Remove(index);
  else
    ball_tree_.Grow(index, center_m, radius_m);  // the printed equation 5 moves balls by half a millimetre
}

void BallBone::Cut(const Vector3& a, const Vector3& b, double radius_m,
                   std::array<double, kMaxMaterials>& removed_m3) {
  ForEachBallNear(a, b, radius_m, [&](std::uint32_t i, const LiveBall& ball) {
    Vector3 center = ball.center_m;
    double radius = ball.radius_m;
    if (ShrinkBall(center, radius, a, b, radius_m)) Replace(i, center, radius);
  });
  ClearPoints(a, b, radius_m, removed_m3);
}

void BallBone::ClearPoints(const Vector3& a, const Vector3& b, double radius_m,
                           std::array<double, kMaxMaterials>& removed_m3) {
  point_tree_.ForEachNear(0.5 * (a + b), radius_m + 0.5 * (b - a).norm(), 0.0, [&](std::uint32_t i) {
    const Vector3 p = points_[i].p_m;
    if ((p - ClosestOnSegment(p, a, b)).norm() >= radius_m) return;
    cleared_[i] = 1;
    point_tree_.Remove(i);
    removed_m3[points_[i].material] += points_[i].volume_m3;
  });
}

void BallBone::Save(CarvedState& state) const {
  state.balls.reserve(balls_.size() * 4);
  for (const LiveBall& ball : balls_) {
    for (int axis = 0; axis < 3; ++axis) state.balls.push_back(static_cast<float>(ball.center_m[axis] * 1e3));
    state.balls.push_back(static_cast<float>(ball.radius_m * 1e3));
  }
  state.cleared = cleared_;
}

void BallBone::Load(const CarvedState& state) {
  if (state.balls.size() != balls_.size() * 4 || state.cleared.size() != cleared_.size())
    throw std::invalid_argument("carved state: not of this bone");
  std::vector<bool> balls_left(balls_.size()), points_left(points_.size());
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    balls_[i].center_m = 1e-3 * Vector3(state.balls[4 * i], state.balls[4 * i + 1], state.balls[4 * i + 2]);
    balls_[i].radius_m = 1e-3 * static_cast<double>(state.balls[4 * i + 3]);
    balls_left[i] = balls_[i].radius_m > 0.0;
    if (balls_left[i]) ball_tree_.Grow(static_cast<std::uint32_t>(i), balls_[i].center_m, balls_[i].radius_m);
  }
  cleared_ = state.cleared;
  for (std::size_t i = 0; i < points_.size(); ++i) points_left[i] = cleared_[i] == 0;
  ball_tree_.Restore(balls_left);
  point_tree_.Restore(points_left);
}

}  // namespace osteon::simulation
