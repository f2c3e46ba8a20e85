// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/component_plugins.hpp>

#include <gmock/gmock.h>

namespace segue::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ComponentPlugin plugin(const std::string& name) {
  return {"nav", name, "/opt/lib/" + name + ".so"};
}

std::vector<std::string> texts(const std::vector<FoundPlugin>& found) {
  std::vector<std::string> all;
  for (const FoundPlugin& one : found) {
    std::string text(to_string(one.evidence));
    for (const ComponentPlugin& each : one.plugins)
      text += " " + each.name;
    all.push_back(text);
  }
  return all;
}

TEST(ComponentIndex, HasALineForEachPlugin) {
  EXPECT_THAT(
      parse_component_index("nav", "nav::Planner;lib/libnav.so\n\nnav::Map;/ws/libmap.so\n", "/opt/ros"),
      ElementsAre(ComponentPlugin{"nav", "nav::Planner", "/opt/ros/lib/libnav.so"},
                  ComponentPlugin{"nav", "nav::Map", "/ws/libmap.so"}));
  EXPECT_THAT(parse_component_index("nav", "nav::Planner\n;lib/a.so\na;b;c\nnav::Map;\n", "/opt/ros"),
              IsEmpty());
}

TEST(ComponentPlugins, AreThoseOfAllComponentsWhereThereIsOnlyOne) {
  EXPECT_THAT(texts(find_plugins({"/left", "/right"}, {plugin("a::Camera")})),
              ElementsAre("only_one a::Camera", "only_one a::Camera"));
}

TEST(ComponentPlugins, HaveTheNamesOfTheirNodes) {
  EXPECT_THAT(
      texts(find_plugins({"/robot/planner_server", "/smoother"},
                         {plugin("nav::Smoother"), plugin("nav::PlannerServer"), plugin("nav::Map")})),
      ElementsAre("name nav::PlannerServer", "name nav::Smoother"));
}

TEST(ComponentPlugins, AreTheRemainingOneWhereAllOthersHaveNames) {
  EXPECT_THAT(
      texts(find_plugins({"/left", "/rectify", "/right"}, {plugin("a::Camera"), plugin("a::Rectify")})),
      ElementsAre("remaining a::Camera", "name a::Rectify", "remaining a::Camera"));
}

TEST(ComponentPlugins, AreNotKnownWhereThereAreSeveral) {
  EXPECT_THAT(texts(find_plugins({"/talker"}, {plugin("a::Talker"), plugin("b::Talker")})),
              ElementsAre(" a::Talker b::Talker"))
      << "two have its name";
  EXPECT_THAT(texts(find_plugins({"/left"}, {plugin("a::Camera"), plugin("a::Rectify")})),
              ElementsAre(" a::Camera a::Rectify"));
  EXPECT_THAT(texts(find_plugins({"/left"}, {})), ElementsAre(""));
}

}  // namespace
}  // namespace segue::ros2
