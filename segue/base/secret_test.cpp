// SPDX-License-Identifier: Apache-2.0
#include <segue/base/secret.hpp>

#include <gtest/gtest.h>

namespace segue {
namespace {

TEST(Secret, IsComparedAsAWhole) {
  EXPECT_TRUE(equal_secrets("abc", "abc"));
  EXPECT_FALSE(equal_secrets("abc", "abd"));
  EXPECT_FALSE(equal_secrets("abc", "ab"));
}

TEST(Secret, IsAnotherOneEachTime) {
  EXPECT_EQ(random_secret().size(), 64U);
  EXPECT_NE(random_secret(), random_secret());
}

}  // namespace
}  // namespace segue
