// SPDX-License-Identifier: Apache-2.0
#include <segue/base/secret.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <set>

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

TEST(Secret, NumbersAreRandomAndNeverNull) {
  std::set<std::uint64_t> seen;
  for (int i = 0; i < 1000; ++i)
    seen.insert(random_number());
  EXPECT_EQ(seen.size(), 1000U);
  EXPECT_FALSE(seen.contains(0));
  EXPECT_GT(*seen.rbegin(), std::uint64_t{1} << 48U) << "all bits are random";
}

}  // namespace
}  // namespace segue
