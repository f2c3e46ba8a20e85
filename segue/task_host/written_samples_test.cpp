// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>
#include <segue/task_host/test_support.hpp>

#include <gmock/gmock.h>

#include <atomic>

namespace written {

/// Adds up what it reads as new, and shows what it read last.
class Adder final : public segue::task::Component {
 public:
  Adder() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 protected:
  segue::Result<void> on_configure() override {
    sum_ = 0;
    return {};
  }
  void on_update() override {
    double value = 0;
    const auto status = number_.read(value);
    if (status == segue::task::ReadStatus::NewData) sum_ += value;
    last_.write(status == segue::task::ReadStatus::NoData ? -1 : value);
  }

 private:
  segue::task::InputPort<double> number_{*this, "number"};
  segue::task::InputPort<double> other_{*this, "never_read"};
  segue::task::OutputPort<double> last_{*this, "last"};
  double sum_ = 0;
  segue::task::Operation<double()> total_{*this, "total", {}, [this] { return sum_; }};
};

}  // namespace written

SEGUE_COMPONENT(written::Adder)

namespace segue::task_host {
namespace {

using model::ActionKind;
using ::testing::HasSubstr;
using testing::on_task;
using testing::soon;
using type::Value;

class WritingToPorts : public ::testing::Test {
 protected:
  WritingToPorts() {
    perform(testing::apply(testing::task_of("adder", "written::Adder")));
    perform(on_task(ActionKind::Configure, "adder"));
  }
  void perform(const model::Action& action) {
    const auto done = host_.perform(action, soon());
    EXPECT_TRUE(done) << to_string(done.error());
  }
  Result<void> write(const std::string& port, const Value& value, TimePoint deadline = soon()) {
    return host_.write({model::TaskId("adder"), port}, value, deadline);
  }
  std::string refusal_of(const std::string& port, const Value& value, TimePoint deadline = soon()) {
    const auto done = write(port, value, deadline);
    return done ? std::string() : to_string(done.error());
  }
  Value total() { return host_.call(model::TaskId("adder"), "total", type::ValueMap{}, soon()).value(); }
  /// The value that the task has read last, from now on.
  Value next_poll() {
    auto reader = host_.open_reader({model::TaskId("adder"), "last"}, 10).value();
    std::vector<Value> samples;
    while (samples.empty())
      samples = reader->read(10);
    return samples.back();
  }

  model::ComponentCatalog catalog_;
  LibrarySet libraries_;
  LocalTaskHost host_{libraries_, catalog_, {.stand_in = false, .only_stand_ins = false, .stand_ins = {}}};
};

TEST_F(WritingToPorts, HandsEachSampleToTheTaskOnce) {
  perform(on_task(ActionKind::Start, "adder"));
  for (int i = 1; i <= 10; ++i)
    EXPECT_EQ(refusal_of("number", i), "");
  EXPECT_EQ(total(), Value(55.0));
  EXPECT_EQ(next_poll(), Value(10.0)) << "it is the last sample until another comes";
  EXPECT_TRUE(host_.connections().empty()) << "no connection of the network";
}

TEST_F(WritingToPorts, IsForgottenOnceATransitionHasStoppedTheTask) {
  perform(on_task(ActionKind::Start, "adder"));
  EXPECT_TRUE(write("number", 5));
  perform(on_task(ActionKind::Stop, "adder"));
  host_.conclude(model::Transition{});
  perform(on_task(ActionKind::Start, "adder"));
  EXPECT_EQ(next_poll(), Value(-1.0));
}

TEST_F(WritingToPorts, RefusesWhatNoTaskWillRead) {
  EXPECT_THAT(refusal_of("number", 1), HasSubstr("is stopped, so it reads no samples"));
  perform(on_task(ActionKind::Start, "adder"));
  EXPECT_THAT(refusal_of("nummer", 1), HasSubstr("no input port 'nummer', did you mean 'number'?"));
  EXPECT_THAT(refusal_of("number", "text"), HasSubstr("number"));
  EXPECT_EQ(host_.write({model::TaskId("nobody"), "number"}, 1, soon()).error().code, ErrorCode::NotFound);
  EXPECT_EQ(total(), Value(0.0));
}

TEST_F(WritingToPorts, WithdrawsWhatTheTaskDoesNotRead) {
  perform(on_task(ActionKind::Start, "adder"));
  const auto late = write("never_read", 1, RealClock::instance().now() + std::chrono::milliseconds(5));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_THAT(to_string(late.error()),
              HasSubstr("has not read the sample from its port 'never_read' in time"));
}

TEST_F(WritingToPorts, EndsWithTheTask) {
  perform(on_task(ActionKind::Start, "adder"));
  EXPECT_TRUE(write("number", 5));
  perform(on_task(ActionKind::Stop, "adder"));
  perform(on_task(ActionKind::Cleanup, "adder"));
  host_.conclude(model::Transition{});
  EXPECT_THAT(refusal_of("number", 1), HasSubstr("is pre_operational, so it reads no samples"));
}

}  // namespace
}  // namespace segue::task_host
