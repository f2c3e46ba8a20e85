// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/told_interface.hpp>

#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/type_hash.hpp>
#include <segue/ros2/used_interfaces.hpp>

#include <gmock/gmock.h>

#include "support/temporary_files.hpp"

namespace segue::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
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

class ToldInterface : public ::testing::Test {
 protected:
  ToldInterface() {
    files.write("my_msgs/msg/Label.msg", kText);
    files.write("my_msgs/msg/LabelPart.msg", "");
    files.write("my_msgs/srv/Ask.srv", kService);
    files.write("my_msgs/action/Dock.action", kAction);
    library = InterfaceLibrary({files.folder()});
  }
  std::string hash(const std::string& type) { return type_hash(library, type).value(); }
  /// As a node with these files answers.
  Value answer(const std::string& type, Value::List sources = {}) {
    const auto messages = library.with_parts(type).value();
    Value::List parts;
    for (std::size_t i = 1; i < messages.size(); ++i)
      parts.push_back(described(*messages[i]));
    return Value::map(
        {{"successful", true},
         {"failure_reason", ""},
         {"type_description", Value::map({{"type_description", described(*messages.front())},
                                          {"referenced_type_descriptions", Value(std::move(parts))}})},
         {"type_sources", Value(std::move(sources))}});
  }
  static Value source(const std::string& type, const std::string& encoding, const std::string& text) {
    return Value::map({{"type_name", type}, {"encoding", encoding}, {"raw_file_contents", text}});
  }
  std::string error_of(const Value& response, const std::string& type) {
    ToldInterfaces told;
    if (auto added = told.add(response, type); !added) return added.error().message;
    const auto made = told.files(type, {{type, hash(type)}});
    return made ? std::string() : made.error().message;
  }
  /// The text of that file; all of them together have the hash.
  std::string text_of(const ToldInterfaces& told, const std::string& interface, const TypeHashes& hashes) {
    const auto made = told.files(interface, hashes);
    EXPECT_TRUE(made) << to_string(made.error());
    if (!made) return {};
    const testing::TemporaryFiles folder;
    std::string text;
    for (const InterfaceFile& file : *made) {
      folder.write(file.path, file.text);
      if (file.path.starts_with(interface + ".")) text = file.text;
    }
    InterfaceLibrary again({folder.folder()});
    EXPECT_EQ(type_hash(again, interface).value_or("none"), hash(interface));
    return text;
  }

  static constexpr const char* kService = "int32 LIMIT=3\nLabel[] labels\n---\n";
  static constexpr const char* kAction =
      "geometry_msgs/Pose pose\n---\nbool docked false\n---\nLabelPart part\n";
  testing::TemporaryFiles files;
  InterfaceLibrary library;
};

TEST_F(ToldInterface, IsFilesOfTheSameHash) {
  ToldInterfaces told;
  ASSERT_TRUE(told.add(answer("my_msgs/msg/Label", {source("my_msgs/msg/Label", "msg", "int8 another\n")}),
                       "my_msgs/msg/Label"));
  EXPECT_EQ(text_of(told, "my_msgs/msg/Label", {{"my_msgs/msg/Label", hash("my_msgs/msg/Label")}}),
            "string<=10 text\nmy_msgs/LabelPart[<=4] parts\ngeometry_msgs/Point[2] places\nfloat64[] all\n")
      << "the text of the node is of another type";
  EXPECT_EQ(told.files("my_msgs/msg/Label", {{"my_msgs/msg/Label", hash("my_msgs/msg/Label")}})->size(), 2U)
      << "Point is built in";
}

TEST_F(ToldInterface, HasConstantsAndDefaultsWhereTheNodeHasTheText) {
  ToldInterfaces told;
  ASSERT_TRUE(told.add(answer("my_msgs/msg/Label", {source("my_msgs/msg/Label", "msg", kText)}),
                       "my_msgs/msg/Label"));
  EXPECT_EQ(text_of(told, "my_msgs/msg/Label", {{"my_msgs/msg/Label", hash("my_msgs/msg/Label")}}), kText);
}

TEST_F(ToldInterface, IsAService) {
  const TypeHashes hashes = {{"my_msgs/srv/Ask", hash("my_msgs/srv/Ask")},
                             {"my_msgs/srv/Ask_Request", hash("my_msgs/srv/Ask_Request")}};
  ToldInterfaces told;
  ASSERT_TRUE(told.add(answer("my_msgs/srv/Ask"), "my_msgs/srv/Ask"));
  EXPECT_EQ(text_of(told, "my_msgs/srv/Ask", hashes), "my_msgs/Label[] labels\n---\n");
  ToldInterfaces with_source;
  ASSERT_TRUE(with_source.add(answer("my_msgs/srv/Ask", {source("my_msgs/srv/Ask", "srv", kService)}),
                              "my_msgs/srv/Ask"));
  EXPECT_EQ(text_of(with_source, "my_msgs/srv/Ask", hashes), kService);
}

TEST_F(ToldInterface, IsAServiceOfWhichOnlyTheEventsAreTold) {
  ToldInterfaces told;
  ASSERT_TRUE(told.add(answer("my_msgs/srv/Ask_Event"), "my_msgs/srv/Ask_Event"));
  EXPECT_EQ(text_of(told, "my_msgs/srv/Ask",
                    {{"my_msgs/srv/Ask_Event", hash("my_msgs/srv/Ask_Event")},
                     {"my_msgs/srv/Ask_Response", hash("my_msgs/srv/Ask_Response")}}),
            "my_msgs/Label[] labels\n---\n");
}

TEST_F(ToldInterface, IsAnActionOfItsParts) {
  ToldInterfaces told;
  TypeHashes hashes;
  for (const char* part : {"_SendGoal", "_GetResult"}) {
    const std::string type = "my_msgs/action/Dock" + std::string(part);
    ASSERT_TRUE(told.add(answer(type), type));
    hashes[type] = hash(type);
  }
  EXPECT_THAT(told.files("my_msgs/action/Dock", hashes).error().message,
              HasSubstr("the node does not tell my_msgs/action/Dock_Feedback"));
  const std::string feedback = "my_msgs/action/Dock_FeedbackMessage";
  ASSERT_TRUE(told.add(answer(feedback), feedback));
  hashes[feedback] = hash(feedback);
  EXPECT_EQ(text_of(told, "my_msgs/action/Dock", hashes),
            "geometry_msgs/Pose pose\n---\nbool docked\n---\nmy_msgs/LabelPart part\n");
}

TEST_F(ToldInterface, ThatIsNotOfAHashIsRefused) {
  const std::string other = "RIHS01_" + std::string(64, '0');
  ToldInterfaces told;
  ASSERT_TRUE(told.add(answer("my_msgs/srv/Ask"), "my_msgs/srv/Ask"));
  const auto error = [&](const TypeHashes& hashes) {
    return told.files("my_msgs/srv/Ask", hashes).error().message;
  };
  EXPECT_THAT(error({{"my_msgs/srv/Ask", other}}), HasSubstr("of my_msgs/srv/Ask is another type"));
  EXPECT_THAT(error({{"my_msgs/srv/Ask", hash("my_msgs/srv/Ask")}, {"my_msgs/srv/Ask_Response", other}}),
              HasSubstr("what the node tells of my_msgs/srv/Ask_Response is another type"))
      << "that of the endpoint";
  EXPECT_THAT(error({}), HasSubstr("the node does not tell its hash"));
  EXPECT_THAT(told.files("my_msgs/msg/Other", {{"my_msgs/msg/Other", other}}).error().message,
              HasSubstr("the node does not tell my_msgs/msg/Other"));
}

TEST_F(ToldInterface, ThatIsMalformedIsRefused) {
  const auto error = [&](const std::string& name, int type_id, const std::string& nested = "") {
    Value response = answer("my_msgs/msg/Label");
    type::ValueMap& told = response.as_map()["type_description"].as_map()["type_description"].as_map();
    told["type_name"] = name;
    type::ValueMap& type = told["fields"].as_list().front().as_map()["type"].as_map();
    type["type_id"] = type_id;
    type["nested_type_name"] = nested;
    if (!nested.empty()) type["string_capacity"] = 0;
    return error_of(response, "my_msgs/msg/Label");
  };
  EXPECT_THAT(error("../../msg/Label", 4), HasSubstr("is not a valid name of an interface"));
  EXPECT_THAT(error("my_msgs/Label", 4), HasSubstr("is not a valid name of an interface"))
      << "it is a short form";
  EXPECT_THAT(error("my_msgs/msg/Label", 13),
              HasSubstr("field 'text' of my_msgs/msg/Label is not one of a .msg file"));
  EXPECT_THAT(error("my_msgs/msg/Label", 1), HasSubstr("field 'text'")) << "without the name of a message";
  EXPECT_THAT(error("my_msgs/msg/Label", 1, "my_msgs/srv/Ask_Request"),
              HasSubstr("the node does not tell my_msgs/srv/Ask_Request"))
      << "a message cannot have a part of a service";
  EXPECT_THAT(error("my_msgs/msg/Label", 1, "my_msgs/msg/Label"), HasSubstr("contain itself"));
  Value refuses = answer("my_msgs/msg/Label");
  refuses.as_map()["successful"] = false;
  refuses.as_map()["failure_reason"] = "Type not currently in use by this node";
  EXPECT_THAT(error_of(refuses, "my_msgs/msg/Label"), HasSubstr("not currently in use"));
}

TEST(UsedInterfaces, HaveTheHashesOfAllTheirEndpoints) {
  const auto topic = [](const std::string& type, const std::string& hash) {
    return Value::map({{"type", type}, {"hash", hash}});
  };
  const Value none(Value::List{});
  const Value node = Value::map(
      {{"publishers", Value::list({topic("a/msg/M", "h1"), topic("a/srv/S_Event", "h2")})},
       {"subscriptions", Value::list({topic("a/msg/Old", "")})},
       {"services", Value::list({Value::map(
                        {{"type", "a/srv/S"}, {"hashes", Value::map({{"a/srv/S_Request", "h3"}})}})})},
       {"clients", Value::list({Value::map({{"type", "a/srv/T"}})})},
       {"actions", none},
       {"action_clients", none}});
  const std::map<std::string, TypeHashes> expected = {
      {"a/msg/M", {{"a/msg/M", "h1"}}},
      {"a/msg/Old", {}},
      {"a/srv/S", {{"a/srv/S_Event", "h2"}, {"a/srv/S_Request", "h3"}}},
      {"a/srv/T", {}}};
  EXPECT_EQ(used_interfaces(node), expected);
}

TEST(UsedInterfaces, AreAskedForByThePartsThatDescribeThem) {
  EXPECT_THAT(parts_to_ask("a/msg/M", {{"a/msg/M", "h"}}), ElementsAre("a/msg/M"));
  TypeHashes service = {{"a/srv/S_Request", "h"}, {"a/srv/S_Response", "h"}};
  EXPECT_THAT(parts_to_ask("a/srv/S", service), IsEmpty());
  service["a/srv/S_Event"] = "h";
  EXPECT_THAT(parts_to_ask("a/srv/S", service), ElementsAre("a/srv/S_Event"));
  service["a/srv/S"] = "h";
  EXPECT_THAT(parts_to_ask("a/srv/S", service), ElementsAre("a/srv/S"));
  TypeHashes action = {{"a/action/A_FeedbackMessage", "h"}, {"a/action/A_SendGoal", "h"}};
  EXPECT_THAT(parts_to_ask("a/action/A", action), IsEmpty());
  action["a/action/A_GetResult"] = "h";
  EXPECT_THAT(parts_to_ask("a/action/A", action).size(), 3U);
}

}  // namespace
}  // namespace segue::ros2
