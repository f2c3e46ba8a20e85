// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/made_type.hpp>

#include <gmock/gmock.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "support/temporary_files.hpp"

/// A user's own struct of that message.
namespace sensor_msgs {

struct JointState {
  struct Header {
    struct Time {
      std::int32_t sec = 0;
      std::uint32_t nanosec = 0;
    };
    Time stamp;
    std::string frame_id;
  };
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> effort;
};

}  // namespace sensor_msgs

SEGUE_TYPE(sensor_msgs::JointState::Header::Time, sec, nanosec)
SEGUE_TYPE(sensor_msgs::JointState::Header, stamp, frame_id)
SEGUE_TYPE(sensor_msgs::JointState, header, name, position, velocity, effort)

namespace segue::ros2 {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using type::Value;

/// A value of each member that tells it from others.
Value filled(const type::Type& type, int& next) {
  switch (type.kind) {
    case type::TypeKind::Numeric:
      if (type.category == type::NumericCategory::Bool) return ++next % 2 == 0;
      return type.category == type::NumericCategory::Float ? Value(++next % 100 + 0.5) : Value(++next % 100);
    case type::TypeKind::Compound: {
      type::ValueMap map;
      for (const type::Field& field : type.fields)
        map.set(field.name, filled(*field.type, next));
      return map;
    }
    default: {
      if (type.is_string()) return "text " + std::to_string(++next);
      Value::List list;
      for (std::size_t i = 0; i < (type.kind == type::TypeKind::Array ? type.count : 3); ++i)
        list.push_back(filled(*type.element, next));
      return list;
    }
  }
}

/// Writes a value as CDR from an object of the type, and reads it into another.
Value through_cdr(const type::TypeInfo& info, const Value& value) {
  const auto object = [&] {
    const std::shared_ptr<std::byte[]> memory(new std::byte[info.size], [&info](std::byte* bytes) {
      info.destroy(bytes);
      delete[] bytes;
    });
    info.construct(memory.get());
    return memory;
  };
  const auto sent = object();
  const auto received = object();
  const auto done = info.from_value(sent.get(), value, "");
  EXPECT_TRUE(done) << to_string(done.error());
  std::vector<std::byte> bytes(type::cdr_size(info, sent.get()));
  EXPECT_TRUE(type::write_cdr(info, sent.get(), bytes)) << info.name();
  EXPECT_TRUE(type::read_cdr(info, received.get(), bytes)) << info.name();
  return info.to_value(received.get());
}

TEST(MessageType, OfEveryStandardInterfaceTravelsAsCdr) {
  InterfaceLibrary library;
  type::TypeRegistry registry;
  for (const std::string& name : library.names()) {
    const auto type = message_type(library, name, registry);
    ASSERT_TRUE(type) << to_string(type.error());
    const auto defaults = message_defaults(library, name);
    ASSERT_TRUE(defaults);
    const auto info = type::make_type_info(**type, *defaults);
    ASSERT_TRUE(info) << name << ": " << to_string(info.error());
    int next = 0;
    const Value value = filled(**type, next);
    EXPECT_EQ(through_cdr(**info, value), value) << name;
  }
}

TEST(MessageType, IsThatOfAStructWithTheSameMembers) {
  InterfaceLibrary library;
  type::TypeRegistry registry;
  const auto type = message_type(library, "sensor_msgs/msg/JointState", registry);
  ASSERT_TRUE(type);
  EXPECT_EQ(type::structural_hash(**type), type::type_info<sensor_msgs::JointState>().hash);
  EXPECT_EQ(*type::make_type_info(**type), &type::type_info<sensor_msgs::JointState>());
}

TEST(MessageType, HasTheDefaultsOfItsParts) {
  InterfaceLibrary library;
  const auto defaults = message_defaults(library, "geometry_msgs/msg/PoseStamped");
  ASSERT_TRUE(defaults);
  ASSERT_THAT(*defaults, SizeIs(1));
  EXPECT_EQ(*defaults->at("/geometry_msgs/Quaternion").find("w"), Value(1.0));
}

TEST(MessageType, IsRefusedWithAWideString) {
  const testing::TemporaryFiles folder;
  folder.write("a/msg/Wide.msg", "wstring text\n");
  InterfaceLibrary library({folder.folder()});
  type::TypeRegistry registry;
  EXPECT_THAT(to_string(message_type(library, "a/msg/Wide", registry).error()),
              HasSubstr("field 'text' of a/msg/Wide is a wstring"));
}

TEST(MessageType, HasAnotherNameOnDds) {
  EXPECT_EQ(dds_type_name("geometry_msgs/msg/Point"), "geometry_msgs::msg::dds_::Point_");
  EXPECT_EQ(dds_type_name("std_srvs/srv/SetBool_Request"), "std_srvs::srv::dds_::SetBool_Request_");
}

}  // namespace
}  // namespace segue::ros2
