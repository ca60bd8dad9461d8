#include "kinematics/payload.h"

#include "kinematics/check_chain.h"

namespace osteon::kinematics {

LinkInertia SeenFrom(const Pose& X_AB, const LinkInertia& body_B) {
  const Matrix3 R = X_AB.linear(), I = R * body_B.I_LLcm_kg_m2 * R.transpose();
  return {.mass_kg = body_B.mass_kg,
          .p_LLcm_m = X_AB * body_B.p_LLcm_m,
          .I_LLcm_kg_m2 = 0.5 * (I + I.transpose())};
}

LinkInertia Joined(const LinkInertia& a, const LinkInertia& b) {
  LinkInertia both;
  both.mass_kg = a.mass_kg + b.mass_kg;
  if (both.mass_kg == 0.0) return both;
  both.p_LLcm_m = (a.mass_kg * a.p_LLcm_m + b.mass_kg * b.p_LLcm_m) / both.mass_kg;
  both.I_LLcm_kg_m2 = a.I_LLcm_kg_m2 + PointInertia(a.mass_kg, a.p_LLcm_m - both.p_LLcm_m) + b.I_LLcm_kg_m2 +
                      PointInertia(b.mass_kg, b.p_LLcm_m - both.p_LLcm_m);
  return both;
}

template <int N>
ChainParams<N> WithPayload(const ChainParams<N>& chain, const LinkInertia& payload_F) {
  CheckInertia(payload_F, "payload");
  ChainParams<N> loaded = chain;
  if (!chain.has_masses) return loaded;
  LinkInertia& last = loaded.joints.back().link;
  last = Joined(last, SeenFrom(chain.X_LF, payload_F));
  return loaded;
}

template ChainParams<6> WithPayload(const ChainParams<6>&, const LinkInertia&);
template ChainParams<7> WithPayload(const ChainParams<7>&, const LinkInertia&);

}  // namespace osteon::kinematics
