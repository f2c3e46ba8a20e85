// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/persistent_variables.hpp>
#include <support/temporary_files.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace segue::mission {
namespace {

bool text_uses_them(const std::string& text) {
  Action action;
  Script script;
  script.text = text;
  action.run = std::move(script);
  return uses_persistent_variables({}, action);
}

TEST(UsesPersistentVariables, WhereAScriptNamesThem) {
  EXPECT_TRUE(text_uses_them("n = self.persistent_variables['n']"));
  EXPECT_FALSE(text_uses_them("n = self.preemptive_wait(3) == inputs['n']"));
  EXPECT_FALSE(text_uses_them(""));
}

TEST(UsesPersistentVariables, WhereAScriptAssignsToAnAttributeOfSelf) {
  for (const char* text : {"self.n = 1", "self.n=1", "a = self.n \t= 1", "self.n += 1", "self.n //= 2",
                           "self.n **= 2", "self.n <<= 1", "x = self.m\nself.n = x", "self.n ="})
    EXPECT_TRUE(text_uses_them(text)) << text;
  for (const char* text : {"self.n == 1", "self.n", "self.", "myself.n = 1", "x = self.n + 1", "self.n <= 1",
                           "self.n(a=1)", "self.n != 1", "self.n[0] == 2"})
    EXPECT_FALSE(text_uses_them(text)) << text;
}

TEST(UsesPersistentVariables, OfAFileAsFarAsItCanBeRead) {
  const testing::TemporaryFiles files;
  Mission mission;
  mission.file = (files.folder() / "m.yaml").string();
  Action action;
  action.run = Script{"look.py", {}, false, {}};
  EXPECT_FALSE(uses_persistent_variables(mission, action));
  files.write("look.py", "self.persistent_variables");
  EXPECT_TRUE(uses_persistent_variables(mission, action));
}

TEST(UsesPersistentVariables, IsNothingThatOtherActionsDo) {
  Action action;
  action.run = Callback{"self.n = 1"};
  EXPECT_FALSE(uses_persistent_variables({}, action));
}

}  // namespace
}  // namespace segue::mission
