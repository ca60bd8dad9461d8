#include "tests/kinematics/mujoco_arm.h"

#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>

namespace osteon::kinematics {
namespace {

// Numbers for MJCF at full precision.
template <class Derived>
std::string Text(const Eigen::MatrixBase<Derived>& v) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (Eigen::Index i = 0; i < v.size(); ++i) text << (i > 0 ? " " : "") << v(i);
  return text.str();
}

// Quaternion in MJCF's order: w x y z.
std::string Quat(const Matrix3& R) {
  const Eigen::Quaterniond turn(R);
  return Text(Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()));
}

// Moments of inertia, and their axes as right-handed columns. MuJoCo would diagonalise a full inertia itself,
// but only to 1e-7.
Vector3 PrincipalMoments(const Matrix3& I, Matrix3& axes) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(I);
  axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  return solver.eigenvalues();
}

// The chain as a model in MuJoCo's XML format.
template <int N>
std::string Mjcf(const ChainParams<N>& params, const Vector3& gravity_B) {
  std::ostringstream xml;
  xml.precision(std::numeric_limits<double>::max_digits10);
  xml << "<mujoco><compiler angle='radian' boundmass='0' boundinertia='0'/><option gravity='"
      << Text(gravity_B)
      << "' timestep='0.001'><flag contact='disable' constraint='disable'/></option><worldbody>";
  for (const RevoluteJoint& joint : params.joints) {
    Matrix3 axes;
    const Vector3 moments = PrincipalMoments(joint.link.I_LLcm_kg_m2, axes);
    xml << "<body pos='" << Text(Vector3(joint.X_PJ.translation())) << "' quat='" << Quat(joint.X_PJ.linear())
        << "'><joint type='hinge' axis='" << Text(joint.axis_J) << "' armature='" << joint.rotor_inertia_kg_m2
        << "'/><inertial mass='" << joint.link.mass_kg << "' pos='" << Text(joint.link.p_LLcm_m) << "' quat='"
        << Quat(axes) << "' diaginertia='" << Text(moments) << "'/>";
  }
  for (int i = 0; i < N; ++i) xml << "</body>";
  xml << "</worldbody></mujoco>";
  return xml.str();
}

}  // namespace

template <int N>
MujocoArm<N>::MujocoArm(const ChainParams<N>& params, const Vector3& gravity_B) {
  // MuJoCo reads only files, so the text goes into MuJoCo's virtual file system
  const std::string xml = Mjcf(params, gravity_B);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(xml.size())) != 0)
    throw std::runtime_error("MuJoCo takes no file");
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  model_.reset(mj_loadXML("arm.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model_ || model_->nv != N) throw std::runtime_error(std::string("MuJoCo refuses the arm: ") + error);
  data_.reset(mj_makeData(model_.get()));
}

template <int N>
void MujocoArm<N>::Set(const JointVectorN<N>& q, const JointVectorN<N>& qd) {
  for (int i = 0; i < N; ++i) {
    data_->qpos[i] = q[i];
    data_->qvel[i] = qd[i];
    data_->qfrc_applied[i] = 0.0;
  }
}

template <int N>
JointVectorN<N> MujocoArm<N>::InverseDynamics(const JointVectorN<N>& q, const JointVectorN<N>& qd,
                                              const JointVectorN<N>& qdd) {
  Set(q, qd);
  for (int i = 0; i < N; ++i) data_->qacc[i] = qdd[i];
  mj_inverse(model_.get(), data_.get());
  return Eigen::Map<JointVectorN<N>>(data_->qfrc_inverse);
}

template <int N>
JointMatrixN<N> MujocoArm<N>::MassMatrix(const JointVectorN<N>& q) {
  Set(q, JointVectorN<N>::Zero());
  mj_forward(model_.get(), data_.get());
  Eigen::Matrix<double, N, N, Eigen::RowMajor> M;
  mj_fullM(model_.get(), M.data(), data_->qM);
  return M;
}

template <int N>
JointVectorN<N> MujocoArm<N>::ForwardDynamics(const JointVectorN<N>& q, const JointVectorN<N>& qd,
                                              const JointVectorN<N>& tau) {
  Set(q, qd);
  for (int i = 0; i < N; ++i) data_->qfrc_applied[i] = tau[i];
  mj_forward(model_.get(), data_.get());
  return Eigen::Map<JointVectorN<N>>(data_->qacc);
}

template class MujocoArm<6>;
template class MujocoArm<7>;

}  // namespace osteon::kinematics
