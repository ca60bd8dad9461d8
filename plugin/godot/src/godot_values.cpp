#include "plugin/godot/src/godot_values.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace osteon::godot {

const godot_gdnative_core_api_struct* api = nullptr;

namespace {

constexpr int kMeshArrays = 9;  // ArrayMesh.ARRAY_MAX
// indices of Godot's Mesh.ArrayType
constexpr int kVertexArray = 0, kNormalArray = 1, kColorArray = 3, kIndexArray = 8;

// Godot's arrays store vectors and colours as plain floats, so that data can be copied at once.
static_assert(sizeof(godot_vector3) == 3 * sizeof(float) && sizeof(godot_color) == 4 * sizeof(float));
static_assert(sizeof(godot_int) == sizeof(std::int32_t));

godot_vector3 ToGodot(const host::Vector& v) {
  godot_vector3 result;
  api->godot_vector3_new(&result, static_cast<float>(v[0]), static_cast<float>(v[1]),
                         static_cast<float>(v[2]));
  return result;
}

host::Vector FromGodot(const godot_vector3& v) {
  return {static_cast<double>(api->godot_vector3_get_axis(&v, GODOT_VECTOR3_AXIS_X)),
          static_cast<double>(api->godot_vector3_get_axis(&v, GODOT_VECTOR3_AXIS_Y)),
          static_cast<double>(api->godot_vector3_get_axis(&v, GODOT_VECTOR3_AXIS_Z))};
}

/// Makes a PoolVector3Array of coordinates x y z.
godot_variant Vectors(const std::vector<float>& xyz) {
  godot_pool_vector3_array array;
  api->godot_pool_vector3_array_new(&array);
  api->godot_pool_vector3_array_resize(&array, static_cast<godot_int>(xyz.size() / 3));
  godot_pool_vector3_array_write_access* access = api->godot_pool_vector3_array_write(&array);
  std::memcpy(api->godot_pool_vector3_array_write_access_ptr(access), xyz.data(), xyz.size() * sizeof(float));
  api->godot_pool_vector3_array_write_access_destroy(access);
  godot_variant value;
  api->godot_variant_new_pool_vector3_array(&value, &array);
  api->godot_pool_vector3_array_destroy(&array);
  return value;
}

/// Makes a PoolColorArray of bytes red green blue; every colour is opaque.
godot_variant Colors(const std::vector<std::uint8_t>& rgb) {
  std::vector<float> rgba;
  rgba.reserve(rgb.size() / 3 * 4);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgba.push_back(static_cast<float>(rgb[i]) / 255.0F);
    if (i % 3 == 2) rgba.push_back(1.0F);
  }
  godot_pool_color_array array;
  api->godot_pool_color_array_new(&array);
  api->godot_pool_color_array_resize(&array, static_cast<godot_int>(rgba.size() / 4));
  godot_pool_color_array_write_access* access = api->godot_pool_color_array_write(&array);
  std::memcpy(api->godot_pool_color_array_write_access_ptr(access), rgba.data(), rgba.size() * sizeof(float));
  api->godot_pool_color_array_write_access_destroy(access);
  godot_variant value;
  api->godot_variant_new_pool_color_array(&value, &array);
  api->godot_pool_color_array_destroy(&array);
  return value;
}

/// Makes a PoolIntArray.
godot_variant Integers(const std::vector<std::int32_t>& integers) {
  godot_pool_int_array array;
  api->godot_pool_int_array_new(&array);
  api->godot_pool_int_array_resize(&array, static_cast<godot_int>(integers.size()));
  godot_pool_int_array_write_access* access = api->godot_pool_int_array_write(&array);
  std::memcpy(api->godot_pool_int_array_write_access_ptr(access), integers.data(),
              integers.size() * sizeof(std::int32_t));
  api->godot_pool_int_array_write_access_destroy(access);
  godot_variant value;
  api->godot_variant_new_pool_int_array(&value, &array);
  api->godot_pool_int_array_destroy(&array);
  return value;
}

}  // namespace

Value::Value(const std::string& text) {
  godot_string string;
  api->godot_string_new(&string);
  api->godot_string_parse_utf8(&string, text.c_str());
  api->godot_variant_new_string(&value_, &string);
  api->godot_string_destroy(&string);
}

Value::Value(const host::Vector& v) {
  const godot_vector3 vector = ToGodot(v);
  api->godot_variant_new_vector3(&value_, &vector);
}

Value::Value(const host::Pose& pose) {
  const std::array<host::Vector, 3> rows = host::RowsOf(pose.orientation);
  const godot_vector3 x = ToGodot(rows[0]), y = ToGodot(rows[1]), z = ToGodot(rows[2]);
  const godot_vector3 origin = ToGodot(pose.position);
  godot_basis basis;
  api->godot_basis_new_with_rows(&basis, &x, &y, &z);
  godot_transform transform;
  api->godot_transform_new(&transform, &basis, &origin);
  api->godot_variant_new_transform(&value_, &transform);
}

Value Value::MeshArrays(const host::Brick& brick) {
  godot_array arrays;
  api->godot_array_new(&arrays);
  if (!brick.indices.empty()) {
    api->godot_array_resize(&arrays, kMeshArrays);
    const auto set = [&](int index, godot_variant value) {
      api->godot_array_set(&arrays, index, &value);
      api->godot_variant_destroy(&value);
    };
    set(kVertexArray, Vectors(brick.positions));
    set(kNormalArray, Vectors(brick.normals));
    set(kColorArray, Colors(brick.colors));
    set(kIndexArray, Integers(brick.indices));
  }
  Value value(arrays);
  api->godot_array_destroy(&arrays);
  return value;
}

std::string Arguments::Mismatch(const char* method,
                                std::initializer_list<godot_variant_type> accepted) const {
  bool fits = count_ == static_cast<int>(accepted.size());
  int i = 0;
  for (const godot_variant_type type : accepted) {
    if (!fits) break;
    const godot_variant_type found = api->godot_variant_get_type(values_[i++]);
    fits = found == type || (type == GODOT_VARIANT_TYPE_REAL && found == GODOT_VARIANT_TYPE_INT);
  }
  if (fits) return {};
  std::string text = std::string(method) + ": found (";
  for (i = 0; i < count_; ++i)
    text += std::string(i > 0 ? ", " : "") + TypeName(api->godot_variant_get_type(values_[i]));
  text += "), accepted (";
  i = 0;
  for (const godot_variant_type type : accepted) text += std::string(i++ > 0 ? ", " : "") + TypeName(type);
  return text + ")";
}

host::Pose Arguments::PoseAt(int i) const {
  const godot_transform transform = api->godot_variant_as_transform(values_[i]);
  const godot_basis basis = api->godot_transform_get_basis(&transform);
  const godot_vector3 origin = api->godot_transform_get_origin(&transform);
  std::array<host::Vector, 3> rows{};
  for (int row = 0; row < 3; ++row)
    rows[static_cast<std::size_t>(row)] = FromGodot(api->godot_basis_get_row(&basis, row));
  return {FromGodot(origin), host::RotationOf(rows)};
}

host::Vector Arguments::VectorAt(int i) const {
  const godot_vector3 vector = api->godot_variant_as_vector3(values_[i]);
  return FromGodot(vector);
}

std::string Arguments::TextAt(int i) const { return ToText(values_[i]); }

namespace {

/// Stores a value in its field. @returns an empty text, or the type that is accepted.
const char* TakeValue(const Field& field, const godot_variant* value) {
  const godot_variant_type found = api->godot_variant_get_type(value);
  if (auto* const* text = std::get_if<std::string*>(&field.value)) {
    if (found != GODOT_VARIANT_TYPE_STRING) return "String";
    **text = ToText(value);
  } else if (auto* const* number = std::get_if<double*>(&field.value)) {
    if (found != GODOT_VARIANT_TYPE_REAL && found != GODOT_VARIANT_TYPE_INT) return "float";
    **number = api->godot_variant_as_real(value);
  } else if (auto* const* flag = std::get_if<bool*>(&field.value)) {
    if (found != GODOT_VARIANT_TYPE_BOOL) return "bool";
    **flag = api->godot_variant_as_bool(value);
  } else if (auto* const* index = std::get_if<std::uint32_t*>(&field.value)) {
    if (found != GODOT_VARIANT_TYPE_INT) return "int";
    const std::int64_t given = api->godot_variant_as_int(value);
    // A number that is out of range becomes UINT32_MAX, which the library refuses.
    **index = given < 0 || given > INT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(given);
  } else if (auto* const* vector = std::get_if<host::Vector*>(&field.value)) {
    if (found != GODOT_VARIANT_TYPE_VECTOR3) return "Vector3";
    **vector = FromGodot(api->godot_variant_as_vector3(value));
  }
  return "";
}

/// Stores the value of a Dictionary's key in the field of that name. @returns an empty text, or the error
std::string TakeKey(const char* method, const std::string& key, const godot_variant* value,
                    std::initializer_list<Field> fields) {
  std::string accepted;
  for (const Field& field : fields) {
    if (key == field.key) {
      const std::string type = TakeValue(field, value);
      if (type.empty()) return {};
      return key + ": found " + TypeName(api->godot_variant_get_type(value)) + ", accepted a " + type;
    }
    accepted += std::string(accepted.empty() ? "" : ", ") + field.key;
  }
  return std::string(method) + ": found the key '" + key + "', accepted " + accepted;
}

}  // namespace

std::string ReadDictionary(const char* method, const godot_variant* dictionary,
                           std::initializer_list<Field> fields) {
  godot_dictionary values = api->godot_variant_as_dictionary(dictionary);
  godot_array keys = api->godot_dictionary_keys(&values);
  std::string wrong;
  for (int i = 0; wrong.empty() && i < api->godot_array_size(&keys); ++i) {
    godot_variant key = api->godot_array_get(&keys, i);
    godot_variant value = api->godot_dictionary_get(&values, &key);
    wrong = TakeKey(method, ToText(&key), &value, fields);
    api->godot_variant_destroy(&value);
    api->godot_variant_destroy(&key);
  }
  api->godot_array_destroy(&keys);
  api->godot_dictionary_destroy(&values);
  return wrong;
}

const char* TypeName(godot_variant_type type) {
  switch (type) {
    case GODOT_VARIANT_TYPE_NIL:
      return "null";
    case GODOT_VARIANT_TYPE_BOOL:
      return "bool";
    case GODOT_VARIANT_TYPE_INT:
      return "int";
    case GODOT_VARIANT_TYPE_REAL:
      return "float";
    case GODOT_VARIANT_TYPE_STRING:
      return "String";
    case GODOT_VARIANT_TYPE_VECTOR3:
      return "Vector3";
    case GODOT_VARIANT_TYPE_TRANSFORM:
      return "Transform";
    case GODOT_VARIANT_TYPE_OBJECT:
      return "Object";
    case GODOT_VARIANT_TYPE_DICTIONARY:
      return "Dictionary";
    case GODOT_VARIANT_TYPE_ARRAY:
      return "Array";
    default:
      return "another type";
  }
}

std::string ToText(const godot_variant* value) {
  godot_string string = api->godot_variant_as_string(value);
  godot_char_string utf8 = api->godot_string_utf8(&string);
  std::string text(api->godot_char_string_get_data(&utf8),
                   static_cast<std::size_t>(api->godot_char_string_length(&utf8)));
  api->godot_char_string_destroy(&utf8);
  api->godot_string_destroy(&string);
  return text;
}

}  // namespace osteon::godot
