// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/ros2/type_hash.hpp>

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <sstream>

#include "support/paths.hpp"
#include "support/temporary_files.hpp"

namespace segue::ros2 {
namespace {

using ::testing::HasSubstr;

std::string hash_of(const std::string& name) {
  InterfaceLibrary library;
  const auto hash = type_hash(library, name);
  return hash ? *hash : to_string(hash.error());
}

/// The hashes that rosidl gives, by name.
std::map<std::string, std::string> known_hashes() {
  const auto text = read_file(paths::in_sources("/segue/ros2/test_data/type_hashes.txt"));
  EXPECT_TRUE(text);
  std::map<std::string, std::string> hashes;
  std::istringstream lines(text ? *text : "");
  for (std::string line; std::getline(lines, line);) {
    const auto space = line.find(' ');
    if (!line.starts_with('#')) hashes.emplace(line.substr(0, space), "RIHS01_" + line.substr(space + 1));
  }
  return hashes;
}

TEST(TypeHash, IsThatOfRosidlForEveryStandardInterface) {
  InterfaceLibrary library;
  std::set<std::string> judged;
  for (const auto& [name, known] : known_hashes()) {
    if (name.starts_with("example_interfaces/")) continue;
    const auto hash = type_hash(library, name);
    ASSERT_TRUE(hash) << to_string(hash.error());
    EXPECT_EQ(*hash, known) << name;
    judged.insert(name);
  }
  for (const std::string& name : library.names())
    EXPECT_TRUE(judged.contains(name)) << name << " is judged by no hash";
  EXPECT_GT(judged.size(), 200U);
}

/// All parts of an action, down to the events of its services.
TEST(TypeHash, IsThatOfRosidlForAnAction) {
  const testing::TemporaryFiles folder;
  folder.write("example_interfaces/action/Fibonacci.action",
               "# Goal\nint32 order\n---\n# Result\nint32[] sequence\n---\n# Feedback\nint32[] sequence\n");
  InterfaceLibrary library({folder.folder()});
  std::size_t judged = 0;
  for (const auto& [name, known] : known_hashes()) {
    if (!name.starts_with("example_interfaces/")) continue;
    const auto hash = type_hash(library, name);
    ASSERT_TRUE(hash) << to_string(hash.error());
    EXPECT_EQ(*hash, known) << name;
    ++judged;
  }
  EXPECT_EQ(judged, 13U);
}

TEST(TypeHash, CoversTheWholeDescription) {
  InterfaceLibrary library;
  EXPECT_EQ(
      *type_description(library, "std_msgs/msg/String"),
      R"({"type_description": {"type_name": "std_msgs/msg/String", "fields": [{"name": "data", "type": )"
      R"({"type_id": 17, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}}]}, )"
      R"("referenced_type_descriptions": []})");
  EXPECT_EQ(hash_of("std_msgs/String"), hash_of("std_msgs/msg/String")) << "the short name of a message";
}

TEST(TypeHash, NeedsAllPartsOfTheInterface) {
  EXPECT_THAT(hash_of("geometry_msgs/msg/Pos"), HasSubstr("did you mean 'geometry_msgs/msg/Pose'?"));
  EXPECT_THAT(hash_of("Pose"), HasSubstr("'Pose' is not a valid name of an interface of ROS 2"));
  const testing::TemporaryFiles folder;
  folder.write("a/msg/Bad.msg", "Missing part\n");
  folder.write("a/msg/Loop.msg", "Back[] back\n");
  folder.write("a/msg/Back.msg", "Loop loop\n");
  folder.write("a/msg/Outer.msg", "Loop loop\n");
  InterfaceLibrary library({folder.folder()});
  EXPECT_THAT(to_string(type_hash(library, "a/msg/Bad").error()),
              HasSubstr("field 'part' of a/msg/Bad cannot be used (no interface 'a/msg/Missing'"));
  EXPECT_THAT(to_string(type_hash(library, "a/msg/Outer").error()),
              HasSubstr("field 'loop' of a/msg/Back makes a/msg/Loop contain itself"));
}

TEST(InterfaceLibrary, ReadsFoldersBeforeWhatIsBuiltIn) {
  const testing::TemporaryFiles folder;
  folder.write("share/std_msgs/msg/String.msg", "string data\nint32 number\n");
  folder.write("share/my_msgs/srv/Ask.srv", "---\nbool answer\n");
  InterfaceLibrary library({folder.folder() / "nowhere", folder.folder()});
  EXPECT_EQ((*library.find("std_msgs/msg/String"))->fields.size(), 2U);
  const auto request = library.find("my_msgs/srv/Ask_Request");
  ASSERT_TRUE(request) << to_string(request.error());
  EXPECT_EQ((*request)->fields.at(0).name, "structure_needs_at_least_one_member");
  EXPECT_FALSE(library.find("my_msgs/srv/Ask_Answer"));
  EXPECT_THAT(library.names(), ::testing::Contains("my_msgs/srv/Ask"));
}

TEST(InterfaceLibrary, SaysWhereAFileIsWrong) {
  const testing::TemporaryFiles folder;
  folder.write("a/msg/Bad.msg", "int32 x\nint33 y\n");
  InterfaceLibrary library({folder.folder()});
  EXPECT_THAT(to_string(library.find("a/msg/Bad").error()),
              HasSubstr("a/msg/Bad.msg:2:1: 'int33' is not a valid type"));
}

}  // namespace
}  // namespace segue::ros2
