#pragma once

#include <memory>

#include <mujoco/mujoco.h>

#include "kinematics/chain_params.h"

namespace osteon::kinematics {

/// A chain in MuJoCo: an oracle for the chain's dynamics that shares no code with KDL.
template <int N>
class MujocoArm {
 public:
  /// Writes the chain as MJCF for MuJoCo to compile: each link a body at X_PJ with the joint's axis through
  /// its origin, its mass and inertia (by principal moments), and the rotor as the joint's armature; no
  /// shapes, so no contacts.
  MujocoArm(const ChainParams<N>& params, const Vector3& gravity_B);

  [[nodiscard]] JointVectorN<N> InverseDynamics(const JointVectorN<N>& q, const JointVectorN<N>& qd,
                                                const JointVectorN<N>& qdd);
  [[nodiscard]] JointMatrixN<N> MassMatrix(const JointVectorN<N>& q);
  [[nodiscard]] JointVectorN<N> ForwardDynamics(const JointVectorN<N>& q, const JointVectorN<N>& qd,
                                                const JointVectorN<N>& tau);

 private:
  // Sets the state and clears the applied torques.
  void Set(const JointVectorN<N>& q, const JointVectorN<N>& qd);

  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
};

}  // namespace osteon::kinematics
