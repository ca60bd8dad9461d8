#include "studies/bench/bench_kinematics.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <kdl/config.h>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/no_alloc_scope.h"
#include "base/percentile.h"
#include "base/write_text.h"
#include "config/reading/load_robot.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/serial_chain.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"

// The only file outside the tests that uses KDL: the reference for the speed of the arm's mathematics.

namespace osteon::studies {
namespace {

using Clock = std::chrono::steady_clock;
using kinematics::ChainParams;
using kinematics::JointVectorN;

// number of postures that the calls use in turn; all are within the joint limits
constexpr std::size_t kPostures = 256;
constexpr std::size_t kBatches = 51;     // batches for each function; the median over the batches is reported
constexpr std::size_t kSlowShare = 100;  // KDL's numerical inverse gets 1 / kSlowShare of the calls

// One of our functions and KDL's counterpart. Each call takes the number of a posture and returns part of its
// result, so that the compiler cannot drop the call.
struct Pairing {
  const char* key;
  const char* title;
  std::function<double(std::size_t first, std::size_t calls)> ours, kdl;
  std::size_t kdl_share{1};          // KDL gets 1 / kdl_share of the calls
  double ours_ns{0.0}, kdl_ns{0.0};  // medians of a call
};

// Wraps a batch of calls into one function, so that the compiler optimises the loop.
template <class Call>
std::function<double(std::size_t, std::size_t)> Batch(Call call) {
  return [call](std::size_t first, std::size_t calls) mutable {
    double sum = 0.0;
    for (std::size_t n = 0; n < calls; ++n) sum += call((first + n) % kPostures);
    return sum;
  };
}

volatile double g_sink;  // receives the results, so that the compiler keeps the calls

// Mean time of a call in a batch [ns].
double TimeBatch(const std::function<double(std::size_t, std::size_t)>& batch, std::size_t first,
                 std::size_t calls) {
  const Clock::time_point begun = Clock::now();
  g_sink = batch(first, calls);
  return std::chrono::duration<double, std::nano>(Clock::now() - begun).count() / static_cast<double>(calls);
}

KDL::Vector ToKdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame ToKdl(const Pose& X) {
  const Matrix3 R = X.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          ToKdl(Vector3(X.translation()))};
}

// Converts a chain to KDL, which expects a joint's axis in the frame of the segment before, and a link's
// inertia at the segment's tip, which is the joint.
template <int N>
KDL::Chain KdlChain(const ChainParams<N>& params) {
  KDL::Chain chain;
  for (const kinematics::RevoluteJoint& joint : params.joints) {
    const Matrix3& I = joint.link.I_LLcm_kg_m2;
    chain.addSegment(KDL::Segment(
        KDL::Joint(ToKdl(Vector3(joint.X_PJ.translation())),
                   ToKdl(Vector3(joint.X_PJ.linear() * joint.axis_J)), KDL::Joint::RotAxis, 1.0, 0.0,
                   joint.rotor_inertia_kg_m2),
        ToKdl(joint.X_PJ),
        KDL::RigidBodyInertia(joint.link.mass_kg, ToKdl(joint.link.p_LLcm_m),
                              KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)))));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), ToKdl(params.X_LF)));
  return chain;
}

// The inputs of all calls, and KDL's solvers with their outputs.
template <int N>
struct Workload {
  explicit Workload(const ChainParams<N>& params)
      : arm(params),
        chain(KdlChain(params)),
        forward(chain),
        velocity(chain),
        inverse(chain),
        torques(chain, KDL::Vector(0, 0, -9.81)),
        dynamics(chain, KDL::Vector(0, 0, -9.81)),
        accelerations(chain, KDL::Vector(0, 0, -9.81)),
        wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()) {
    std::mt19937_64 random{7};
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (std::size_t n = 0; n < kPostures; ++n) {
      for (int i = 0; i < N; ++i) {
        const kinematics::JointLimits& limits = params.joints[static_cast<std::size_t>(i)].limits;
        q[n][i] = limits.lower_rad + share(random) * (limits.upper_rad - limits.lower_rad);
        qd[n][i] = (2.0 * share(random) - 1.0) * limits.velocity_rad_per_s;
        qdd[n][i] = (2.0 * share(random) - 1.0) * limits.acceleration_rad_per_s2;
      }
      for (auto [kdl, own] : {std::pair{&kdl_q, &q}, std::pair{&kdl_qd, &qd}, std::pair{&kdl_qdd, &qdd}}) {
        (*kdl)[n] = KDL::JntArray(N);
        (*kdl)[n].data = (*own)[n];
      }
      X_BF[n] = arm.FlangePose(q[n]);
      kdl_X_BF[n] = ToKdl(X_BF[n]);
    }
  }

  kinematics::SerialChain<N> arm;
  std::array<JointVectorN<N>, kPostures> q, qd, qdd;
  std::array<Pose, kPostures> X_BF;
  typename kinematics::SerialChain<N>::Posture posture;
  kinematics::JacobianN<N> own_J;
  std::array<KDL::JntArray, kPostures> kdl_q, kdl_qd, kdl_qdd;
  std::array<KDL::Frame, kPostures> kdl_X_BF;

  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainJntToJacSolver velocity;
  KDL::ChainIkSolverPos_LMA inverse;
  KDL::ChainIdSolver_RNE torques;
  KDL::ChainDynParam dynamics;
  KDL::ChainFdSolver_RNE accelerations;
  KDL::Wrenches wrenches;
  KDL::Frame frame;
  KDL::Jacobian J{N};
  KDL::JntArray joints{N}, zero{N};
  KDL::JntSpaceInertiaMatrix M{N};
};

// Pairings for forward kinematics and Jacobian. Our Jacobian function also computes the flange's pose, so it
// is also compared with both KDL functions together.
template <int N>
std::vector<Pairing> KinematicsPairings(const std::shared_ptr<Workload<N>>& work) {
  Workload<N>& w = *work;
  const auto fk = [&w](std::size_t n) {
    w.forward.JntToCart(w.kdl_q[n], w.frame);
    return w.frame.p.x();
  };
  const auto jacobian = [&w](std::size_t n) {
    w.velocity.JntToJac(w.kdl_q[n], w.J);
    return w.J(0, 0);
  };
  const auto own_jacobian = [&w](std::size_t n) {
    w.arm.ComputePosture(w.q[n], w.posture);
    w.arm.Jacobian(w.posture, w.own_J);
    return w.own_J(0, 0) + w.posture.X_BF.translation().x();
  };
  return {{"fk", "forward kinematics",
           Batch([&w](std::size_t n) { return w.arm.FlangePose(w.q[n]).translation().x(); }), Batch(fk)},
          {"jacobian", "Jacobian", Batch(own_jacobian), Batch(jacobian)},
          {"fk_jacobian", "both", Batch(own_jacobian),
           Batch([fk, jacobian](std::size_t n) { return fk(n) + jacobian(n); })}};
}

// Pairings for inverse dynamics, mass matrix and forward dynamics.
template <int N>
std::vector<Pairing> DynamicsPairings(const std::shared_ptr<Workload<N>>& work) {
  Workload<N>& w = *work;
  return {{"dynamics", "inverse dynamics",
           Batch([&w](std::size_t n) { return w.arm.InverseDynamics(w.q[n], w.qd[n], w.qdd[n])[0]; }),
           Batch([&w](std::size_t n) {
             w.torques.CartToJnt(w.kdl_q[n], w.kdl_qd[n], w.kdl_qdd[n], w.wrenches, w.joints);
             return w.joints(0);
           })},
          {"mass_matrix", "mass matrix",
           Batch([&w](std::size_t n) { return w.arm.MassMatrix(w.q[n])(0, 0); }), Batch([&w](std::size_t n) {
             w.dynamics.JntToMass(w.kdl_q[n], w.M);
             return w.M(0, 0);
           })},
          {"forward_dynamics", "forward dynamics",
           Batch([&w](std::size_t n) { return w.arm.ForwardDynamics(w.q[n], w.qd[n], w.qdd[n])[0]; }),
           Batch([&w](std::size_t n) {
             w.accelerations.CartToJnt(w.kdl_q[n], w.kdl_qd[n], w.kdl_qdd[n], w.wrenches, w.joints);
             return w.joints(0);
           })}};
}

// Compares our inverse, which finds all closed-form solutions and checks the limits, with KDL's solver, which
// finds one solution or none, starting from zero.
template <int N, class Solve>
Pairing InversePairing(const std::shared_ptr<Workload<N>>& work, Solve solve) {
  Workload<N>& w = *work;
  return {"inverse", "inverse kinematics", Batch([&w, solve](std::size_t n) { return solve(w, n); }),
          Batch([&w](std::size_t n) {
            w.inverse.CartToJnt(w.zero, w.kdl_X_BF[n], w.joints);
            return w.joints(0);
          }),
          kSlowShare};
}

// The pair for a seven-axis arm; nothing if its links have no closed-form solution.
std::optional<Pairing> ClosedForm(const config::RobotModel&, const std::shared_ptr<Workload<7>>& work) {
  std::optional<kinematics::LbrArm> arm;
  try {
    arm.emplace(kinematics::LbrParamsFrom(work->arm.params()));
  } catch (const std::invalid_argument&) {
    return {};
  }
  std::array<double, kPostures> angles{};
  for (std::size_t n = 0; n < kPostures; ++n) angles[n] = arm->ArmAngle(work->q[n]);
  return InversePairing<7>(work, [arm = *arm, angles](const Workload<7>& w, std::size_t n) {
    return arm.Solve(w.X_BF[n], angles[n]).configuration[0].q[0];
  });
}

// The pair for a six-axis arm; nothing if the model has no closed-form solution.
std::optional<Pairing> ClosedForm(const config::RobotModel& model, const std::shared_ptr<Workload<6>>& work) {
  if (!model.ortho_parallel) return {};
  return InversePairing<6>(
      work, [arm = kinematics::OrthoParallelArm(*model.ortho_parallel)](const Workload<6>& w, std::size_t n) {
        return arm.Solve(w.X_BF[n]).configuration[0].q[0];
      });
}

// Counts the heap calls and locks in a hundred calls of each of our functions; nothing if this build can't
// count them.
std::optional<int> CountAllocations(const std::vector<Pairing>& pairings) {
  int calls = 0;
  for (const Pairing& pairing : pairings) {
    rt::NoAllocScope scope;
    g_sink = pairing.ours(0, 100);
    calls += scope.heap_calls() + scope.locks();
  }
  if (!rt::NoAllocScope::Counts()) return {};
  return calls;
}

// Times ours and KDL's in alternating batches, and stores the median time of a call.
void Time(std::vector<Pairing>& pairings, std::size_t calls) {
  for (Pairing& pairing : pairings) {
    const std::size_t own_batch = std::max<std::size_t>(1, calls / kBatches),
                      kdl_batch = std::max<std::size_t>(1, own_batch / pairing.kdl_share);
    std::vector<double> ours, kdl;
    g_sink = pairing.ours(0, own_batch) + pairing.kdl(0, kdl_batch);  // warms caches and branch predictors
    for (std::size_t batch = 0; batch < kBatches && !base::Interrupted(); ++batch) {
      ours.push_back(TimeBatch(pairing.ours, batch * own_batch, own_batch));
      kdl.push_back(TimeBatch(pairing.kdl, batch * kdl_batch, kdl_batch));
    }
    if (base::Interrupted()) return;
    pairing.ours_ns = base::Percentile(ours, 0.5);
    pairing.kdl_ns = base::Percentile(kdl, 0.5);
  }
}

// Lists the pairs of functions. They are measured on the chain of the arm without a tool.
template <int N>
std::vector<Pairing> PairingsOf(const config::RobotModel& model, const ChainParams<N>& params) {
  const auto work = std::make_shared<Workload<N>>(params);
  std::vector<Pairing> pairings = KinematicsPairings(work);
  if (auto inverse = ClosedForm(model, work)) pairings.push_back(std::move(*inverse));
  if (params.has_masses)
    for (Pairing& pairing : DynamicsPairings(work)) pairings.push_back(std::move(pairing));
  // the calls' data must live as long as the calls
  for (Pairing& pairing : pairings)
    pairing.ours = [work, ours = std::move(pairing.ours)](std::size_t first, std::size_t calls) {
      return ours(first, calls);
    };
  return pairings;
}

std::string Text(const std::vector<Pairing>& pairings) {
  std::string text =
      fmt::format("{:<22}{:>10}{:>10}{:>8}\n", "median of a call", "ours ns", "KDL ns", "ratio");
  for (const Pairing& p : pairings)
    text +=
        fmt::format("{:<22}{:>10.1f}{:>10.1f}{:>8.1f}\n", p.title, p.ours_ns, p.kdl_ns, p.kdl_ns / p.ours_ns);
  return text;
}

nlohmann::json Json(const std::vector<Pairing>& pairings) {
  nlohmann::json json{{"schema", "osteon.bench.kinematics/1"}, {"subcommand", "bench kinematics"}};
  for (const char* key :
       {"fk", "jacobian", "fk_jacobian", "inverse", "dynamics", "mass_matrix", "forward_dynamics"}) {
    const auto at = std::find_if(pairings.begin(), pairings.end(),
                                 [&](const Pairing& p) { return std::string_view(p.key) == key; });
    const bool found = at != pairings.end();
    const std::string name = std::string(key) + "_ns";
    json[name] = found ? nlohmann::json(at->ours_ns) : nlohmann::json();
    json["kdl"][name] = found ? nlohmann::json(at->kdl_ns) : nlohmann::json();
    json["ratio"][key] = found ? nlohmann::json(at->kdl_ns / at->ours_ns) : nlohmann::json();
  }
  json["kdl"]["version"] = KDL_VERSION_STRING;
  return json;
}

// Runs the subcommand, except that it throws if the input is bad.
int Run(const BenchKinematicsOptions& options) {
  const std::filesystem::path file =
      options.robot.empty() ? options.config_root / "robots" / "lbr_iiwa_14_r820.yaml" : options.robot;
  const config::RobotModel model = config::LoadRobot(file);
  std::vector<Pairing> pairings =
      std::visit([&](const auto& chain) { return PairingsOf(model, chain); }, model.chain);

  base::InstallInterrupt();
  const std::optional<int> allocations = CountAllocations(pairings);
  Time(pairings, options.calls);
  if (base::Interrupted()) return base::kExitInterrupted;

  const std::string machine = session::MachineName();
  fmt::print("Osteon bench kinematics: {}, {} calls each beside KDL {}, on {}\n\n{}", model.name,
             options.calls, KDL_VERSION_STRING, machine, Text(pairings));
  fmt::print("heap calls and locks of ours: {}\n",
             allocations ? std::to_string(*allocations) : "not counted here");
  nlohmann::json json = Json(pairings);
  json["robot"] = model.name;
  json["joints"] = model.joint_count();
  json["calls"] = options.calls;
  json["machine"] = machine;
  json["allocations"] = allocations ? nlohmann::json(*allocations) : nlohmann::json();
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench kinematics", written.error(), session::kFailed);
  return 0;
}

}  // namespace

int RunBenchKinematics(const BenchKinematicsOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("bench kinematics", error.what());
  } catch (const std::invalid_argument& error) {
    return session::Fail("bench kinematics", error.what());
  }
}

}  // namespace osteon::studies
