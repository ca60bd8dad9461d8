#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "config/reading/bone_config.h"
#include "config/reading/identified_cell.h"
#include "config/reading/tool_config.h"
#include "control/laws/gains.h"
#include "control/setup/servo_params.h"
#include "hil/can/simulated_devices.h"
#include "hil/injection/wire_faults.h"
#include "hil/operator/scripts.h"
#include "hil/plc/plc_server.h"
#include "hil/simulated_cell.h"
#include "io/devices/device_params.h"
#include "io/fri/fri_session.h"
#include "io/rsi/rsi_session.h"
#include "kinematics/chain_params.h"
#include "kinematics/lbr_params.h"
#include "kinematics/ortho_parallel_params.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine/cutting_engine.h"

// Content of the files under config/, in SI: the libraries' parameters, and values without a type in a
// library. Plain data; the accepted ranges are in the loaders (load.h).

namespace osteon::config {

/// Where the arm begins: the tool points into the cup along its axis.
struct StartConfig {
  double height_m{0.0};           ///< of the head's centre above the cup's, along the cup's axis
  double tool_yaw_rad{0.0};       ///< turns the tool about its axis: R_CT = Rx(pi) Rz(yaw)
  Pose X_WT{Pose::Identity()};    ///< follows from the two
  double arm_angle_rad{0.0};      ///< only for an LBR
  control::JointPathParams path;  ///< from another posture of the arm to the start
  double pause_force_N{40.0};     ///< a hand that pushes harder than this pauses the path
  /// The start as joints [rad]: the arm's solution nearest to zero, with six axes nearest to their usual
  /// posture, 0 -90 90 0 90 0 deg. The seventh joint of a six-axis arm is 0.
  kinematics::JointVector q{kinematics::JointVector::Zero()};
};

/// An arm of seven joints.
struct LbrConfig {
  kinematics::LbrParams params;
  /// The same joint by joint; the last link includes the load on the flange: force sensor and tool.
  kinematics::ChainParams<7> chain;
};

/// An arm of six axes; their masses are not published.
struct SixAxisConfig {
  kinematics::OrthoParallelParams params;
  kinematics::ChainParams<6> chain;  ///< the same joint by joint
};

struct RobotConfig {
  std::string name;
  std::variant<LbrConfig, SixAxisConfig> arm;

  /// Null if the arm is of the other kind.
  [[nodiscard]] const LbrConfig* lbr() const { return std::get_if<LbrConfig>(&arm); }
  [[nodiscard]] const SixAxisConfig* six_axis() const { return std::get_if<SixAxisConfig>(&arm); }
};

/// Where the arm's messages arrive, and their protocol; the simulated arm sends there. An LBR speaks FRI, an
/// arm of six axes RSI.
struct ArmLinkConfig {
  std::string host;  ///< dotted IPv4, of this machine
  /// Address of the arm, dotted IPv4: datagrams from others are ignored. Empty: the first sender is the arm.
  std::string arm_host{};
  std::uint16_t port{0};
  std::variant<io::FriSessionParams, io::RsiSessionParams> session;

  /// Null if the arm speaks the other protocol.
  [[nodiscard]] const io::FriSessionParams* fri() const {
    return std::get_if<io::FriSessionParams>(&session);
  }
  [[nodiscard]] const io::RsiSessionParams* rsi() const {
    return std::get_if<io::RsiSessionParams>(&session);
  }
};

/// The independent supervisor between arm and controller: the arm sends to it, and it relays to the link's
/// address.
struct GuardConfig {
  std::string host;  ///< dotted IPv4, of this machine, where the arm's messages arrive
  std::uint16_t port{0};
  double margin{0.25};     ///< excess over the controller's own limits that is allowed, as a share of them
  double silence_s{0.05};  ///< largest silence of the controller
};

/// The process that runs the cutting engine.
struct EngineProcessConfig {
  std::string host{};     ///< dotted IPv4, where `osteon simulate` listens; empty: the run starts it
  std::uint16_t port{0};  ///< UDP; 0 with an empty host
  /// A file with the token of an engine beyond the loopback; relative to the cell's folder. Empty: none.
  std::filesystem::path token_file{};
};

/// Whether a part of the cell is simulated as compliant.
enum class GivesWay : std::uint8_t {
  kOff,
  kOn,
  kAuto,  ///< where the scene can notice it (simulation/fidelity/compliance_level.h)
};

/// The parts of the cell that may give way, as its file states them.
struct ComplianceConfig {
  GivesWay layer{GivesWay::kOff}, tool{GivesWay::kOff}, mount{GivesWay::kOff};
  double error_m{0.1e-3};  ///< accepted error E of the scene (fidelity), or the file's own
  std::optional<control::BoneMountParams> bone_mount{};
  std::string mount_source{};          ///< source of the mount's figures, or "assumed"
  double lateral_N{0.0}, push_N{0.0};  ///< force on the tool, and force on tissue and mount
};

/// A cell, with the contents of the files that it names.
struct CellConfig {
  RobotConfig robot;
  ToolConfig tool;
  std::filesystem::path tool_file;  ///< the file that `tool` was read from
  simulation::SceneParams scene;    ///< with the materials that it needs
  std::optional<BoneConfig> bone;   ///< absent: the scene's own solid
  Pose X_WB{Pose::Identity()};      ///< robot base in world
  Pose X_WG{Pose::Identity()};      ///< bone in world: the frame C of its site
  StartConfig start;
  control::ServoParams servo;         ///< with the robot's limits and the tool's spindle speed
  ComplianceConfig compliance;        ///< what gives way, and why; its parameters are servo.compliance
  control::Gains own_gains;           ///< from the cell's file, before a gains file overrides them
  simulation::CuttingParams cutting;  ///< with the coupling's stiffness and the cell's force limit
  ArmLinkConfig link;
  std::optional<GuardConfig> guard;  ///< absent: the arm sends to the link's address itself
  /// Pauses the cell if the console page with the operator's role vanishes.
  bool pause_when_operator_leaves{false};
  std::optional<EngineProcessConfig> engine_process;  ///< absent: the engine is a thread of the run
  io::DeviceParams devices;                           ///< force sensor, reamer drive, PLC: their addresses
  /// Whether the file has `operator`, `script` and `simulated_arm`. A cell for a real arm alone needs none of
  /// them; commands that simulate a cell then refuse it (RequireSimulation).
  bool has_simulation{true};
  hil::SimulatedCellParams simulated;  ///< arm, operator and force sensor that replace the real ones
  hil::SimulatedDeviceParams simulated_devices;  ///< simulation of the same devices
  std::optional<hil::PlcServerParams> simulated_plc;
  hil::InjectionParams injections;  ///< faults on the simulated cell's wires
  hil::ScriptParams script;         ///< the operator's script
  /// The measured figures of this cell (apply_identified.h); absent: the simulated arm's are assumed.
  std::optional<IdentifiedCell> identified{};
};

}  // namespace osteon::config
