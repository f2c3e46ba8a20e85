// SPDX-License-Identifier: Apache-2.0
#include "paired_saving.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace segue::cli {
namespace {

TEST(PairedSaving, IsTheMeanOfThePairsWithStudentsInterval) {
  // Savings of 10, 20 and 30 %: mean 20 %, standard deviation 10 %, t(2) = 4.303.
  const std::vector<MeasuredPair> pairs = {{10, 9}, {100, 80}, {1, 0.7}};
  const PairedSaving saving = paired_saving(pairs);
  EXPECT_EQ(saving.pairs, 3);
  EXPECT_NEAR(saving.mean, 0.2, 1e-12);
  ASSERT_TRUE(saving.half_width);
  EXPECT_NEAR(*saving.half_width, 4.303 * 0.1 / 1.7320508, 1e-6);
}

TEST(PairedSaving, OfFewPairsHasNoInterval) {
  EXPECT_EQ(paired_saving({}).pairs, 0);
  const std::vector<MeasuredPair> one = {{2, 3}};
  EXPECT_NEAR(paired_saving(one).mean, -0.5, 1e-12);
  EXPECT_FALSE(paired_saving(one).half_width);
}

TEST(PairedSaving, OfEqualPairsIsCertain) {
  const std::vector<MeasuredPair> pairs(4, {4, 3});
  EXPECT_NEAR(paired_saving(pairs).mean, 0.25, 1e-12);
  EXPECT_NEAR(paired_saving(pairs).half_width.value(), 0, 1e-12);
}

TEST(PairedSaving, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_t_975(1), 12.706, 1e-3);
  EXPECT_NEAR(student_t_975(4), 2.776, 1e-3);
  EXPECT_NEAR(student_t_975(11), 2.201, 2e-3);
  EXPECT_NEAR(student_t_975(30), 2.042, 1e-3);
  EXPECT_NEAR(student_t_975(100'000), 1.960, 1e-3);
}

}  // namespace
}  // namespace segue::cli
