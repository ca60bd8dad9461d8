#include <algorithm>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "safety/workspace.h"

// The workspace's limits with random zones: the tool's apex stays inside for any requested velocity and any
// delay of the arm.

namespace osteon::safety {
namespace {

constexpr double kDt_s = 0.001, kStop_m_per_s2 = 3.0, kMax_m_per_s = 0.25;
constexpr int kRooms = 300, kTicks = 1200;  // random workspaces; ticks in each

// Draws random numbers and workspaces from a seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double Within(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  int Whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  // A vector in the cube from -max to max.
  Vector3 In(double max) { return {Within(-max, max), Within(-max, max), Within(-max, max)}; }

  // A workspace around the origin with one to five zones; the origin is permitted by each of them.
  WorkspaceParams Room() {
    WorkspaceParams room{.sphere_radius_m = Within(0.05, 0.3),
                         .plane_normal_W = In(1.0).normalized(),
                         .plane_offset_m = -Within(0.005, 0.2),
                         .deceleration_m_per_s2 = kStop_m_per_s2};
    const int count = Whole(1, 5);
    while (static_cast<int>(room.zones.size()) < count) {
      ZoneParams zone{.shape = static_cast<ZoneShape>(Whole(0, 4)),
                      .side = static_cast<ZoneSide>(Whole(0, 1)),
                      .p_W_m = In(0.15),
                      .R_W = RotationFromZTo(In(1.0).normalized()),
                      .half_edge_m = {Within(0.01, 0.2), Within(0.01, 0.2), Within(0.01, 0.2)},
                      .radius_m = Within(0.01, 0.2),
                      .half_length_m = Within(0.01, 0.2)};
      if (ZoneBounds(zone, Vector3::Zero()).distance_m() > 1e-3) room.zones.push_back(zone);
    }
    return room;
  }

 private:
  std::mt19937_64 random_;
};

TEST(WorkspaceZones, NoSequenceOfRequestedVelocitiesLeavesARandomWorkspace) {
  Draw draw(11);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    Vector3 p = Vector3::Zero(), requested_v = Vector3::Zero();
    for (int tick = 0; tick < kTicks; ++tick) {
      if (tick % 60 == 0) requested_v = draw.In(1.0).normalized() * draw.Within(0.0, kMax_m_per_s);
      p += kDt_s * room.Limit(p, requested_v, kDt_s).v_WT;
      ASSERT_GE(room.Distance(p), -1e-9) << "room " << i << ", tick " << tick;
    }
  }
}

// From any state that the limiter allows, a stop at the given deceleration ends inside, although the limiter
// no longer acts while the tool brakes.
TEST(WorkspaceZones, AStopFromAnyAllowedStateEndsInside) {
  Draw draw(12);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    Vector3 p = Vector3::Zero(), v = Vector3::Zero();
    const Vector3 requested_v = draw.In(1.0).normalized() * draw.Within(0.05, kMax_m_per_s);
    const int ticks = draw.Whole(1, 600);
    for (int tick = 0; tick < ticks; ++tick) {
      v = room.Limit(p, requested_v, kDt_s).v_WT;
      p += kDt_s * v;
    }
    while (v.norm() > 0.0) {
      v *= std::max(0.0, 1.0 - kStop_m_per_s2 * kDt_s / v.norm());
      p += kDt_s * v;
      ASSERT_GE(room.Distance(p), -1e-9) << "room " << i;
    }
  }
}

// An arm that lags by some ticks and smooths the motion exceeds the bounds at most by the corner of the path
// that it cuts off.
TEST(WorkspaceZones, AnArmThatLagsStaysInsideUpToTheCornersThatItCuts) {
  Draw draw(13);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    const double pole = draw.Within(0.02, 1.0);
    std::deque<Vector3> on_the_way(static_cast<std::size_t>(draw.Whole(0, 20)), Vector3::Zero());
    Vector3 p = Vector3::Zero(), arm = p, requested_v = p;
    for (int tick = 0; tick < kTicks; ++tick) {
      if (tick % 80 == 0) requested_v = draw.In(1.0).normalized() * draw.Within(0.0, kMax_m_per_s);
      p += kDt_s * room.Limit(p, requested_v, kDt_s).v_WT;
      on_the_way.push_back(p);
      arm += pole * (on_the_way.front() - arm);
      on_the_way.pop_front();
      const double lag_m = (p - arm).norm();
      ASSERT_GE(room.Distance(arm), -std::min(lag_m, 0.5e-3) - 1e-12) << "room " << i;
    }
  }
}

// The requested velocity leads toward a plane at a slant. Its component along the plane is never reduced, and
// its normal component decreases no faster than the stop's deceleration.
TEST(WorkspaceZones, AToolPushedAgainstAPlaneAtASlantSlidesAlongIt) {
  Draw draw(14);
  for (int i = 0; i < kRooms; ++i) {
    const Vector3 inward = draw.In(1.0).normalized();
    WorkspaceParams params{.deceleration_m_per_s2 = kStop_m_per_s2};
    params.zones.push_back({.p_W_m = draw.In(0.5), .R_W = RotationFromZTo(inward)});
    const Workspace room(params);
    const Vector3 along = inward.cross(draw.In(1.0)).normalized() * draw.Within(0.0, 0.2);
    const Vector3 requested_v = along - draw.Within(0.01, 0.15) * inward;
    Vector3 p = params.zones[0].p_W_m + 0.01 * inward, v = requested_v;
    for (int tick = 0; tick < kTicks; ++tick) {
      const Vector3 next = room.Limit(p, requested_v, kDt_s).v_WT;
      ASSERT_LT((next - next.dot(inward) * inward - along).norm(), 1e-9) << "room " << i << ", tick " << tick;
      ASSERT_LT((next - v).norm(), 1.001 * kStop_m_per_s2 * kDt_s) << "room " << i << ", tick " << tick;
      v = next;
      p += kDt_s * v + draw.In(1e-8);  // plus an error like that of rounding in the joints
    }
    EXPECT_LT(std::abs(room.Distance(p)), 1e-6);
  }
}

// First a constant push: the tool slides along the sphere and stops where the push has no component along it.
// Then the push has equal parts outwards and along the sphere: the tool moves around the sphere.
TEST(WorkspaceZones, AToolPushedAlongTheInsideOfASphereGoesAround) {
  const Workspace room({.sphere_radius_m = 0.1, .deceleration_m_per_s2 = kStop_m_per_s2});
  Vector3 p = Vector3::Zero(), v(0.1, 0.1, 0.0);
  for (int tick = 0; tick < 5 * kTicks; ++tick) {
    const Vector3 next = room.Limit(p, {0.1, 0.1, 0.0}, kDt_s).v_WT;
    if (tick > 0) {
      ASSERT_LT((next - v).norm(), 1.001 * kStop_m_per_s2 * kDt_s) << "tick " << tick;
    }
    v = next;
    p += kDt_s * v;
  }
  EXPECT_LT(room.Distance(p), 1e-4);

  v.setZero();
  for (int tick = 0; tick < kTicks; ++tick) {
    const Vector3 out = p.normalized(), around(-out.y(), out.x(), 0.0);
    const Vector3 next = room.Limit(p, 0.1 * (out + around), kDt_s).v_WT;
    if (tick > 0) {
      ASSERT_LT((next - v).norm(), kStop_m_per_s2 * kDt_s) << "tick " << tick;
      EXPECT_GT(next.dot(around), 0.09) << "tick " << tick;
    }
    v = next;
    p += kDt_s * v;
    ASSERT_GE(room.Distance(p), -1e-12);
  }
}

TEST(WorkspaceZones, APathThatBeginsOutsideAZoneMayOnlyLeadIn) {
  WorkspaceParams params;
  params.zones.push_back({.shape = ZoneShape::kHalfSpace, .point = ZonePoint::kElbow});
  const Workspace room(params);
  EXPECT_FALSE(room.LeavesZone(ZonePoint::kElbow, {0, 0, -0.2}, {0, 0, -0.1})) << "on its way in";
  EXPECT_TRUE(room.LeavesZone(ZonePoint::kElbow, {0, 0, -0.1}, {0, 0, -0.2}));
  EXPECT_TRUE(room.LeavesZone(ZonePoint::kElbow, {0, 0, 0.01}, {0, 0, -0.01}));
  EXPECT_FALSE(room.LeavesZone(ZonePoint::kFlange, {0, 0, 0.01}, {0, 0, -0.01})) << "it has none";
  EXPECT_FALSE(room.LeavesZone(ZonePoint::kApex, {0, 0, 0}, {0, 0, -5.0})) << "its own bounds do not count";
}

}  // namespace
}  // namespace osteon::safety
