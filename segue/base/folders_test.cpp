// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>

#include <support/environment_variable.hpp>

#include <gmock/gmock.h>
#include <unistd.h>

namespace segue {
namespace {

using testing::EnvironmentVariable;

TEST(ConfigurationFolder, IsTheOneThatIsNamed) {
  const EnvironmentVariable named("XDG_CONFIG_HOME", "/somewhere");
  EXPECT_EQ(configuration_folder().value(), "/somewhere/segue");
}

TEST(ConfigurationFolder, IsThatOfTheUserWhereNoneIsNamed) {
  const EnvironmentVariable home("HOME", "/home/ann");
  for (const char* none : {"", "relative"}) {
    const EnvironmentVariable named("XDG_CONFIG_HOME", none);
    EXPECT_EQ(configuration_folder().value(), ::geteuid() == 0 ? "/etc/segue" : "/home/ann/.config/segue");
  }
}

}  // namespace
}  // namespace segue
