// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/temporary_files.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <optional>
#include <string>

/// Reports of missions of the robot's units.
namespace segue::runtime {
namespace {

using ::testing::HasSubstr;
using type::Value;

/// One execution of the run, which uses up some screws.
Value drilled(const std::string& run, const std::string& execution, int screws) {
  return Value::map({{"run", run},
                     {"changes", Value::list({Value::map({{"execution", execution},
                                                          {"units", Value::map({{"screws", -screws}})}})})}});
}

class UnitReports : public ::testing::Test {
 protected:
  UnitReports() { begin_runtime(); }

  /// Also after the one before has failed.
  void begin_runtime() {
    service_.reset();
    robot_.reset();
    RuntimeOptions options;
    options.journal = folder_ / "journal.sqlite";
    options.units = {{"screws", 40}};
    robot_.emplace(std::move(options));
    service_.emplace(robot_->runtime, nullptr, [] {});
  }
  Result<void> report(std::uint64_t lease, Value units) {
    return service_->report(lease, Value::map({{"units", std::move(units)}}));
  }
  std::int64_t screws() {
    const auto units = service_->units();
    EXPECT_TRUE(units) << to_string(units.error());
    return units->as_list().at(0).find("count")->as_int();
  }

  segue::testing::TemporaryFiles files_;
  const std::filesystem::path folder_ = files_.folder();
  std::optional<testing::StandInRobot> robot_;
  std::optional<RuntimeService> service_;
};

TEST_F(UnitReports, CountOnceAlsoWithTheNextRuntime) {
  auto lease = service_->lease("mission a");
  const std::uint64_t number = (*lease)->number();
  ASSERT_TRUE(report(number, Value::map({{"run", "a"}, {"begun", Value::map({{"screws", 40}})}})));
  ASSERT_TRUE(report(number, drilled("a", "drill", 2)));
  ASSERT_TRUE(report(number, drilled("a", "drill", 2))) << "no answer came";
  EXPECT_EQ(screws(), 38);
  lease->reset();
  begin_runtime();
  EXPECT_EQ(screws(), 38);
  lease = service_->lease("mission a");
  ASSERT_TRUE(
      report((*lease)->number(), Value::map({{"run", "a"}, {"begun", Value::map({{"screws", 40}})}})));
  ASSERT_TRUE(report((*lease)->number(), drilled("a", "drill", 2)));
  ASSERT_TRUE(report((*lease)->number(), drilled("a", "drill_again", 3)));
  EXPECT_EQ(screws(), 35);
  lease->reset();
}

TEST_F(UnitReports, CountOnlyFromWhoeverCommandsTheRobot) {
  EXPECT_EQ(report(0, drilled("a", "drill", 2)).error().code, ErrorCode::InvalidState);
  auto lease = service_->lease("mission a");
  const std::uint64_t number = (*lease)->number();
  EXPECT_EQ(report(number + 1, drilled("a", "drill", 2)).error().code, ErrorCode::InvalidState);
  const auto refused = service_->set_units("screws", 7, "ann");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_THAT(refused.error().message,
              HasSubstr("the robot is commanded by mission a, which goes by the counts"));
  EXPECT_EQ(screws(), 40);
  lease->reset();
  EXPECT_EQ(report(number, drilled("a", "drill", 2)).error().code, ErrorCode::InvalidState)
      << "it has lost it";
  EXPECT_EQ(service_->set_units("screws", 7, "ann").value(), 40U);
  EXPECT_EQ(screws(), 7);
  const auto events = robot_->runtime.events(0, {});
  EXPECT_EQ(events.back().kind, EventKind::Units);
  EXPECT_EQ(events.back().message, "ann set it from 40 to 7");
  EXPECT_EQ(service_->set_units("nuts", 7, "ann").error().code, ErrorCode::NotFound);
}

TEST_F(UnitReports, LeaveWhatTheMissionHasSaidOfItself) {
  auto lease = service_->lease("mission a");
  const std::uint64_t number = (*lease)->number();
  const Value doing = Value::map({{"mission", "a"}, {"state", "running"}});
  ASSERT_TRUE(service_->report(number, doing));
  ASSERT_TRUE(report(number, drilled("a", "drill", 2)));
  EXPECT_EQ(robot_->runtime.served().reported(), doing);
  Value both = doing;
  both.as_map().set("units", drilled("a", "drill_again", 2));
  ASSERT_TRUE(service_->report(number, both));
  EXPECT_EQ(robot_->runtime.served().reported(), doing) << "status does not have it";
  EXPECT_EQ(screws(), 36);
  lease->reset();
}

TEST_F(UnitReports, AreRefusedWhereTheyAreMalformed) {
  auto lease = service_->lease("mission a");
  const std::uint64_t number = (*lease)->number();
  const auto code_of = [&](Value units) { return report(number, std::move(units)).error().code; };
  EXPECT_EQ(code_of(Value("screws")), ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(drilled("", "drill", 2)), ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(drilled("a", "", 2)), ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(drilled("a", std::string(100'000, 'a'), 2)), ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(Value::map({{"run", "a"}, {"changes", "all"}})), ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(Value::map({{"run", "a"}, {"begun", Value::map({{"screws", -1}})}})),
            ErrorCode::InvalidArgument);
  EXPECT_EQ(code_of(Value::map({{"run", "a"}, {"begun", Value::map({{"nuts", 1}})}})), ErrorCode::NotFound);
  EXPECT_EQ(screws(), 40);
  lease->reset();
}

}  // namespace
}  // namespace segue::runtime
