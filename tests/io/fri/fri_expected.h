#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/fri/codec.h"
#include "tests/io/fri/fri_wide_oracle.h"

// The result that the codec must have for a monitoring message: the values as libprotobuf reads them, and the
// codec's rules (codec.h) in a second implementation.

namespace osteon::io::test {

/// The result that the codec must have for a message: either the first rule that is broken, or these values.
class Expected {
 public:
  /// @param inside  the message without the frame of 2.7
  /// @param oracle  parses the message with libprotobuf; refuses malformed messages
  Expected(FriFamily family, std::span<const std::uint8_t> inside, const WideOracle& oracle)
      : family_(family), message_(oracle.Parse(inside)) {
    error_ = message_ == nullptr ? CodecError::kMalformed : FirstBrokenRule(WirePart(message_.get()));
  }

  [[nodiscard]] CodecError error() const { return error_; }
  /// The message as libprotobuf encodes it again.
  [[nodiscard]] std::vector<std::uint8_t> Rewritten() const {
    const std::string text = message_->SerializePartialAsString();
    return {text.begin(), text.end()};
  }
  [[nodiscard]] WirePart message() const { return WirePart(message_.get()); }

  /// Compares the codec's message with libprotobuf's. All values must agree to the last bit. Poses are the
  /// exception, because their lengths are scaled. @returns the fields that differ; empty if there are none
  [[nodiscard]] std::string Difference(const MonitoringMessage& m) const {
    const WirePart w = message(), header = w.Part("header"), connection = w.Part("connectionInfo"),
                   robot = w.Part("robotInfo"), monitor = w.Part("monitorData"), ipo = w.Part("ipoData");
    std::string wrong;
    const auto same = [&](const char* what, auto ours, auto theirs) {
      if (!(ours == static_cast<decltype(ours)>(theirs))) wrong += std::string(what) + " ";
    };
    const auto number = [](const WirePart& part, const char* name, std::uint64_t otherwise) {
      return part.Has(name) ? part.Int(name) : otherwise;
    };
    same("sequence", m.sequence, header.Int("sequenceCounter"));
    same("reflected", m.reflected_sequence, header.Int("reflectedSequenceCounter"));
    same("session", m.session, connection.Int("sessionState"));
    same("quality", m.quality, connection.Int("quality"));
    same("period", m.send_period_ms, number(connection, "sendPeriod", 1));
    same("multiplier", m.receive_multiplier, number(connection, "receiveMultiplier", 1));
    same("safety", m.safety, number(robot, "safetyState", 0));
    same("operation", m.operation, number(robot, "operationMode", 0));
    same("control", m.control, number(robot, "controlMode", 0));
    const auto drives = robot.Ints("driveState");
    for (std::size_t i = 0; i < m.drives.size(); ++i)
      same("drive", m.drives[i], drives.empty() ? 0 : drives[i]);
    same("q_meas", ToVector(m.q_meas), ValuesOf(monitor, "measuredJointPosition", "value"));
    same("tau_meas", ToVector(m.tau_meas), ValuesOf(monitor, "measuredTorque", "value"));
    same("q_cmd", ToVector(m.q_cmd), ValuesOf(monitor, "commandedJointPosition", "value"));
    same("tau_cmd", ToVector(m.tau_cmd), ValuesOf(monitor, "commandedTorque", "value"));
    same("tau_ext", ToVector(m.tau_ext), ValuesOf(monitor, "externalTorque", "value"));
    same("q_ipo", ToVector(m.q_ipo), ValuesOf(ipo, "jointPosition", "value"));
    if (family_ == FriFamily::k2_7)
      same("force", ToVector(m.wire_force), ValuesOf(monitor, "externalForce", "element"));
    same("time", m.time, Time(monitor));
    same("X_meas", PoseText(m.X_meas),
         PoseText(monitor, "measuredCartesianPose", "measuredRedundancyInformation"));
    same("X_ipo", PoseText(m.X_ipo), PoseText(ipo, "cartesianPose", "redundancyInformation"));
    same("mode", m.command_mode, number(ipo, "clientCommandMode", 0));
    same("overlay", m.overlay, number(ipo, "overlayType", 0));
    same("tracking", m.tracking_performance,
         ipo.Has("trackingPerformance") ? ipo.Real("trackingPerformance") : 0.0);
    const auto ios = monitor.Parts("readIORequest");
    same("ios", m.ios.size(), ios.size());
    for (std::size_t i = 0; i < std::min(m.ios.size(), ios.size()); ++i) {
      same("name", std::string(m.ios[i].name.view()), UpToNul(ios[i].Text("name")));
      same("type", m.ios[i].type, ios[i].Int("type"));
      same("direction", m.ios[i].direction, ios[i].Int("direction"));
      same("digital", m.ios[i].digital.value_or(0), number(ios[i], "digitalValue", 0));
      same("has digital", m.ios[i].digital.has_value(), ios[i].Has("digitalValue"));
      same("analog", m.ios[i].analog,
           ios[i].Has("analogValue") ? std::optional(ios[i].Real("analogValue")) : std::nullopt);
    }
    const auto frames = w.Parts("requestedTransformations");
    same("frames", m.transformations.size(), frames.size());
    for (std::size_t i = 0; i < std::min(m.transformations.size(), frames.size()); ++i) {
      const FriTransformation& frame = m.transformations[i];
      same("name", std::string(frame.name.view()), UpToNul(frames[i].Text("name")));
      same("time", frame.time, Time(frames[i]));
      auto element = frames[i].Reals("element");
      const Pose X = frame.X;
      if (element.empty()) same("identity", X.isApprox(Pose::Identity(), 0.0), true);
      if (element.size() ==
          7)  // in a quaternion's pose the lengths come first; in a matrix they are the last column
        same("position", X.translation().isApprox(Vector3(element[0], element[1], element[2]) * 1e-3, 1e-14),
             true);
      if (element.size() == 12)
        same("position", X.translation().isApprox(Vector3(element[3], element[7], element[11]) * 1e-3, 1e-14),
             true);
    }
    return wrong;
  }

 private:
  using Values = std::optional<std::vector<double>>;

  template <std::size_t N>
  static Values ToVector(const std::optional<std::array<double, N>>& values) {
    return values ? Values(std::vector<double>(values->begin(), values->end())) : std::nullopt;
  }
  // The numbers in the field `name` of a message; nullopt if the message does not have this field.
  static Values ValuesOf(const WirePart& part, const char* name, const char* values) {
    return part.Has(name) ? Values(part.Part(name).Reals(values)) : std::nullopt;
  }
  static std::optional<FriTime> Time(const WirePart& part) {
    if (!part.Has("timestamp")) return std::nullopt;
    const WirePart time = part.Part("timestamp");
    return FriTime{static_cast<std::uint32_t>(time.Int("sec")),
                   static_cast<std::uint32_t>(time.Int("nanosec"))};
  }
  // The text up to its first zero byte, as the codec reads a name.
  static std::string UpToNul(const std::string& text) { return text.c_str(); }
  // All parts of a pose, bit for bit, as text that can be compared.
  static std::string PoseText(const std::string& name, const std::vector<double>& element,
                              const std::optional<FriTime>& time,
                              const std::optional<FriRedundancy>& redundancy) {
    std::string text = name + "|";
    const auto put = [&](const auto& value) {
      text.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const double x : element) put(x);
    if (time) put(time->sec), put(time->nanosec);
    text += "|";
    if (redundancy) put(redundancy->strategy), put(redundancy->value);
    return text;
  }
  static std::string PoseText(const std::optional<FriPose>& pose) {
    if (!pose) return {};
    return PoseText(std::string(pose->name.view()), {pose->element.begin(), pose->element.end()}, pose->time,
                    pose->redundancy);
  }
  static std::string PoseText(const WirePart& part, const char* name, const char* redundancy) {
    if (!part.Has(name)) return {};
    const WirePart pose = part.Part(name), elbow = part.Part(redundancy);
    return PoseText(UpToNul(pose.Text("name")), pose.Reals("element"), Time(pose),
                    elbow.exists()
                        ? std::optional(FriRedundancy{static_cast<std::uint32_t>(elbow.Int("strategy")),
                                                      elbow.Real("value")})
                        : std::nullopt);
  }

  // The codec's rules. Require() keeps the reason of the first rule that is broken.

  void Require(bool holds, CodecError reason) {
    if (!holds && first_broken_ == CodecError::kNone) first_broken_ = reason;
  }
  static bool AllFinite(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  }
  void RequireEnum(const WirePart& part, const char* name, std::uint64_t largest) {
    if (part.Has(name)) Require(part.Int(name) <= largest, CodecError::kOutOfRange);
  }
  void RequireVector(const WirePart& part, const char* name, const char* values, std::size_t size) {
    if (!part.Has(name)) return;
    const auto listed = part.Part(name).Reals(values);
    Require(listed.size() == size, CodecError::kWrongCount);
    Require(listed.size() != size || AllFinite(listed), CodecError::kNotFinite);
  }
  // A pose has 7 elements (position and unit quaternion) or 12 elements (the rows of [R | p]).
  void RequirePoseElements(const std::vector<double>& element, std::size_t size) {
    Require(element.size() == size, CodecError::kWrongCount);
    if (element.size() != size) return;
    Require(AllFinite(element), CodecError::kNotFinite);
    if (!AllFinite(element)) return;
    if (size == 7) {
      const double norm = std::hypot(std::hypot(element[3], element[4]), std::hypot(element[5], element[6]));
      return Require(std::abs(norm - 1.0) <= 1e-3, CodecError::kOutOfRange);
    }
    const auto row = [&](std::size_t i) {
      return Vector3(element[4 * i], element[4 * i + 1], element[4 * i + 2]);
    };
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        Require(std::abs(row(i).dot(row(j)) - (i == j ? 1.0 : 0.0)) < 1e-3, CodecError::kOutOfRange);
    Require(row(0).cross(row(1)).dot(row(2)) > 0.0, CodecError::kOutOfRange);
  }
  void RequirePoseOf2x(const WirePart& part, const char* name, const char* redundancy) {
    if (!part.Has(name)) return;
    RequirePoseElements(part.Part(name).Reals("element"), 7);
    if (part.Has(redundancy) && part.Part(name).Reals("element").size() == 7 &&
        AllFinite(part.Part(name).Reals("element")))
      Require(std::isfinite(part.Part(redundancy).Real("value")), CodecError::kNotFinite);
  }

  CodecError FirstBrokenRule(const WirePart& w) {
    if (w.Part("header").Int("messageIdentifier") != kFriMonitoringId) return CodecError::kWrongId;
    const WirePart connection = w.Part("connectionInfo"), robot = w.Part("robotInfo"),
                   monitor = w.Part("monitorData"), ipo = w.Part("ipoData");
    const bool has_fields_of_2x = monitor.Has("measuredCartesianPose") ||
                                  monitor.Has("measuredRedundancyInformation") || ipo.Has("cartesianPose") ||
                                  ipo.Has("redundancyInformation");
    const bool is_1x = family_ == FriFamily::k1;
    if (is_1x ? has_fields_of_2x : !has_fields_of_2x && monitor.Has("commandedJointPosition"))
      return CodecError::kOtherVersion;
    if (!connection.exists()) return CodecError::kMissingField;

    RequireEnum(connection, "sessionState", 4);
    RequireEnum(connection, "quality", 3);
    for (const char* name : {"sendPeriod", "receiveMultiplier"})
      if (connection.Has(name))
        Require(connection.Int(name) >= 1 && connection.Int(name) <= 100, CodecError::kOutOfRange);
    if (robot.Has("numberOfJoints")) Require(robot.Int32("numberOfJoints") == 7, CodecError::kWrongCount);
    RequireEnum(robot, "safetyState", 3);
    RequireEnum(robot, "operationMode", 2);
    RequireEnum(robot, "controlMode", 3);
    const auto drives = robot.Ints("driveState");
    Require(drives.empty() || drives.size() == 7, CodecError::kWrongCount);
    for (const std::uint64_t drive : drives) Require(drive <= 2, CodecError::kOutOfRange);

    for (const char* name : {"measuredJointPosition", "measuredTorque", "commandedJointPosition",
                             "commandedTorque", "externalTorque"})
      RequireVector(monitor, name, "value", 7);
    if (family_ == FriFamily::k2_7) RequireVector(monitor, "externalForce", "element", 6);
    RequirePoseOf2x(monitor, "measuredCartesianPose", "measuredRedundancyInformation");
    for (const WirePart& io : monitor.Parts("readIORequest")) {
      RequireEnum(io, "type", 2);
      RequireEnum(io, "direction", 1);
      if (io.Has("analogValue")) Require(std::isfinite(io.Real("analogValue")), CodecError::kNotFinite);
    }

    RequireVector(ipo, "jointPosition", "value", 7);
    RequirePoseOf2x(ipo, "cartesianPose", "redundancyInformation");
    RequireEnum(ipo, "clientCommandMode", is_1x ? 3 : 4);
    RequireEnum(ipo, "overlayType", 2);
    if (ipo.Has("trackingPerformance"))
      Require(std::isfinite(ipo.Real("trackingPerformance")), CodecError::kNotFinite);
    for (const WirePart& frame : w.Parts("requestedTransformations"))
      if (!frame.Reals("element").empty()) RequirePoseElements(frame.Reals("element"), is_1x ? 12 : 7);

    const std::uint64_t session = connection.Int("sessionState");
    Require(session == 0 || monitor.Has("measuredJointPosition"), CodecError::kMissingField);
    Require(session < 3 || ipo.Has("jointPosition"), CodecError::kMissingField);
    return first_broken_;
  }

  FriFamily family_;
  std::unique_ptr<google::protobuf::Message> message_;
  CodecError first_broken_{CodecError::kNone}, error_{CodecError::kNone};
};

}  // namespace osteon::io::test
