#include <algorithm>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "safety/workspace.h"

// The apex among zones, for any request and any delay of the arm.

namespace osteon::safety {
namespace {

constexpr double kDt_s = 0.001, kStop_m_per_s2 = 3.0, kMax_m_per_s = 0.25;
constexpr int kRooms = 300, kTicks = 1200;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double Within(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  int Whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  Vector3 In(double most) { return {Within(-most, most), Within(-most, most), Within(-most, most)}; }

  // A room around the origin with obstacles, none of which contains the origin.
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

TEST(WorkspaceZones, NoSequenceOfWishesLeavesAnyRoom) {
  Draw draw(11);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    Vector3 p = Vector3::Zero(), wish = Vector3::Zero();
    for (int tick = 0; tick < kTicks; ++tick) {
      if (tick % 60 == 0) wish = draw.In(1.0).normalized() * draw.Within(0.0, kMax_m_per_s);
      p += kDt_s * room.Limit(p, wish, kDt_s).v_WT;
      ASSERT_GE(room.Distance(p), -1e-9) << "room " << i << ", tick " << tick;
    }
  }
}

// From any state that the limiter allows, a stop at the stop's deceleration ends inside although nothing
// limits it any more. This also holds if the stop begins ticks after its request, with the limiter at work
// until then.
TEST(WorkspaceZones, AStopFromAnywhereEndsInside) {
  Draw draw(12);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    Vector3 p = Vector3::Zero(), v = Vector3::Zero();
    const Vector3 wish = draw.In(1.0).normalized() * draw.Within(0.05, kMax_m_per_s);
    const int ticks = draw.Whole(1, 600);
    for (int tick = 0; tick < ticks; ++tick) {
      v = room.Limit(p, wish, kDt_s).v_WT;
      p += kDt_s * v;
    }
    while (v.norm() > 0.0) {
      v *= std::max(0.0, 1.0 - kStop_m_per_s2 * kDt_s / v.norm());
      p += kDt_s * v;
      ASSERT_GE(room.Distance(p), -1e-9) << "room " << i;
    }
  }
}

// An arm that lags by some ticks and smooths the motion exceeds the bounds at most by the corner that it
// cuts.
TEST(WorkspaceZones, AnArmThatLagsStaysInside) {
  Draw draw(13);
  for (int i = 0; i < kRooms; ++i) {
    const Workspace room(draw.Room());
    const double pole = draw.Within(0.02, 1.0);
    std::deque<Vector3> on_the_way(static_cast<std::size_t>(draw.Whole(0, 20)), Vector3::Zero());
    Vector3 p = Vector3::Zero(), arm = p, wish = p;
    for (int tick = 0; tick < kTicks; ++tick) {
      if (tick % 80 == 0) wish = draw.In(1.0).normalized() * draw.Within(0.0, kMax_m_per_s);
      p += kDt_s * room.Limit(p, wish, kDt_s).v_WT;
      on_the_way.push_back(p);
      arm += pole * (on_the_way.front() - arm);
      on_the_way.pop_front();
      const double lag_m = (p - arm).norm();
      ASSERT_GE(room.Distance(arm), -std::min(lag_m, 0.5e-3) - 1e-12) << "room " << i;
    }
  }
}

// Toward a plane at a slant, and then along it: the component along the plane is never reduced, for any plane
// and any rounding of a position on it. Nor is anything removed suddenly.
TEST(WorkspaceZones, PushedAtASlantTheToolSlides) {
  Draw draw(14);
  for (int i = 0; i < kRooms; ++i) {
    const Vector3 inward = draw.In(1.0).normalized();
    WorkspaceParams params{.deceleration_m_per_s2 = kStop_m_per_s2};
    params.zones.push_back({.p_W_m = draw.In(0.5), .R_W = RotationFromZTo(inward)});
    const Workspace room(params);
    const Vector3 along = inward.cross(draw.In(1.0)).normalized() * draw.Within(0.0, 0.2);
    const Vector3 wish = along - draw.Within(0.01, 0.15) * inward;
    Vector3 p = params.zones[0].p_W_m + 0.01 * inward, v = wish;
    for (int tick = 0; tick < kTicks; ++tick) {
      const Vector3 next = room.Limit(p, wish, kDt_s).v_WT;
      ASSERT_LT((next - next.dot(inward) * inward - along).norm(), 1e-9) << "room " << i << ", tick " << tick;
      ASSERT_LT((next - v).norm(), 1.001 * kStop_m_per_s2 * kDt_s) << "room " << i << ", tick " << tick;
      v = next;
      p += kDt_s * v + draw.In(1e-8);  // with the joints' rounding
    }
    EXPECT_LT(std::abs(room.Distance(p)), 1e-6);
  }
}

// Along the inside of a ball, with as much push outwards as along it: the tool goes around, and stops where
// the push has no component along the bound.
TEST(WorkspaceZones, PushedAlongARoundBoundTheToolGoesAround) {
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

TEST(WorkspaceZones, AWayThatBeginsOutsideMayOnlyLeadIn) {
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
