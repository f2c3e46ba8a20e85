// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/interface_text.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace segue::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using type::Value;

std::vector<MessageDefinition> read(const std::string& text, const std::string& kind = "msg") {
  Diagnostics diagnostics;
  auto messages = read_interface({"my_msgs", kind, "My"}, text, "My." + kind, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << to_string(diagnostics);
  return messages.empty() ? std::vector<MessageDefinition>(1) : messages;
}

std::string problems(const std::string& text, const std::string& kind = "msg") {
  Diagnostics diagnostics;
  EXPECT_THAT(read_interface({"my_msgs", kind, "My"}, text, "My." + kind, diagnostics), SizeIs(0));
  return to_string(diagnostics);
}

std::vector<std::string> fields(const MessageDefinition& message) {
  std::vector<std::string> all;
  for (const FieldDefinition& field : message.fields)
    all.push_back(to_string(field.type) + " " + field.name);
  return all;
}

std::vector<std::string> names(const std::vector<MessageDefinition>& messages) {
  std::vector<std::string> all;
  for (const MessageDefinition& message : messages)
    all.push_back(message.name);
  return all;
}

TEST(InterfaceText, HasAFieldOnEachLine) {
  const auto message = read(
      "# A comment\n\n"
      "int32 x  # another one\r\n"
      "\tchar[3] c\n"
      "string<=10[<=4] words\n"
      "Own[] own\n"
      "geometry_msgs/Point point")[0];
  EXPECT_EQ(message.name, "my_msgs/msg/My");
  EXPECT_THAT(fields(message), ElementsAre("int32 x", "uint8[3] c", "string<=10[<=4] words",
                                           "my_msgs/msg/Own[] own", "geometry_msgs/msg/Point point"));
}

TEST(InterfaceText, HasDefaults) {
  const auto message = read(
      "float64 w 1\n"
      "bool b TRUE\n"
      "int8 i -0x80\n"
      "string s 'it\\'s'\n"
      "string[] l [\"a, b\", c]\n"
      "uint64 u 18446744073709551615\n"
      "uint8[2] p [1,2]\n"
      "float32[] none []\n")[0];
  const auto value = [&](std::size_t field) { return message.fields.at(field).default_value.value(); };
  EXPECT_EQ(value(0), Value(1.0));
  EXPECT_EQ(value(1), Value(true));
  EXPECT_EQ(value(2), Value(-128));
  EXPECT_EQ(value(3), Value("it's"));
  EXPECT_EQ(value(4), Value::list({"a, b", "c"}));
  EXPECT_EQ(value(5), Value(std::uint64_t{18446744073709551615U}));
  EXPECT_EQ(value(6), Value::list({1, 2}));
  EXPECT_EQ(value(7), Value::list({}));
}

TEST(InterfaceText, HasConstants) {
  const auto message = read("uint8 FIX=2\nstring NAME = \"a b\"\nfloat64 G=-9.81e0\n")[0];
  ASSERT_THAT(message.constants, SizeIs(3));
  EXPECT_EQ(message.constants[0].value, Value(2));
  EXPECT_EQ(message.constants[1].name, "NAME");
  EXPECT_EQ(message.constants[1].value, Value("a b"));
  EXPECT_EQ(message.constants[2].value, Value(-9.81));
  EXPECT_THAT(fields(message), ElementsAre("uint8 structure_needs_at_least_one_member"));
}

TEST(InterfaceText, OfAServiceHasRequestAndResponse) {
  const auto messages = read("int64 a\n---\nint64 sum\n", "srv");
  EXPECT_THAT(names(messages), ElementsAre("my_msgs/srv/My", "my_msgs/srv/My_Request",
                                           "my_msgs/srv/My_Response", "my_msgs/srv/My_Event"));
  EXPECT_THAT(fields(messages[3]),
              ElementsAre("service_msgs/msg/ServiceEventInfo info", "my_msgs/srv/My_Request[<=1] request",
                          "my_msgs/srv/My_Response[<=1] response"));
}

TEST(InterfaceText, OfAnActionHasTheServicesThatCarryIt) {
  const auto messages = read("int32 order\n---\n---\nint32 done\n", "action");
  EXPECT_THAT(messages, SizeIs(13));
  const auto found =
      std::ranges::find(messages, "my_msgs/action/My_SendGoal_Response", &MessageDefinition::name);
  ASSERT_NE(found, messages.end());
  EXPECT_THAT(fields(*found), ElementsAre("bool accepted", "builtin_interfaces/msg/Time stamp"));
}

TEST(InterfaceText, SaysWhatIsWrongInWords) {
  EXPECT_THAT(problems("int32"),
              HasSubstr("My.msg:1:1: error: 'int32' is not a valid field: expected TYPE NAME"));
  EXPECT_THAT(problems("\nint33 x"), HasSubstr("My.msg:2:1: error: 'int33' is not a valid type"));
  EXPECT_THAT(problems("time t"), HasSubstr("in ROS 2 it is builtin_interfaces/Time"));
  EXPECT_THAT(problems("int32 X"), HasSubstr("'X' is not a valid name of a field"));
  EXPECT_THAT(problems("int32 a__b"), HasSubstr("'a__b' is not a valid name of a field"));
  EXPECT_THAT(problems("int32 x\nint8 x"), HasSubstr("field 'x' is there twice"));
  EXPECT_THAT(problems("int32[0] x"), HasSubstr("a number above 0"));
  EXPECT_THAT(problems("int32[-1] x"), HasSubstr("a number above 0"));
  EXPECT_THAT(problems("int32] x"), HasSubstr("it lacks a '['"));
  EXPECT_THAT(problems("int32<=3 x"), HasSubstr("only strings and arrays have an upper bound"));
  EXPECT_THAT(problems("string<=x s"), HasSubstr("the upper bound of a string"));
  EXPECT_THAT(problems("a/b/C x"), HasSubstr("is not a valid type"));
  EXPECT_THAT(problems("uint8 x 256"), HasSubstr("'256' is not an integer from 0 to 255"));
  EXPECT_THAT(problems("uint8 x -1"), HasSubstr("'-1' is not an integer from 0 to 255"));
  EXPECT_THAT(problems("int64 x -9223372036854775809"),
              HasSubstr("is not an integer from -9223372036854775808"));
  EXPECT_THAT(problems("float32 x 1,5"), HasSubstr("'1,5' is not a number"));
  EXPECT_THAT(problems("bool x yes"), HasSubstr("'yes' is not true or false"));
  EXPECT_THAT(problems("string<=2 s abc"), HasSubstr("text of at most 2 characters"));
  EXPECT_THAT(problems("string s 'a'b'"), HasSubstr("inner quotes are escaped"));
  EXPECT_THAT(problems("int32[2] x [1]"), HasSubstr("a list of 2 items"));
  EXPECT_THAT(problems("int32[<=1] x [1,2]"), HasSubstr("a list of at most 1 item"));
  EXPECT_THAT(problems("Own x 1"), HasSubstr("can have no default"));
  EXPECT_THAT(problems("int32[] X=1"), HasSubstr("a constant has a basic type"));
  EXPECT_THAT(problems("string<=3 X=abc"), HasSubstr("without a bound"));
  EXPECT_THAT(problems("int32 x=1"), HasSubstr("'x' is not a valid name of a constant"));
  EXPECT_THAT(problems("int32 X=1\nint32 X=2"), HasSubstr("constant 'X' is there twice"));
  EXPECT_THAT(problems("int32 a", "srv"), HasSubstr("a service has two parts"));
  EXPECT_THAT(problems("---\n", "action"), HasSubstr("an action has three parts"));
}

}  // namespace
}  // namespace segue::ros2
