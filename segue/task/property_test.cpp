// SPDX-License-Identifier: Apache-2.0
#include <segue/task/probe_component.hpp>

#include <gmock/gmock.h>

#include <latch>
#include <thread>

namespace segue::task {
namespace {

using test::soon;
using ::testing::HasSubstr;
using type::Value;

using Properties = test::TaskTest;

TEST_F(Properties, TellTheirValues) {
  EXPECT_EQ(task->properties(),
            Value::map({{"gain", 1.5}, {"device", "/dev/x"}, {"limits", Value::list({1, 2})}}));
}

TEST_F(Properties, AllMayBeSetBeforeConfiguring) {
  ASSERT_TRUE(task->set_properties(Value::map({{"gain", 2}, {"device", "/dev/y"}}), soon()));
  EXPECT_EQ(*probe->gain, 2.0);
  EXPECT_EQ(probe->device.get(), "/dev/y");
}

TEST_F(Properties, OnlyLiveOnesMayBeSetOnceConfigured) {
  for (const TaskState state : {TaskState::Stopped, TaskState::Running, TaskState::RunTimeError}) {
    make({});
    bring_to(state);
    const Result<void> set = task->set_properties(Value::map({{"gain", 3}, {"device", "/dev/z"}}), soon());
    ASSERT_FALSE(set);
    EXPECT_EQ(set.error().code, ErrorCode::InvalidState);
    EXPECT_THAT(set.error().message, HasSubstr("'device'"));
    EXPECT_EQ(*probe->gain, 1.5) << "all or nothing";
    ASSERT_TRUE(task->set_properties(Value::map({{"gain", 3}}), soon()));
    EXPECT_EQ(*probe->gain, 3.0);
  }
}

/// Applies a live property to a device, which refuses negative values.
class Amplifier final : public Component {
 public:
  Amplifier() : Component(ComponentOptions{}) {}
  double applied = 0;
  const Property<double> gain{*this, "gain", 1.0, {.live = true, .on_live_set = [this](const Value& value) {
                                                     return apply(value.as_double());
                                                   }}};
  const Property<int> rate{*this, "rate", 1, {.live = true}};

 protected:
  Result<void> on_configure() override { return apply(*gain); }

 private:
  Result<void> apply(double wanted) {
    if (wanted > 100) throw std::runtime_error("too loud");
    if (wanted < 0) return fail(ErrorCode::InvalidArgument, "the device refuses it");
    applied = wanted;
    return {};
  }
};

TEST(LiveProperties, AreAppliedByTheComponentOrRefused) {
  auto made = std::make_unique<Amplifier>();
  Amplifier& amplifier = *made;
  const auto task = Task::create("amplifier", std::move(made)).value();
  const auto set = [&](const Value& values) {
    const auto done = task->set_properties(values, soon());
    return done ? std::string() : to_string(done.error());
  };
  EXPECT_EQ(set(Value::map({{"gain", 2.0}})), "");
  EXPECT_EQ(amplifier.applied, 0) << "on_configure applies it";
  ASSERT_TRUE(task->configure(soon()));
  EXPECT_EQ(amplifier.applied, 2.0);
  EXPECT_EQ(set(Value::map({{"gain", 3.0}})), "");
  EXPECT_EQ(amplifier.applied, 3.0);
  EXPECT_EQ(set(Value::map({{"rate", 7}, {"gain", -1.0}})), "amplifier: the device refuses it");
  EXPECT_EQ(set(Value::map({{"gain", 200.0}})), "amplifier: setting 'gain' threw: too loud");
  EXPECT_EQ(task->properties(), Value::map({{"gain", 3.0}, {"rate", 1}})) << "all or nothing";
}

TEST_F(Properties, WrongValueChangesNothingAndNamesItsPath) {
  const Result<void> set = task->set_properties(Value::map({{"device", "/dev/y"}, {"gain", "far"}}), soon());
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("properties.gain"));
  EXPECT_EQ(probe->device.get(), "/dev/x");
}

TEST_F(Properties, UnknownNameGetsASuggestion) {
  const Result<void> set = task->set_properties(Value::map({{"gian", 1.0}}), soon());
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().code, ErrorCode::NotFound);
  EXPECT_THAT(set.error().message, HasSubstr("did you mean 'gain'"));
}

TEST_F(Properties, AMapIsNeeded) {
  const Result<void> set = task->set_properties(Value(3), soon());
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().code, ErrorCode::InvalidArgument);
}

TEST_F(Properties, DynamicOnesHoldWhateverTheirCheckAccepts) {
  struct StandIn : test::Probe {
    DynamicProperty anything{*this, "anything", "/demo/Unknown", Value::map({{"a", 1}, {"b", 2}})};
    DynamicProperty compound{*this, "compound", "/demo/Range", Value::map({{"a", 1}, {"b", 2}}),
                             {},    nullptr,    true};
    DynamicProperty picky{
        *this, "picky", "", Value(1), {}, [](const Value& value, std::string_view path) -> Result<void> {
          if (value.is_integer()) return {};
          return fail(ErrorCode::TypeMismatch, std::string(path) + ": expected an integer");
        }};
  };
  auto made = Task::create("stand_in", std::make_unique<StandIn>(), Activity{}, executor);
  ASSERT_TRUE(made);
  ASSERT_TRUE(
      (*made)->set_properties(Value::map({{"anything", Value::map({{"b", 3}})}, {"picky", 7}}), soon()));
  EXPECT_EQ(*(*made)->properties().find("anything"), Value::map({{"b", 3}})) << "may be a map of any keys";
  ASSERT_TRUE((*made)->set_properties(Value::map({{"compound", Value::map({{"b", 3}})}}), soon()));
  EXPECT_EQ(*(*made)->properties().find("compound"), Value::map({{"a", 1}, {"b", 3}}));
  const Result<void> refused = (*made)->set_properties(Value::map({{"anything", 1}, {"picky", "x"}}), soon());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("properties.picky"));
  EXPECT_TRUE((*made)->properties().find("anything")->is_map());
}

TEST_F(Properties, LiveOnesMaySafelyBeSetWhileUpdatesReadThem) {
  auto component = std::make_unique<test::Probe>();
  test::Probe* other = component.get();
  auto made = Task::create("busy", std::move(component));
  ASSERT_TRUE(made);
  std::latch enough(200);
  int updates = 0;
  other->act = [&](const std::string& hook) -> Result<void> {
    if (hook != "update") return {};
    const std::vector<int>& limits = other->limits.get();
    EXPECT_EQ(limits.front(), limits.back()) << "half of one value, half of another";
    InputPortAccess::notify(other->input);
    if (++updates <= 200) enough.count_down();
    return {};
  };
  ASSERT_TRUE((*made)->set_properties(Value::map({{"limits", Value::list({0, 0})}}), soon()));
  ASSERT_TRUE((*made)->configure(soon()));
  ASSERT_TRUE((*made)->start(soon()));
  InputPortAccess::notify(other->input);
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE((*made)->set_properties(Value::map({{"limits", Value::list({i, 7, i})}}), soon()));
    ASSERT_EQ((*made)->properties().find("limits")->as_list().size(), 3U);
  }
  enough.wait();
  ASSERT_TRUE((*made)->stop(soon()));
}

}  // namespace
}  // namespace segue::task
