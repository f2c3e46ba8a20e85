// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The interfaces of ROS 2 (messages, services, actions) as plain values. Needs nothing of ROS 2.
namespace segue::ros2 {

/// The kind of a field, apart from how many items it has. The numbers are those of
/// type_description_interfaces/msg/FieldType for a single item (REP-2016).
enum class Primitive : std::uint8_t {
  Nested = 1,
  Int8 = 2,
  Uint8 = 3,
  Int16 = 4,
  Uint16 = 5,
  Int32 = 6,
  Uint32 = 7,
  Int64 = 8,
  Uint64 = 9,
  Float32 = 10,
  Float64 = 11,
  Bool = 15,
  Byte = 16,
  String = 17,
  WString = 18,
  BoundedString = 21,
  BoundedWString = 22
};

/// How many items a field has. The numbers are those that REP-2016 adds to that of the item.
enum class Multiplicity : std::uint8_t { Single = 0, Array = 48, BoundedSequence = 96, Sequence = 144 };

/// The type of a field: "string<=10[<=4]".
struct FieldType {
  Primitive primitive = Primitive::Nested;
  std::string nested{};               ///< of Nested: "geometry_msgs/msg/Point"
  std::uint64_t string_capacity = 0;  ///< of bounded strings: the most characters
  Multiplicity multiplicity = Multiplicity::Single;
  std::uint64_t capacity = 0;  ///< of Array: its items; of BoundedSequence: the most items
  friend bool operator==(const FieldType&, const FieldType&) = default;
};

/// A field of a message.
struct FieldDefinition {
  std::string name;
  FieldType type;
  std::optional<type::Value> default_value{};  ///< a single item or a list
};

/// A constant of a message: "uint8 STATUS_FIX=0".
struct ConstantDefinition {
  std::string name;
  Primitive type = Primitive::Int32;
  type::Value value;
};

/// A structure with fields. Of a service or an action itself these are its parts, as in its type description
/// (REP-2016): "request_message", "response_message" and "event_message"; "goal", "result" and so on.
struct MessageDefinition {
  std::string name;  ///< "geometry_msgs/msg/Point", "std_srvs/srv/SetBool_Request"
  std::vector<FieldDefinition> fields{};
  std::vector<ConstantDefinition> constants{};
};

/// The name of an interface, in its parts.
struct InterfaceName {
  std::string package;
  std::string kind;  ///< "msg", "srv" or "action"
  std::string name;
};

/// "geometry_msgs/msg/Point", also "geometry_msgs/Point", which is a message. InvalidArgument where it is not
/// such a name.
Result<InterfaceName> parse_interface_name(std::string_view text);
std::string to_string(const InterfaceName& name);
/// "uint8"; of a bounded string "string", of Nested "".
std::string_view to_string(Primitive primitive);
/// "uint8", "string<=10", "geometry_msgs/msg/Point[]", "float64[36]"
std::string to_string(const FieldType& type);

}  // namespace segue::ros2
