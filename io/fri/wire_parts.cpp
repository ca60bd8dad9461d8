#include "io/fri/wire_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace osteon::io {
namespace {

constexpr double kMmPerM = 1e3;
constexpr double kRotationTolerance = 1e-3;  // of an orthonormal matrix's products, of a quaternion's length
constexpr pb_size_t kMatrixSize = 12, kQuaternionSize = 7;

bool AllFinite(const double* first, std::size_t count) OSTEON_RT {
  return std::all_of(first, first + count, [](double x) { return std::isfinite(x); });
}

void PutName(const FriName& name, char (&wire)[FriName::kMaxLength + 1]) OSTEON_RT {
  std::memcpy(wire, name.c_str(), sizeof wire);
}

void PutTime(const std::optional<FriTime>& time, osteon_fri_Transformation& wire) OSTEON_RT {
  wire.has_timestamp = time.has_value();
  if (time) wire.timestamp = {time->sec, time->nanosec};
}

std::optional<FriTime> TimeOf(const osteon_fri_Transformation& wire) OSTEON_RT {
  if (!wire.has_timestamp) return std::nullopt;
  return FriTime{wire.timestamp.sec, wire.timestamp.nanosec};
}

bool IsRotation(const Matrix3& R) OSTEON_RT {
  return (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance &&
         R.determinant() > 0.0;
}

// False where the elements are no rotation.
bool FromMatrix(const double* element, PlainPose& X) OSTEON_RT {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> M(element);
  if (!IsRotation(M.leftCols<3>())) return false;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.data()) = M.leftCols<3>();
  X.p = Vector3(M.col(3) / kMmPerM);
  return true;
}

bool FromQuaternion(const double* element, PlainPose& X) OSTEON_RT {
  Eigen::Quaterniond q(element[3], element[4], element[5], element[6]);
  if (std::abs(q.norm() - 1.0) > kRotationTolerance) return false;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.data()) = q.normalized().toRotationMatrix();
  X.p = Vector3(Vector3(element[0], element[1], element[2]) / kMmPerM);
  return true;
}

}  // namespace

void WireCheck::Finite(double value) OSTEON_RT {
  if (!std::isfinite(value)) Fail(CodecError::kNotFinite);
}

void WireCheck::Joints(bool has, const osteon_fri_JointValues& wire,
                       std::optional<control::JointArray>& value) OSTEON_RT {
  if (!has) return;
  if (wire.value.count != kOsteonFriArraySize) return Fail(CodecError::kWrongCount);
  control::JointArray& joints = value.emplace();
  std::copy(std::begin(wire.value.value), std::end(wire.value.value), joints.begin());
  if (!AllFinite(joints.data(), joints.size())) Fail(CodecError::kNotFinite);
}

void WireCheck::Wrench(bool has, const osteon_fri_CartesianVector& wire,
                       std::optional<std::array<double, 6>>& value) OSTEON_RT {
  if (!has) return;
  std::array<double, 6>& wrench = value.emplace();
  if (wire.element_count != wrench.size()) return Fail(CodecError::kWrongCount);
  std::copy(std::begin(wire.element), std::end(wire.element), wrench.begin());
  if (!AllFinite(wrench.data(), wrench.size())) Fail(CodecError::kNotFinite);
}

void WireCheck::Pose(bool has, const osteon_fri_Transformation& wire, bool has_redundancy,
                     const osteon_fri_RedundancyInformation& redundancy,
                     std::optional<FriPose>& value) OSTEON_RT {
  if (!has) return;
  FriPose& pose = value.emplace();
  if (wire.element_count != kQuaternionSize) return Fail(CodecError::kWrongCount);
  std::copy_n(wire.element, kQuaternionSize, pose.element.begin());
  if (!AllFinite(pose.element.data(), pose.element.size())) return Fail(CodecError::kNotFinite);
  PlainPose X;
  if (!FromQuaternion(wire.element, X)) Fail(CodecError::kOutOfRange);
  pose.name = FriName(wire.name);
  pose.time = TimeOf(wire);
  if (!has_redundancy) return;
  Finite(redundancy.value);
  pose.redundancy = FriRedundancy{redundancy.strategy, redundancy.value};
}

void WireCheck::Transformation(FriFamily family, const osteon_fri_Transformation& wire,
                               FriTransformations& list) OSTEON_RT {
  FriTransformation transformation{.name = FriName(wire.name), .time = TimeOf(wire)};
  if (wire.element_count != 0) {
    const bool matrix = family == FriFamily::k1;
    if (wire.element_count != (matrix ? kMatrixSize : kQuaternionSize)) return Fail(CodecError::kWrongCount);
    if (!AllFinite(wire.element, wire.element_count)) return Fail(CodecError::kNotFinite);
    if (!(matrix ? FromMatrix : FromQuaternion)(wire.element, transformation.X))
      Fail(CodecError::kOutOfRange);
  }
  list.Add(transformation);
}

void WireCheck::Io(const osteon_fri_FriIOValue& wire, FriIos& list) OSTEON_RT {
  FriIo io{.name = FriName(wire.name)};
  Enum(true, wire.type, FriIoType::kAnalog, io.type);
  Enum(true, wire.direction, FriIoDirection::kOutput, io.direction);
  if (wire.has_digitalValue) io.digital = wire.digitalValue;
  if (wire.has_analogValue) {
    Finite(wire.analogValue);
    io.analog = wire.analogValue;
  }
  list.Add(io);
}

bool PutJoints(const std::optional<control::JointArray>& value, bool& has,
               osteon_fri_JointValues& wire) OSTEON_RT {
  has = value.has_value();
  if (!has) return true;
  wire.value.count = kOsteonFriArraySize;
  std::copy(value->begin(), value->end(), std::begin(wire.value.value));
  return AllFinite(value->data(), value->size());
}

bool PutWrench(const std::optional<std::array<double, 6>>& value, bool& has,
               osteon_fri_CartesianVector& wire) OSTEON_RT {
  has = value.has_value();
  if (!has) return true;
  wire.element_count = static_cast<pb_size_t>(value->size());
  std::copy(value->begin(), value->end(), std::begin(wire.element));
  return AllFinite(value->data(), value->size());
}

bool PutPose(const FriPose& value, osteon_fri_Transformation& wire) OSTEON_RT {
  PutName(value.name, wire.name);
  PutTime(value.time, wire);
  wire.element_count = kQuaternionSize;
  std::copy(value.element.begin(), value.element.end(), std::begin(wire.element));
  return AllFinite(value.element.data(), value.element.size()) &&
         (!value.redundancy || std::isfinite(value.redundancy->value));
}

bool PutTransformation(FriFamily family, const FriTransformation& value,
                       osteon_fri_Transformation& wire) OSTEON_RT {
  PutName(value.name, wire.name);
  PutTime(value.time, wire);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(value.X.R.data());
  const Vector3 p_mm = kMmPerM * Vector3(value.X.p);
  if (family == FriFamily::k1) {
    wire.element_count = kMatrixSize;
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(wire.element) << R, p_mm;
  } else {
    const Eigen::Quaterniond q{Matrix3(R)};
    wire.element_count = kQuaternionSize;
    const double element[kQuaternionSize]{p_mm.x(), p_mm.y(), p_mm.z(), q.w(), q.x(), q.y(), q.z()};
    std::copy(std::begin(element), std::end(element), std::begin(wire.element));
  }
  return AllFinite(wire.element, wire.element_count);
}

bool PutIo(const FriIo& value, osteon_fri_FriIOValue& wire) OSTEON_RT {
  PutName(value.name, wire.name);
  wire.type = static_cast<std::uint32_t>(value.type);
  wire.direction = static_cast<std::uint32_t>(value.direction);
  wire.has_digitalValue = value.digital.has_value();
  wire.digitalValue = value.digital.value_or(0);
  wire.has_analogValue = value.analog.has_value();
  wire.analogValue = value.analog.value_or(0.0);
  return std::isfinite(wire.analogValue);
}

}  // namespace osteon::io
