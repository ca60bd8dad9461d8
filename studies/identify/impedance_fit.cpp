#include "studies/identify/impedance_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "studies/identify/response_fit.h"

namespace osteon::studies {
namespace {

using Joints = kinematics::JointVectorN<7>;

constexpr double kHalfWidthSd = 2.0;  // half width of a 95 % interval, in standard deviations
constexpr double kTurn = 2.0 * std::numbers::pi, kMaxDeadTime_s = 0.03;
constexpr double kMaxRigidChi2 = 3.0;     // chi² above which an arm on a mount is tried as well
constexpr double kFalls = 3.0;            // factor by which a mount must lower the cost to be kept
constexpr double kStartFriction = 0.003;  // friction ratio at which a fit starts
constexpr std::size_t kMinLines = 6;
constexpr int kMaxAgain = 5;  // maximum number of restarts of the solver
// A restart has made progress if the cost falls below this share of the previous cost.
constexpr double kWentOn = 0.95;
// Standard deviation of a mount's parameters, as a factor on their start values.
constexpr double kMountFactor = 3.0;
constexpr double kFarOff = 1e6;  // residual if the model has no finite value

// The fitted parameters by index. The rotational spring exists only with Cartesian impedance, the last five
// only with a mount.
enum Parameter : Eigen::Index {
  kLogMassRatio,
  kLogSpring,  // Cartesian: N/m; joints: N m/rad
  kLogDampingRatio,
  kDeadTime_s,
  kFrictionRatio,
  kLogTurnSpring,
  kRigid,
  kLogMountSpring = kRigid,
  kLogMountTurnSpring,
  kLogMountDampingRatio,
  kLogMountMass,
  kLogMountInertia,
  kMounted
};

// Damping of each joint [N m s/rad] by a Coulomb friction equal to its torque limit. It is the mean slope of
// the friction over the joint's speeds, which are taken as normally distributed.
Joints FrictionDamping(const OverlaidArm& arm) {
  constexpr int kSteps = 400;     // steps of the numerical integral
  constexpr double kReach = 6.0;  // range of the integral, in standard deviations
  const double smoothing_rad_per_s = kinematics::JointFriction{}.smoothing_rad_per_s;
  Joints damping = Joints::Zero();
  for (Eigen::Index j = 0; j < 7; ++j) {
    const double torque_Nm = arm.arm.chain.joints[static_cast<std::size_t>(j)].limits.torque_Nm;
    double slope = 0.0, weights = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const double x = kReach * (2.0 * i / kSteps - 1.0), weight = std::exp(-0.5 * x * x),
                   ch = std::cosh(
                       std::min(300.0, std::abs(x) * arm.joint_rms_rad_per_s[j] / smoothing_rad_per_s));
      slope += weight / (ch * ch);
      weights += weight;
    }
    damping[j] = torque_Nm / smoothing_rad_per_s * slope / weights;
  }
  return damping;
}

// The arm with the fitted parameters, and the damping that friction adds.
class FittedArm {
 public:
  explicit FittedArm(const OverlaidArm& overlaid)
      : overlaid_(overlaid), friction_(FrictionDamping(overlaid)) {}

  // true: joint impedance; false: Cartesian impedance
  [[nodiscard]] bool torque() const { return overlaid_.arm.torque; }
  // The arm on a rigid base, with these parameters.
  [[nodiscard]] ImpedanceArm At(const Eigen::VectorXd& p, bool with_friction) const {
    ImpedanceArmParams params = overlaid_.arm;
    if (torque()) {
      params.arm.stiffness_Nm_per_rad.setConstant(std::exp(p[kLogSpring]));
      params.arm.joint_damping_ratio = std::exp(p[kLogDampingRatio]);
    } else {
      params.arm.stiffness_N_per_m = std::exp(p[kLogSpring]);
      params.arm.stiffness_Nm_per_rad_turn = std::exp(p[kLogTurnSpring]);
      params.arm.cartesian_damping_ratio = std::exp(p[kLogDampingRatio]);
    }
    ImpedanceArm arm = ImpedanceArmAt(params, std::exp(p[kLogMassRatio]));
    if (with_friction) arm.damping.diagonal() += p[kFrictionRatio] * friction_;
    return arm;
  }
  // The response x / f [m/N]; with the mount if p has the mount's parameters.
  [[nodiscard]] OverlayResponse ResponseOf(const Eigen::VectorXd& p, double period_s) const {
    const ImpedanceArm arm = At(p, true);
    const double dead_s = std::clamp(p[kDeadTime_s], 0.0, kMaxDeadTime_s);
    if (p.size() == kRigid) return {arm, Along(arm), dead_s, period_s};
    const hil::FlexibleMountParams mount{.stiffness_N_per_m = std::exp(p[kLogMountSpring]),
                                         .stiffness_Nm_per_rad = std::exp(p[kLogMountTurnSpring]),
                                         .damping_ratio = std::exp(p[kLogMountDampingRatio]),
                                         .mass_kg = std::exp(p[kLogMountMass]),
                                         .inertia_kg_m2 = std::exp(p[kLogMountInertia])};
    const double mass_ratio = std::exp(p[kLogMassRatio]);
    return {OnMount(arm, overlaid_.arm, mount, mass_ratio), Along(arm), dead_s, period_s};
  }
  // Motion along the axis per joint motion [m/rad]: the Jacobian's row along the axis.
  [[nodiscard]] Joints Along(const ImpedanceArm& arm) const {
    return arm.J.topRows<3>().transpose() * overlaid_.axis_B;
  }
  [[nodiscard]] double nominal_N_per_m() const { return overlaid_.nominal_N_per_m; }

 private:
  const OverlaidArm& overlaid_;
  Joints friction_;
};

// The model for the solver: the sampled arm is computed once for all lines.
class ArmModel {
 public:
  ArmModel(const FittedArm& arm, double period_s) : arm_(arm), period_s_(period_s) {}
  std::complex<double> operator()(const Eigen::VectorXd& p, double hz) {
    if (!response_ || of_.size() != p.size() || of_ != p) {
      response_.emplace(arm_.ResponseOf(p, period_s_));
      of_ = p;
    }
    return arm_.nominal_N_per_m() * (*response_)(hz);
  }

 private:
  const FittedArm& arm_;
  double period_s_;
  Eigen::VectorXd of_;  // the parameters with which `response_` was computed
  std::optional<OverlayResponse> response_;
};

// Projects the joints' inertia, damping or stiffness on an axis. The result acts against a force along the
// axis while all other directions are free.
double Along(const Eigen::Matrix<double, 7, 7>& joint_matrix, const Joints& along) {
  return 1.0 / along.dot(joint_matrix.partialPivLu().solve(along));
}

// Indices of the reported values, which are computed from the parameters.
enum Reported : Eigen::Index {
  kMassRatio,
  kSpring,
  kTurnSpring,
  kDampingRatio,
  kDeadTime,
  kFriction,
  kAlongMass,
  kAlongDamping,
  kAlongSpring,
  kAlongHz,
  kAlongRatio,
  kLag,
  kReported
};

// Computes the reported values. Those along the axis leave out friction.
Eigen::VectorXd ReportedValues(const FittedArm& fitted, const Eigen::VectorXd& p) {
  const ImpedanceArm arm = fitted.At(p, false);
  const Joints along = fitted.Along(arm);
  const double mass_kg = Along(arm.inertia, along), damping = Along(arm.damping, along),
               spring = Along(arm.stiffness, along), dead_s = p[kDeadTime_s];
  Eigen::VectorXd r = Eigen::VectorXd::Zero(kReported);
  r[kMassRatio] = std::exp(p[kLogMassRatio]);
  r[kSpring] = std::exp(p[kLogSpring]);
  r[kTurnSpring] = fitted.torque() ? 0.0 : std::exp(p[kLogTurnSpring]);
  r[kDampingRatio] = std::exp(p[kLogDampingRatio]);
  r[kDeadTime] = dead_s;
  r[kFriction] = p[kFrictionRatio];
  r[kAlongMass] = mass_kg;
  r[kAlongDamping] = damping;
  r[kAlongSpring] = spring;
  r[kAlongHz] = std::sqrt(spring / mass_kg) / kTurn;
  r[kAlongRatio] = damping / (2.0 * std::sqrt(spring * mass_kg));
  r[kLag] = dead_s + damping / spring;
  return r;
}

// Half widths of the reported values, from the parameters' covariance and the values' numerical gradient.
Eigen::VectorXd HalfWidths(const FittedArm& fitted, const Eigen::VectorXd& p,
                           const Eigen::MatrixXd& covariance) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd gradient(static_cast<Eigen::Index>(kReported), p.size());
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    Eigen::VectorXd below = p, above = p;
    below[i] -= kStep;
    above[i] += kStep;
    gradient.col(i) = (ReportedValues(fitted, above) - ReportedValues(fitted, below)) / (2.0 * kStep);
  }
  return kHalfWidthSd * (gradient * covariance * gradient.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
}

// Fits some of the parameters; all others keep their start values. The lines alone do not determine all
// parameters of a mount. So a mount's parameters are kept near their start values, within a factor of about
// kMountFactor.
LeastSquaresFit FitSome(std::span<const ResponseLine> lines, const ResponseModel& model,
                        const Eigen::VectorXd& start, const std::vector<Eigen::Index>& fixed) {
  std::vector<Eigen::Index> fitted;
  for (Eigen::Index i = 0; i < start.size(); ++i)
    if (std::ranges::find(fixed, i) == fixed.end()) fitted.push_back(i);
  const auto line_rows = 2 * static_cast<Eigen::Index>(lines.size());
  Eigen::VectorXd parameters = start;
  const auto residuals = [&](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    parameters(fitted) = p;
    FillResiduals(lines, model, parameters, r);
    for (Eigen::Index i = kRigid; i < start.size(); ++i)
      r[line_rows + i - kRigid] = (parameters[i] - start[i]) / std::log(kMountFactor);
    if (!r.allFinite()) r.setConstant(kFarOff);  // the step was too long: the solver then takes a shorter one
  };
  const LeastSquares problem{.parameters = static_cast<int>(fitted.size()),
                             .residuals = static_cast<int>(line_rows + start.size() - kRigid),
                             .evaluate = residuals};
  LeastSquaresFit fit = Solve(problem, start(fitted));
  // The solver may stop early in a narrow valley. Restart it from there until it makes no more progress.
  for (int again = 0; again < kMaxAgain && fit.converged; ++again) {
    const LeastSquaresFit next = Solve(problem, fit.parameters);
    const bool went_on = next.converged && next.cost < kWentOn * fit.cost;
    if (next.converged && next.cost < fit.cost) fit = next;
    if (!went_on) break;
  }
  if (!fit.converged) return fit;
  parameters(fitted) = fit.parameters;
  fit.parameters = parameters;
  const Eigen::MatrixXd covariance = fit.covariance;
  fit.covariance = Eigen::MatrixXd::Zero(parameters.size(), parameters.size());
  fit.covariance(fitted, fitted) = covariance;
  return fit;
}

// Replaces `best` if the fit's cost is lower by more than the factor `by`.
void KeepBetter(const LeastSquaresFit& fit, LeastSquaresFit& best, double by = 1.0) {
  if (fit.converged && (!best.converged || by * fit.cost < best.cost)) best = fit;
}

// Start values of an arm on a rigid base: the parameters of the arm's file, with its spring multiplied by
// `spring`.
Eigen::VectorXd RigidStart(const OverlaidArm& overlaid, double spring, double dead_time_s) {
  const hil::DynamicArmParams& arm = overlaid.arm.arm;
  const bool torque = overlaid.arm.torque;
  Eigen::VectorXd start(static_cast<Eigen::Index>(kRigid));
  start[kLogMassRatio] = 0.0;
  start[kLogSpring] =
      std::log(spring * std::max(1.0, torque ? arm.stiffness_Nm_per_rad.mean() : arm.stiffness_N_per_m));
  start[kLogDampingRatio] =
      std::log(std::max(0.1, torque ? arm.joint_damping_ratio : arm.cartesian_damping_ratio));
  start[kDeadTime_s] = dead_time_s;
  start[kFrictionRatio] = overlaid.has_friction ? kStartFriction : 0.0;
  start[kLogTurnSpring] = std::log(std::max(1.0, arm.stiffness_Nm_per_rad_turn));
  return start;
}

// Start values of an arm on a mount: the mount of the arm's file, or an assumed one, with its springs
// multiplied by `spring`.
Eigen::VectorXd MountedStart(const OverlaidArm& overlaid, const Eigen::VectorXd& rigid, double spring) {
  const hil::FlexibleMountParams assumed = overlaid.arm.arm.mount.value_or(hil::FlexibleMountParams{});
  Eigen::VectorXd start(static_cast<Eigen::Index>(kMounted));
  start << rigid.head(kRigid), std::log(spring * assumed.stiffness_N_per_m),
      std::log(spring * assumed.stiffness_Nm_per_rad), std::log(std::max(0.01, assumed.damping_ratio)),
      std::log(assumed.mass_kg), std::log(assumed.inertia_kg_m2);
  return start;
}

// Fits the arm on a rigid base, starting from the springs of the arm's file, half of them and twice of them.
// If chi² is above kMaxRigidChi2, also fits the arm on a mount, which is kept if it lowers the cost
// threefold.
LeastSquaresFit BestFit(std::span<const ResponseLine> lines, const OverlaidArm& overlaid,
                        const ResponseModel& model, double dead_time_s) {
  std::vector<Eigen::Index> fixed;
  if (overlaid.arm.torque) fixed.push_back(kLogTurnSpring);  // joint impedance has no rotational spring
  if (!overlaid.has_friction) fixed.push_back(kFrictionRatio);
  const Eigen::VectorXd as_filed = RigidStart(overlaid, 1.0, dead_time_s);
  LeastSquaresFit best, mounted;
  for (const double spring : {1.0, 0.5, 2.0})
    KeepBetter(FitSome(lines, model, RigidStart(overlaid, spring, dead_time_s), fixed), best);
  if (best.converged && Chi2Of(best, lines.size()) <= kMaxRigidChi2) return best;
  for (const double spring : {1.0, 0.5, 0.25, 2.0})
    KeepBetter(FitSome(lines, model, MountedStart(overlaid, as_filed, spring), fixed), mounted);
  KeepBetter(mounted, best, kFalls);
  return best;
}

}  // namespace

tl::expected<ImpedanceFit, std::string> FitImpedance(std::span<const ResponseLine> lines,
                                                     const OverlaidArm& overlaid, double period_s,
                                                     double start_dead_time_s) {
  if (lines.size() < kMinLines)
    return tl::unexpected(fmt::format("found {} lines, accepted {} or more", lines.size(), kMinLines));
  const FittedArm arm(overlaid);
  ArmModel model(arm, period_s);
  const LeastSquaresFit fit = BestFit(lines, overlaid, std::ref(model), start_dead_time_s);
  if (!fit.converged) return tl::unexpected(std::string("no arm fits the motion: no start converged"));
  const double chi2 = Chi2Of(fit, lines.size());
  const Eigen::VectorXd& p = fit.parameters;
  const Eigen::VectorXd found = ReportedValues(arm, p),
                        width = HalfWidths(arm, p, std::max(1.0, chi2) * fit.covariance);
  const auto estimate = [&](Reported what) { return Estimate{found[what], width[what]}; };
  double squares = 0.0;
  for (const ResponseLine& line : lines) squares += std::norm((line.value - model(p, line.hz)) / line.value);
  ImpedanceFit result{.stiffness_N_per_m = estimate(kAlongSpring),
                      .damping_Ns_per_m = estimate(kAlongDamping),
                      .mass_kg = estimate(kAlongMass),
                      .dead_time_s = estimate(kDeadTime),
                      .bandwidth_hz = estimate(kAlongHz),
                      .damping_ratio = estimate(kAlongRatio),
                      .lag_s = estimate(kLag),
                      .own_damping_ratio = estimate(kDampingRatio),
                      .mass_ratio = estimate(kMassRatio),
                      .friction_ratio = estimate(kFriction),
                      .on_mount = p.size() == kMounted,
                      .chi2 = chi2,
                      .residual = std::sqrt(squares / static_cast<double>(lines.size())),
                      .parameters = p};
  if (overlaid.arm.torque) {
    result.joint_Nm_per_rad = estimate(kSpring);
  } else {
    result.translation_N_per_m = estimate(kSpring);
    result.rotation_Nm_per_rad = estimate(kTurnSpring);
  }
  return result;
}

OverlayResponse FittedResponse(const ImpedanceFit& fit, const OverlaidArm& overlaid, double period_s) {
  return FittedArm(overlaid).ResponseOf(fit.parameters, period_s);
}

double ValidationChi2(const ImpedanceFit& fit, const OverlaidArm& overlaid,
                      std::span<const ResponseLine> lines, double period_s) {
  const OverlayResponse response = FittedResponse(fit, overlaid, period_s);
  double sum = 0.0;
  for (const ResponseLine& line : lines)
    sum += std::norm((line.value - overlaid.nominal_N_per_m * response(line.hz)) / line.sd);
  return sum / (2.0 * static_cast<double>(lines.size()));
}

MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m) {
  for (ResponseLine& line : response.lines) {
    line.value /= nominal_N_per_m;
    line.noise_sd /= nominal_N_per_m;
    line.sd /= nominal_N_per_m;
  }
  return response;
}

}  // namespace osteon::studies
