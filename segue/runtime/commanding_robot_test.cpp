// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <gmock/gmock.h>

#include <string>

/// Several controllers at once, variants of controllers, and leases.
namespace segue::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kDriving = R"(
network: drive
tasks: {base: {component: x::Base, properties: {gain: 1}}, follower: {component: x::Follower}}
connections: [follower.command -> base.command]
)";
constexpr const char* kWorking = R"(
network: arm
tasks: {base: {component: x::Base, properties: {gain: 1}}, arm: {component: x::Arm}}
connections: [base.pose -> arm.base]
)";
constexpr const char* kSteering = R"(
network: stick
tasks: {base: {component: x::Base, properties: {gain: 1}}, stick: {component: x::Stick}}
connections: [stick.command -> base.command]
)";

class CommandedRuntime : public ::testing::Test {
 protected:
  CommandedRuntime() {
    for (const char* text : {kDriving, kWorking, kSteering})
      EXPECT_FALSE(runtime_.add_controller(testing::network_of(text)).has_errors());
  }
  SwitchResult switch_to(const char* name, RequestOptions options = {}) {
    return runtime_.switch_to(model::NetworkName(name), std::move(options));
  }

  testing::StandInRobot robot_;
  Runtime& runtime_ = robot_.runtime;
};

TEST_F(CommandedRuntime, RunsTheUnionOfControllersAndGoesFromOneToAnother) {
  EXPECT_EQ(switch_to("drive").outcome, Outcome::Done);
  const auto both = switch_to("drive+arm");
  EXPECT_EQ(both.outcome, Outcome::Done) << both.why();
  EXPECT_EQ(both.to.str(), "arm+drive");
  EXPECT_EQ(runtime_.belief().name.str(), "arm+drive");
  EXPECT_THAT(runtime_.belief().tasks, SizeIs(3));
  for (const auto& record : both.actions)
    EXPECT_THAT(record.action.label(), ::testing::Not(HasSubstr("follower"))) << "what both have runs on";
  EXPECT_EQ(switch_to("arm+drive").actions.size(), 0U) << "the order of the names does not matter";
  EXPECT_EQ(switch_to("arm").outcome, Outcome::Done);
  EXPECT_THAT(runtime_.belief().tasks, SizeIs(2));
  EXPECT_THAT(runtime_.observed_differences(), IsEmpty());
}

TEST_F(CommandedRuntime, RefusesControllersThatCannotRunAtOnce) {
  EXPECT_EQ(switch_to("drive").outcome, Outcome::Done);
  const auto refused = switch_to("drive+stick");
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_THAT(refused.why(), HasSubstr("these controllers cannot run at once: input 'base.command'"));
  EXPECT_THAT(switch_to("drive+amr").why(), HasSubstr("no controller 'amr', did you mean 'arm'?"));
  EXPECT_EQ(runtime_.belief().name.str(), "drive");
}

TEST_F(CommandedRuntime, SaysWhatKeepsControllersApart) {
  const auto all = runtime_.served().conflicts(runtime_.controllers());
  ASSERT_TRUE(all);
  std::vector<std::string> found;
  for (const auto& one : *all)
    found.push_back(one.a.str() + (one.influence ? " influences " : " or ") + one.b.str() + ": " +
                    one.conflict.what);
  EXPECT_THAT(found, ::testing::UnorderedElementsAre("drive or stick: input base.command",
                                                     "drive influences arm: input base.command",
                                                     "stick influences arm: input base.command",
                                                     "drive influences stick: input base.command",
                                                     "stick influences drive: input base.command"));
  EXPECT_EQ(runtime_.served().conflicts({model::NetworkName("amr")}).error().code, ErrorCode::NotFound);
}

TEST_F(CommandedRuntime, RecognisesAUnionThatRunsAlready) {
  EXPECT_EQ(switch_to("drive+arm").outcome, Outcome::Done);
  runtime_.reset_belief();
  EXPECT_EQ(runtime_.belief().name.str(), "arm+drive");
}

TEST_F(CommandedRuntime, PreparesUnions) {
  const auto ready = runtime_.prepare({model::NetworkName("arm+drive")}).get();
  ASSERT_THAT(ready, SizeIs(1));
  EXPECT_TRUE(ready.front().ready) << ready.front().reason;
  EXPECT_EQ(ready.front().tasks, 3U);
}

TEST_F(CommandedRuntime, TakesNoControllerWhoseNameJoinsOthers) {
  model::Network network;
  network.name = model::NetworkName("a+b");
  const auto findings = runtime_.add_controller(network);
  EXPECT_TRUE(findings.has_errors());
}

TEST_F(CommandedRuntime, RunsAVariantUntilTheNextRequest) {
  RequestOptions options;
  options.properties = {{model::TaskId("base"), "gain", type::Value(2)}};
  const auto variant = switch_to("drive", options);
  EXPECT_EQ(variant.outcome, Outcome::Done) << variant.why();
  EXPECT_EQ(*runtime_.belief().find_task(model::TaskId("base"))->properties.find("gain"), type::Value(2));
  EXPECT_THAT(runtime_.observed_differences(), IsEmpty()) << "a variant is not drift";
  EXPECT_EQ(switch_to("drive", options).actions.size(), 0U);
  EXPECT_EQ(switch_to("drive").outcome, Outcome::Done);
  EXPECT_EQ(*runtime_.belief().find_task(model::TaskId("base"))->properties.find("gain"), type::Value(1));
}

TEST_F(CommandedRuntime, RefusesAVariantThatIsNone) {
  RequestOptions options;
  options.properties = {{model::TaskId("bse"), "gain", type::Value(2)}};
  EXPECT_THAT(switch_to("drive", options).why(),
              HasSubstr("'drive' has no task 'bse', did you mean 'base'?"));
  options.properties = {{model::TaskId("base"), "gain.max", type::Value(2)}};
  EXPECT_THAT(switch_to("drive", options).why(),
              HasSubstr("property 'gain' of task 'base' is not known to have 'gain.max'"));
}

TEST_F(CommandedRuntime, SetsAMemberOfAProperty) {
  auto network =
      testing::network_of("network: n\ntasks: {a: {component: x::A, properties: {p: {x: 1, y: 2}}}}");
  EXPECT_FALSE(runtime_.add_controller(network).has_errors());
  RequestOptions options;
  options.properties = {{model::TaskId("a"), "p.y", type::Value(3)}};
  EXPECT_EQ(switch_to("n", options).outcome, Outcome::Done);
  EXPECT_EQ(*runtime_.belief().find_task(model::TaskId("a"))->properties.find("p"),
            type::Value::map({{"x", 1}, {"y", 3}}));
}

TEST_F(CommandedRuntime, HeedsOnlyTheHolderOfTheLease) {
  const auto lease = runtime_.served().take_lease("mission patrol");
  ASSERT_TRUE(lease);
  EXPECT_THAT(to_string(runtime_.served().take_lease("another").error()),
              HasSubstr("the robot is commanded by mission patrol"));
  const auto refused = switch_to("drive");
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_THAT(refused.why(), HasSubstr("the robot is commanded by mission patrol"));
  RequestOptions mine;
  mine.lease = *lease;
  EXPECT_EQ(switch_to("drive", mine).outcome, Outcome::Done);
  const auto files = runtime_.apply({}).get();
  EXPECT_EQ(files.outcome, Outcome::Refused);
  runtime_.served().end_lease(*lease);
  EXPECT_EQ(switch_to("arm").outcome, Outcome::Done);
  EXPECT_EQ(runtime_.served().lease_holder(), std::nullopt);
}

TEST_F(CommandedRuntime, CanBeTakenOver) {
  RequestOptions mine;
  mine.lease = *runtime_.served().take_lease("mission patrol");
  EXPECT_EQ(switch_to("drive", mine).outcome, Outcome::Done);
  RequestOptions theirs;
  theirs.take_over = true;
  theirs.who = "segue switch";
  EXPECT_EQ(switch_to("arm", theirs).outcome, Outcome::Done);
  EXPECT_EQ(runtime_.served().lease_standing(mine.lease).lost_to, "segue switch");
  const auto late = switch_to("drive", mine);
  EXPECT_EQ(late.outcome, Outcome::Refused);
  EXPECT_THAT(late.why(), HasSubstr("the robot was taken over by segue switch"));
  EXPECT_EQ(switch_to("drive").outcome, Outcome::Done) << "nobody holds it now";
  const auto next = runtime_.served().take_lease("mission again");
  EXPECT_EQ(runtime_.served().lease_standing(*next).lost_to, std::nullopt);
  EXPECT_EQ(runtime_.served().lease_standing(mine.lease).lost_to, "segue switch");
}

TEST_F(CommandedRuntime, TellsItsHolderWhatOthersWant) {
  EXPECT_EQ(runtime_.served().send_command("pause").error().code, ErrorCode::NotFound);
  const auto lease = *runtime_.served().take_lease("mission patrol");
  EXPECT_EQ(runtime_.served().send_command("dance").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(*runtime_.served().send_command("pause"), 1U);
  EXPECT_EQ(*runtime_.served().send_command("resume"), 2U);
  EXPECT_THAT(runtime_.served().take_commands(lease), ElementsAre(control::HolderRequest{2, "resume", {}}))
      << "the latest counts";
  EXPECT_THAT(runtime_.served().take_commands(lease), IsEmpty());
  EXPECT_TRUE(runtime_.served().report(lease, "driving"));
  EXPECT_EQ(runtime_.served().reported(), type::Value("driving"));
  runtime_.served().end_lease(lease);
  EXPECT_TRUE(runtime_.served().reported().is_null());
  EXPECT_EQ(runtime_.served().report(lease, "driving").error().code, ErrorCode::InvalidState);
}

TEST_F(CommandedRuntime, ARefusedRequestDisturbsNoneThatIsUnderWay) {
  RequestOptions mine;
  mine.lease = *runtime_.served().take_lease("mission patrol");
  auto under_way = runtime_.request(model::NetworkName("drive"), mine);
  EXPECT_EQ(switch_to("arm").outcome, Outcome::Refused);
  EXPECT_EQ(under_way.get().outcome, Outcome::Done);
}

TEST_F(CommandedRuntime, EndsALeaseWithItsService) {
  RuntimeService service(runtime_, nullptr, [] {});
  auto lease = service.lease("a test");
  ASSERT_TRUE(lease);
  EXPECT_EQ(service.status()->find("commanded_by")->as_string(), "a test");
  EXPECT_EQ((*lease)->standing()->lost_to, std::nullopt);
  lease->reset();
  EXPECT_TRUE(service.status()->find("commanded_by")->is_null());
}

}  // namespace
}  // namespace segue::runtime
