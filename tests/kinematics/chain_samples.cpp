#include "tests/kinematics/chain_samples.h"

#include <numbers>

namespace osteon::kinematics {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A joint and its link in an LBR's description.
struct LinkRow {
  double y, z;  // the joint's origin in the previous link [m]
  Vector3 axis;
  double range_deg, velocity_deg_per_s, acceleration, torque;  // limits; the last two in rad/s^2 and N·m
  double mass;                                                 // [kg]
  Vector3 centre;                                              // centre of mass in the link [m]
  double xx, yy, zz, yz, xy, xz;                               // inertia about the centre of mass [kg m^2]
};

Matrix3 RandomRotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

// Each component uniform in ±range.
Vector3 RandomVector(std::mt19937_64& random, double range) {
  std::uniform_real_distribution<double> in(-range, range);
  return {in(random), in(random), in(random)};
}

KDL::Vector ToKdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame ToKdl(const Pose& X) {
  const Matrix3 R = X.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          ToKdl(Vector3(X.translation()))};
}

}  // namespace

ChainParams<7> Iiwa14Chain() {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const LinkRow rows[7] = {{0,
                            .1475,
                            z,
                            170,
                            85,
                            8.57,
                            320,
                            5.289529,
                            {0, -.033795, .132404},
                            .042462,
                            .042838,
                            .015870,
                            .006341,
                            0,
                            0},
                           {-.010,
                            .2125,
                            y,
                            120,
                            85,
                            8.57,
                            320,
                            5.688888,
                            {.000136, .047548, .076322},
                            .055182,
                            .053983,
                            .016523,
                            .010034,
                            -3.3e-5,
                            5.6e-5},
                           {.010,
                            .228,
                            z,
                            170,
                            100,
                            8.74,
                            176,
                            3.461245,
                            {0, .034913, .123108},
                            .021720,
                            .020730,
                            .007701,
                            -.003845,
                            0,
                            0},
                           {.0105,
                            .192,
                            -y,
                            120,
                            75,
                            11.36,
                            176,
                            4.122995,
                            {0, -.039793, .086944},
                            .032410,
                            .030758,
                            .009883,
                            -.006022,
                            0,
                            0},
                           {-.0105,
                            .2075,
                            z,
                            170,
                            130,
                            12.23,
                            110,
                            1.563756,
                            {0, -.029824, .076267},
                            .008677,
                            .007297,
                            .003935,
                            .002869,
                            0,
                            0},
                           {-.0707,
                            .1925,
                            y,
                            120,
                            135,
                            15.72,
                            40,
                            2.457878,
                            {0, .07102, .00495},
                            .007227,
                            .006958,
                            .004734,
                            .000318,
                            0,
                            0},
                           {.0707,
                            .091,
                            z,
                            175,
                            135,
                            15.72,
                            40,
                            .265331,
                            {3e-6, -2e-6, .013782},
                            .000175,
                            .000175,
                            .000306,
                            0,
                            0,
                            0}};
  ChainParams<7> chain;
  for (std::size_t i = 0; i < 7; ++i) {
    const LinkRow& row = rows[i];
    RevoluteJoint& joint = chain.joints[i];
    joint.X_PJ.translation() = Vector3(0, row.y, row.z);
    joint.axis_J = row.axis;
    joint.limits = {.lower_rad = -row.range_deg * kDegree,
                    .upper_rad = row.range_deg * kDegree,
                    .velocity_rad_per_s = row.velocity_deg_per_s * kDegree,
                    .acceleration_rad_per_s2 = row.acceleration,
                    .torque_Nm = row.torque};
    joint.link.mass_kg = row.mass;
    joint.link.p_LLcm_m = row.centre;
    joint.link.I_LLcm_kg_m2 << row.xx, row.xy, row.xz, row.xy, row.yy, row.yz, row.xz, row.yz, row.zz;
  }
  chain.X_LF.translation() = Vector3(0, 0, .035);
  chain.has_masses = true;
  return chain;
}

ChainParams<6> Kr6R900() {
  struct Row {
    Vector3 origin, axis;
    double lower_deg, upper_deg;
  };
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  const Row rows[6] = {{{0, 0, .4}, -z, -170, 170},  {{.025, 0, 0}, y, -190, 45},
                       {{.455, 0, 0}, y, -120, 156}, {{0, 0, .025}, -x, -185, 185},
                       {{.42, 0, 0}, y, -120, 120},  {{0, 0, 0}, -x, -350, 350}};
  ChainParams<6> chain;
  for (std::size_t i = 0; i < 6; ++i) {
    chain.joints[i].X_PJ.translation() = rows[i].origin;
    chain.joints[i].axis_J = rows[i].axis;
    chain.joints[i].limits.lower_rad = rows[i].lower_deg * kDegree;
    chain.joints[i].limits.upper_rad = rows[i].upper_deg * kDegree;
  }
  // tool0: z points out of the flange, which in the zero posture is along x
  chain.X_LF.translation() = Vector3(.09, 0, 0);
  chain.X_LF.linear() = Eigen::AngleAxisd(std::numbers::pi / 2.0, y).toRotationMatrix();
  return chain;
}

template <int N>
ChainParams<N> RandomChain(std::mt19937_64& random) {
  std::uniform_real_distribution<double> fraction(0.1, 1.0);
  ChainParams<N> chain;
  for (RevoluteJoint& joint : chain.joints) {
    joint.X_PJ.linear() = RandomRotation(random);
    joint.X_PJ.translation() = RandomVector(random, 0.3);
    joint.axis_J = RandomVector(random, 1.0).normalized();
    joint.link.mass_kg = 5.0 * fraction(random);
    joint.link.p_LLcm_m = RandomVector(random, 0.15);
    // a rotated box's inertia
    const double m = joint.link.mass_kg, a = 0.2 * fraction(random), b = 0.2 * fraction(random),
                 c = 0.2 * fraction(random);
    const Matrix3 R = RandomRotation(random);
    joint.link.I_LLcm_kg_m2 =
        R * (m / 12.0 * Vector3(b * b + c * c, a * a + c * c, a * a + b * b)).asDiagonal() * R.transpose();
    joint.link.I_LLcm_kg_m2 = (0.5 * (joint.link.I_LLcm_kg_m2 + joint.link.I_LLcm_kg_m2.transpose())).eval();
    joint.rotor_inertia_kg_m2 = 0.1 * fraction(random);
    joint.friction = {.viscous_Nms_per_rad = fraction(random), .coulomb_Nm = fraction(random)};
  }
  chain.X_LF.linear() = RandomRotation(random);
  chain.X_LF.translation() = RandomVector(random, 0.2);
  chain.has_masses = true;
  return chain;
}

template <int N>
KDL::Chain KdlChain(const ChainParams<N>& params) {
  KDL::Chain chain;
  for (const RevoluteJoint& joint : params.joints) {
    const Matrix3 I = joint.link.I_LLcm_kg_m2;
    const KDL::RigidBodyInertia inertia(
        joint.link.mass_kg, ToKdl(joint.link.p_LLcm_m),
        KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
    // the axis is given in the frame of the previous segment
    chain.addSegment(KDL::Segment(KDL::Joint(ToKdl(Vector3(joint.X_PJ.translation())),
                                             ToKdl(Vector3(joint.X_PJ.linear() * joint.axis_J)),
                                             KDL::Joint::RotAxis, 1.0, 0.0, joint.rotor_inertia_kg_m2),
                                  ToKdl(joint.X_PJ), inertia));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), ToKdl(params.X_LF)));
  return chain;
}

template <int N>
JointVectorN<N> RandomJoints(std::mt19937_64& random, double range) {
  std::uniform_real_distribution<double> in(-range, range);
  JointVectorN<N> q;
  for (int i = 0; i < N; ++i) q[i] = in(random);
  return q;
}

template ChainParams<6> RandomChain<6>(std::mt19937_64&);
template ChainParams<7> RandomChain<7>(std::mt19937_64&);
template KDL::Chain KdlChain<6>(const ChainParams<6>&);
template KDL::Chain KdlChain<7>(const ChainParams<7>&);
template JointVectorN<6> RandomJoints<6>(std::mt19937_64&, double);
template JointVectorN<7> RandomJoints<7>(std::mt19937_64&, double);

}  // namespace osteon::kinematics
