#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fri.pb.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>

// Reads a monitoring message by libprotobuf without loss. The schema is fri.proto with 64-bit fields in place
// of enums and 32-bit fields, and bytes in place of strings. In a second schema each number and string is a
// repeated field. That schema also keeps the values that a later occurrence of the same field would replace.

namespace osteon::io::test {

/// A message or an embedded message, as libprotobuf stores it. A null pointer stands for an absent message,
/// which has no fields.
class WirePart {
 public:
  explicit WirePart(const google::protobuf::Message* message) : message_(message) {}

  [[nodiscard]] bool exists() const { return message_ != nullptr; }
  // Fields are read by their names in fri.proto. An absent field gives an absent message, 0 or nothing. Int,
  // Int32, Real and Text need a message that exists.
  [[nodiscard]] bool Has(const char* name) const {
    return exists() && reflection().HasField(*message_, Field(name));
  }
  [[nodiscard]] WirePart Part(const char* name) const {
    return WirePart(Has(name) ? &reflection().GetMessage(*message_, Field(name)) : nullptr);
  }
  [[nodiscard]] std::vector<WirePart> Parts(const char* name) const {
    std::vector<WirePart> parts;
    for (int i = 0; i < Count(name); ++i)
      parts.emplace_back(&reflection().GetRepeatedMessage(*message_, Field(name), i));
    return parts;
  }
  [[nodiscard]] std::uint64_t Int(const char* name) const {
    return reflection().GetUInt64(*message_, Field(name));
  }
  [[nodiscard]] std::int32_t Int32(const char* name) const {
    return reflection().GetInt32(*message_, Field(name));
  }
  [[nodiscard]] double Real(const char* name) const { return reflection().GetDouble(*message_, Field(name)); }
  [[nodiscard]] std::string Text(const char* name) const {
    return reflection().GetString(*message_, Field(name));
  }
  [[nodiscard]] std::vector<std::uint64_t> Ints(const char* name) const {
    std::vector<std::uint64_t> values;
    for (int i = 0; i < Count(name); ++i)
      values.push_back(reflection().GetRepeatedUInt64(*message_, Field(name), i));
    return values;
  }
  [[nodiscard]] std::vector<double> Reals(const char* name) const {
    std::vector<double> values;
    for (int i = 0; i < Count(name); ++i)
      values.push_back(reflection().GetRepeatedDouble(*message_, Field(name), i));
    return values;
  }

 private:
  [[nodiscard]] const google::protobuf::Reflection& reflection() const { return *message_->GetReflection(); }
  [[nodiscard]] const google::protobuf::FieldDescriptor* Field(const char* name) const {
    return message_->GetDescriptor()->FindFieldByName(name);
  }
  [[nodiscard]] int Count(const char* name) const {
    return exists() ? reflection().FieldSize(*message_, Field(name)) : 0;
  }

  const google::protobuf::Message* message_;
};

/// A reader that uses libprotobuf and applies all rules of the codec about the wire format.
class WideOracle {
 public:
  WideOracle()
      : last_value_schema_(Build(pool_, factory_, false)),
        all_values_schema_(Build(all_pool_, all_factory_, true)) {}

  /// Null if libprotobuf refuses the bytes, or if they break a rule that libprotobuf does not have:
  ///
  ///   - a known field of another wire type, a group: libprotobuf treats both as unknown fields
  ///   - an integer or enum beyond 32 bits: libprotobuf truncates it
  ///   - more repeated elements than the wire's fixed sizes, a name of more than 63 bytes: it has no such
  ///   limits
  ///
  /// libprotobuf also truncates a tag of more than 32 bits and a varint of more than 64; this cannot be
  /// detected here.
  [[nodiscard]] std::unique_ptr<google::protobuf::Message> Parse(std::span<const std::uint8_t> bytes) const {
    auto last = Parsed(*last_value_schema_, bytes), all = Parsed(*all_values_schema_, bytes);
    if (last == nullptr || !last->IsInitialized() || !KeepsRules(*last)) return nullptr;
    return all != nullptr && KeepsRules(*all, true) ? std::move(last) : nullptr;
  }

 private:
  using Message = google::protobuf::Message;
  using FieldProto = google::protobuf::FieldDescriptorProto;
  using FieldDescriptor = google::protobuf::FieldDescriptor;

  // Builds the widened schema. @param all  true: each number and string is a repeated field
  static const Message* Build(google::protobuf::DescriptorPool& pool,
                              google::protobuf::DynamicMessageFactory& factory, bool all) {
    google::protobuf::FileDescriptorProto file;
    fri::FRIMonitoringMessage::descriptor()->file()->CopyTo(&file);
    for (auto& message : *file.mutable_message_type())
      for (FieldProto& field : *message.mutable_field()) Widen(field, all);
    pool.BuildFile(file);
    return factory.GetPrototype(pool.FindMessageTypeByName("osteon.fri.FRIMonitoringMessage"));
  }

  // Changes a field's type to one that holds every value that the wire can carry.
  static void Widen(FieldProto& field, bool all) {
    if (field.type() == FieldProto::TYPE_ENUM || field.type() == FieldProto::TYPE_UINT32) {
      field.set_type(FieldProto::TYPE_UINT64);
      field.clear_type_name();
    }
    if (field.type() == FieldProto::TYPE_STRING) field.set_type(FieldProto::TYPE_BYTES);
    if (all && field.type() != FieldProto::TYPE_MESSAGE) field.set_label(FieldProto::LABEL_REPEATED);
  }

  static std::unique_ptr<Message> Parsed(const Message& prototype, std::span<const std::uint8_t> bytes) {
    std::unique_ptr<Message> message(prototype.New());
    const bool whole = message->ParsePartialFromArray(bytes.data(), static_cast<int>(bytes.size()));
    return whole ? std::move(message) : nullptr;
  }

  // The most elements that the codec accepts in a repeated field.
  static int MaxElements(const FieldDescriptor& field) {
    const std::string name = field.full_name();
    if (name == "osteon.fri.JointValues.value" || name == "osteon.fri.RobotInfo.driveState") return 7;
    if (name == "osteon.fri.CartesianVector.element") return 6;
    if (name == "osteon.fri.Transformation.element") return 12;
    if (name == "osteon.fri.MessageMonitorData.readIORequest") return 10;
    if (name == "osteon.fri.FRIMonitoringMessage.requestedTransformations") return 5;
    return 0;
  }

  // Whether the number fits the field's type in fri.proto.
  static bool InRange(const FieldDescriptor& field, std::uint64_t value) {
    if (value <= 0xffffffffu) return true;
    const auto type = fri::FRIMonitoringMessage::descriptor()
                          ->file()
                          ->FindMessageTypeByName(field.containing_type()->name())
                          ->FindFieldByNumber(field.number())
                          ->type();
    if (type == FieldDescriptor::TYPE_ENUM) return value >= 0xffffffff80000000u;  // negative
    return type == FieldDescriptor::TYPE_UINT64;
  }

  // Whether a message keeps the rules listed above Parse(). @param all  true: the message has the schema of
  // repeated fields, and its numbers and names are checked; false: the message has the first schema, and its
  // unknown fields and sizes are checked
  static bool KeepsRules(const Message& message, bool all = false) {
    const auto& reflection = *message.GetReflection();
    const auto& unknown = reflection.GetUnknownFields(message);
    for (int i = 0; i < unknown.field_count() && !all; ++i) {
      if (unknown.field(i).type() == google::protobuf::UnknownField::TYPE_GROUP) return false;
      if (message.GetDescriptor()->FindFieldByNumber(unknown.field(i).number()) != nullptr) return false;
    }
    std::vector<const FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const FieldDescriptor* field : fields) {
      const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
      if (!all && field->is_repeated() && count > MaxElements(*field)) return false;
      for (int i = 0; i < count; ++i)
        if (!KeepsRules(message, *field, i, all)) return false;
    }
    return true;
  }

  static bool KeepsRules(const Message& message, const FieldDescriptor& field, int i, bool all) {
    const auto& reflection = *message.GetReflection();
    const bool repeated = field.is_repeated();
    if (field.type() == FieldDescriptor::TYPE_MESSAGE)
      return KeepsRules(repeated ? reflection.GetRepeatedMessage(message, &field, i)
                                 : reflection.GetMessage(message, &field),
                        all);
    if (!all) return true;
    if (field.type() == FieldDescriptor::TYPE_UINT64)
      return InRange(field, reflection.GetRepeatedUInt64(message, &field, i));
    if (field.type() == FieldDescriptor::TYPE_BYTES)
      return reflection.GetRepeatedString(message, &field, i).size() <= 63;
    return true;
  }

  google::protobuf::DescriptorPool pool_, all_pool_;
  google::protobuf::DynamicMessageFactory factory_, all_factory_;
  const Message *last_value_schema_, *all_values_schema_;
};

}  // namespace osteon::io::test
