// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/parameter_value.hpp>

#include <gmock/gmock.h>

#include <limits>

namespace segue::ros2 {
namespace {

using ::testing::HasSubstr;
using type::Value;

/// The parameters as a node gets them: name, number of the type, and the whole message.
Value sent(const Value& parameters) {
  InterfaceLibrary library;
  const auto codec = MessageCodec::of(library, "rcl_interfaces/srv/SetParametersAtomically_Request").value();
  const auto message = codec.encode(parameters_request(parameters, "parameters").value(), "request").value();
  return *codec.decode(message).value().find("parameters");
}

TEST(ParameterValues, HaveTheKindsOfRos2) {
  const Value all = sent(Value::map({{"on", true},
                                     {"count", 3},
                                     {"gain", 0.5},
                                     {"frame", "base_link"},
                                     {"flags", Value::list({true, false})},
                                     {"counts", Value::list({1, 2})},
                                     {"gains", Value::list({0.5, 1.5})},
                                     {"frames", Value::list({"a", "b"})}}));
  const std::vector<std::pair<const char*, int>> expected = {
      {"bool_value", 1},         {"integer_value", 2},     {"double_value", 3},
      {"string_value", 4},       {"bool_array_value", 6},  {"integer_array_value", 7},
      {"double_array_value", 8}, {"string_array_value", 9}};
  ASSERT_EQ(all.as_list().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Value& value = *all.as_list()[i].find("value");
    EXPECT_EQ(value.find("type")->as_int(), expected[i].second) << i;
  }
  EXPECT_EQ(all.as_list()[2].find("value")->find("double_value")->as_double(), 0.5);
  EXPECT_EQ(all.as_list()[5].find("value")->find("integer_array_value")->as_list().size(), 2U);
}

TEST(ParameterValues, OfMapsWithinHaveNamesWithDots) {
  const Value all = sent(Value::map({{"controller", Value::map({{"pid", Value::map({{"gain", 1.0}})}})}}));
  EXPECT_EQ(all.as_list().front().find("name")->as_string(), "controller.pid.gain");
}

TEST(ParameterValues, OfSingleValuesAreThereWhereThereIsACounterpart) {
  EXPECT_EQ(parameter_value(0.5), Value::map({{"type", 3}, {"double_value", 0.5}}));
  EXPECT_EQ(parameter_value(Value::list({"a"})),
            Value::map({{"type", 9}, {"string_array_value", Value::list({"a"})}}));
  EXPECT_EQ(parameter_value(std::numeric_limits<std::uint64_t>::max()), std::nullopt);
  EXPECT_EQ(parameter_value(Value::map({{"p", 0.5}})), std::nullopt);
  EXPECT_EQ(parameter_value(Value()), std::nullopt);
}

TEST(ParameterValues, ThatNoParameterCanHaveAreRefused) {
  const auto error = [](const Value& parameters) {
    return parameters_request(parameters, "parameters").error().message;
  };
  EXPECT_THAT(error(Value::map({{"a", Value()}})),
              HasSubstr("parameters.a: expected a bool, a number, a text"));
  EXPECT_THAT(error(Value::map({{"a", Value::list({1, 0.5})}})), HasSubstr("parameters.a"));
  EXPECT_THAT(error(Value::map({{"a", Value::list({Value::list({1})})}})), HasSubstr("parameters.a"));
  EXPECT_THAT(error(3), HasSubstr("parameters: expected a map of parameters"));
}

TEST(ParameterFiles, AreReadByYaml11AsTheyAreMeant) {
  const Value parameters = Value::map({{"rate", 10},
                                       {"gain", 2.0},
                                       {"limit", 1e300},
                                       {"off", std::numeric_limits<double>::infinity()},
                                       {"on", "yes"},
                                       {"pid", Value::map({{"order", Value::list({0.5, 1.0})}})}});
  EXPECT_EQ(
      parameter_file("/robot/arm", parameters),
      "\"/robot/arm\": {\"ros__parameters\": {\"rate\": 10, \"gain\": 2.0, \"limit\": 1e+300, \"off\": .inf, "
      "\"on\": \"yes\", \"pid\": {\"order\": [0.5, 1.0]}}}\n");
}

TEST(ParameterValues, OfMessagesAreThoseThatWereSent) {
  const Value given = Value::map({{"a", true},
                                  {"b", 3},
                                  {"c", 0.5},
                                  {"d", "text"},
                                  {"e", Value::list({1, 2})},
                                  {"f", Value::list({0.5})},
                                  {"g", Value::list({"x"})},
                                  {"h", Value::list({true, false})}});
  const Value all = sent(given);
  for (const Value& one : all.as_list()) {
    const Value& message = *one.find("value");
    EXPECT_EQ(parameter_from(message), *given.find(one.find("name")->as_string()));
  }
  EXPECT_EQ(parameter_from(Value::map({{"type", 0}})), Value()) << "it is not set";
  EXPECT_EQ(parameter_from(Value::map({{"type", 10}})), Value()) << "ROS 2 may get more kinds";
  EXPECT_EQ(parameter_kind(8), "double array");
  EXPECT_EQ(parameter_kind(10), "unknown");
}

}  // namespace
}  // namespace segue::ros2
