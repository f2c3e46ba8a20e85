// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/stored_units.hpp>

#include <support/temporary_files.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace segue::journal {
namespace {

using ::testing::HasSubstr;

Result<void> permitted() {
  return {};
}

class StoredUnitsTest : public ::testing::Test {
 protected:
  /// As another runtime of the same robot finds them.
  [[nodiscard]] StoredUnits reopened(const std::string& robot = "rover", std::uint32_t screws = 40) const {
    return StoredUnits(folder_ / "state/units.sqlite", robot, {{"screws", screws}, {"place", 3}});
  }
  static StoredUnits::Counts of(StoredUnits units) {
    const auto counts = units.counts();
    EXPECT_TRUE(counts) << to_string(counts.error());
    return counts.value_or(StoredUnits::Counts());
  }

  segue::testing::TemporaryFiles files_;
  const std::filesystem::path folder_ = files_.folder();
};

TEST_F(StoredUnitsTest, CountEachExecutionOfARunOnce) {
  for (int runtime = 0; runtime < 3; ++runtime) {
    StoredUnits units = reopened();
    ASSERT_TRUE(units.change("a", {{"drill", {{"screws", -2}, {"place", 1}}}}, permitted));
    ASSERT_TRUE(units.change("a", {{"drill", {{"screws", -2}, {"place", 1}}}, {"drop", {{"screws", -1}}}},
                             permitted));
  }
  EXPECT_EQ(of(reopened()), (StoredUnits::Counts{{"screws", 37}, {"place", 4}}));
  ASSERT_TRUE(reopened().change("b", {{"drill", {{"screws", -2}}}}, permitted)) << "of another run";
  EXPECT_EQ(of(reopened()).at("screws"), 35U);
}

TEST_F(StoredUnitsTest, AreThoseOfTheRobotFileUntilTheyChange) {
  EXPECT_EQ(of(reopened("rover", 40)).at("screws"), 40U);
  EXPECT_EQ(of(reopened("rover", 50)).at("screws"), 50U);
  EXPECT_EQ(reopened("rover", 50).set("screws", 7, permitted).value(), 50U);
  EXPECT_EQ(of(reopened("rover", 60)).at("screws"), 7U);
  EXPECT_EQ(of(reopened("other", 60)).at("screws"), 60U) << "robots that share the file";
}

TEST_F(StoredUnitsTest, ChangeForNobodyWithoutAPermit) {
  const auto refused = [] { return Result<void>(fail(ErrorCode::InvalidState, "not yours")); };
  StoredUnits units = reopened();
  EXPECT_EQ(units.change("a", {{"drill", {{"screws", -2}}}}, refused).error().message, "not yours");
  EXPECT_EQ(units.begin("a", {{"screws", 40}}, refused).error().message, "not yours");
  EXPECT_EQ(units.set("screws", 1, refused).error().message, "not yours");
  EXPECT_EQ(of(reopened()).at("screws"), 40U);
  ASSERT_TRUE(units.change("a", {{"drill", {{"screws", -2}}}}, permitted)) << "it did not count before";
  EXPECT_EQ(of(reopened()).at("screws"), 38U);
}

TEST_F(StoredUnitsTest, ARunGoesOnOnlyWhereNobodyElseHasChangedThem) {
  StoredUnits units = reopened();
  ASSERT_TRUE(units.begin("a", {{"screws", 40}}, permitted));
  ASSERT_TRUE(units.change("a", {{"drill", {{"screws", -2}}}}, permitted));
  EXPECT_TRUE(units.begin("a", {{"screws", 40}, {"place", 3}}, permitted));
  ASSERT_TRUE(units.set("screws", 100, permitted));
  const auto other = units.begin("a", {{"screws", 40}}, permitted);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::InvalidState);
  EXPECT_THAT(other.error().message,
              HasSubstr("there are 100 units of the resource 'screws' now, and would be 38"));
  EXPECT_THAT(other.error().message, HasSubstr("`segue units set screws 38`"));
  ASSERT_TRUE(units.set("screws", 38, permitted));
  EXPECT_TRUE(units.begin("a", {{"screws", 40}}, permitted));
}

TEST_F(StoredUnitsTest, AreChangedByAllExecutionsOfAReportOrByNone) {
  StoredUnits units = reopened();
  const auto unknown = units.change("a", {{"drill", {{"screws", -2}}}, {"weld", {{"screw", 1}}}}, permitted);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::NotFound);
  EXPECT_THAT(unknown.error().message, HasSubstr("did you mean 'screws'"));
  EXPECT_EQ(of(reopened()).at("screws"), 40U);
  ASSERT_TRUE(units.change("a", {{"drill", {{"screws", -50}}}}, permitted));
  EXPECT_EQ(of(reopened()).at("screws"), 0U) << "never fewer than none";
  EXPECT_EQ(units.set("screw", 1, permitted).error().code, ErrorCode::NotFound);
}

TEST_F(StoredUnitsTest, SayWhereTheyCannotBeKept) {
  std::filesystem::create_directories(folder_ / "state");
  std::ofstream(folder_ / "state/units.sqlite")
      << "no database, whatever it is called, but a text of some length";
  StoredUnits units = reopened();
  const auto damaged = units.counts();
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("units.sqlite'"));
  std::filesystem::remove(folder_ / "state/units.sqlite");
  EXPECT_TRUE(units.counts()) << "it is tried anew";
  StoredUnits nowhere({}, "rover", {{"screws", 1}});
  EXPECT_EQ(nowhere.counts().error().code, ErrorCode::Unsupported);
  EXPECT_TRUE(StoredUnits({}, "rover", {}).counts()) << "there is nothing to keep";
}

}  // namespace
}  // namespace segue::journal
