// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/told_interface.hpp>

#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/type_hash.hpp>

#include <gmock/gmock.h>

#include "support/temporary_files.hpp"

namespace segue::ros2 {
namespace {

using ::testing::HasSubstr;
using type::Value;

constexpr const char* kText =
    "uint8 FAR=3\nstring<=10 text \"none\"\nLabelPart[<=4] parts\ngeometry_msgs/Point[2] places\nfloat64[] "
    "all\n";

Value field_value(const FieldDefinition& field) {
  const FieldType& type = field.type;
  return Value::map({{"name", field.name},
                     {"type", Value::map({{"type_id", static_cast<int>(type.primitive) +
                                                          static_cast<int>(type.multiplicity)},
                                          {"capacity", type.capacity},
                                          {"string_capacity", type.string_capacity},
                                          {"nested_type_name", type.nested}})}});
}

Value described(const MessageDefinition& message) {
  Value::List fields;
  for (const FieldDefinition& field : message.fields)
    fields.push_back(field_value(field));
  return Value::map({{"type_name", message.name}, {"fields", Value(std::move(fields))}});
}

class ToldInterfaces : public ::testing::Test {
 protected:
  ToldInterfaces() {
    files.write("my_msgs/msg/Label.msg", kText);
    files.write("my_msgs/msg/LabelPart.msg", "");
    library = InterfaceLibrary({files.folder()});
    hash = type_hash(library, "my_msgs/msg/Label").value();
  }
  /// As a node with these files answers.
  Value answer(const std::string& source) {
    const auto messages = library.with_parts("my_msgs/msg/Label").value();
    Value::List parts;
    for (std::size_t i = 1; i < messages.size(); ++i)
      parts.push_back(described(*messages[i]));
    return Value::map(
        {{"successful", true},
         {"failure_reason", ""},
         {"type_description", Value::map({{"type_description", described(*messages.front())},
                                          {"referenced_type_descriptions", Value(std::move(parts))}})},
         {"type_sources",
          Value::list({Value::map(
              {{"type_name", "my_msgs/msg/Label"}, {"encoding", "msg"}, {"raw_file_contents", source}})})}});
  }

  testing::TemporaryFiles files;
  InterfaceLibrary library;
  std::string hash;
};

TEST_F(ToldInterfaces, AreFilesOfTheSameHash) {
  const auto told = told_interface(answer("int8 another\n"), "my_msgs/msg/Label", hash);
  ASSERT_TRUE(told) << to_string(told.error());
  ASSERT_EQ(told->size(), 2U) << "Point is built in";
  EXPECT_EQ(told->front().text,
            "string<=10 text\nmy_msgs/LabelPart[<=4] parts\ngeometry_msgs/Point[2] places\nfloat64[] all\n")
      << "the text of the node is of another type";
  const testing::TemporaryFiles folder;
  for (const InterfaceFile& file : *told)
    folder.write(file.path, file.text);
  InterfaceLibrary again({folder.folder()});
  EXPECT_EQ(type_hash(again, "my_msgs/msg/Label"), hash);
}

TEST_F(ToldInterfaces, HaveConstantsAndDefaultsWhereTheNodeHasTheText) {
  const auto told = told_interface(answer(kText), "my_msgs/msg/Label", hash);
  ASSERT_TRUE(told) << to_string(told.error());
  EXPECT_EQ(told->front().text, kText);
}

TEST_F(ToldInterfaces, ThatAreNotOfTheHashAreRefused) {
  const std::string other = "RIHS01_" + std::string(64, '0');
  EXPECT_THAT(told_interface(answer(""), "my_msgs/msg/Label", other).error().message,
              HasSubstr("what the node tells is another type"));
  EXPECT_THAT(told_interface(answer(""), "my_msgs/msg/Other", hash).error().message,
              HasSubstr("what the node tells is another type"));
}

TEST_F(ToldInterfaces, ThatAreMalformedAreRefused) {
  const auto error = [&](const std::string& name, int type_id) {
    Value response = answer("");
    type::ValueMap& told = response.as_map()["type_description"].as_map()["type_description"].as_map();
    told["type_name"] = name;
    told["fields"].as_list().front().as_map()["type"].as_map()["type_id"] = type_id;
    return told_interface(response, name, hash).error().message;
  };
  EXPECT_THAT(error("../../msg/Label", 4), HasSubstr("is not a valid name of a message"));
  EXPECT_THAT(error("my_msgs/Label", 4), HasSubstr("is not a valid name of a message"))
      << "it is a short form";
  EXPECT_THAT(error("my_msgs/msg/Label", 13),
              HasSubstr("field 'text' of my_msgs/msg/Label is not one of a .msg file"));
  EXPECT_THAT(error("my_msgs/msg/Label", 1), HasSubstr("field 'text'")) << "without the name of a message";
  Value refuses = answer("");
  refuses.as_map()["successful"] = false;
  refuses.as_map()["failure_reason"] = "Type not currently in use by this node";
  EXPECT_THAT(told_interface(refuses, "my_msgs/msg/Label", hash).error().message,
              HasSubstr("not currently in use"));
}

}  // namespace
}  // namespace segue::ros2
