// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/condition.hpp>
#include <segue/runtime/condition_watch.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/eventually.hpp>
#include <support/forwarding_host.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace segue::runtime {
namespace {

using detail::ConditionWatch;
using type::Value;

/// Questions for the samples of a port, which the test answers.
class AskedPort {
 public:
  void ask(task_host::SamplesAnswer answer) {
    const Lock lock(mutex_);
    answers_.push_back(std::move(answer));
    asked_.notify_all();
  }
  /// Answers the question with this number, once it has been asked.
  void answer(std::size_t number, Result<std::vector<Value>> samples) {
    Lock lock(mutex_);
    ASSERT_TRUE(asked_.wait_for(mutex_, std::chrono::seconds(60), [&] { return answers_.size() > number; }));
    answers_.at(number)(std::move(samples));
  }

 private:
  Mutex mutex_;
  ConditionVariable asked_;
  std::vector<task_host::SamplesAnswer> answers_;
};

/// Its ports only answer when they are told to.
class HostOfAskedPort final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& /*port*/,
                                                             std::size_t /*buffer*/) override {
    return std::make_unique<Reader>(port);
  }
  AskedPort port;

 private:
  class Reader final : public task_host::PortReader {
   public:
    explicit Reader(AskedPort& port) : port_(port) {}
    std::vector<Value> read(std::size_t /*limit*/) override {
      ADD_FAILURE() << "the port is polled";
      return {};
    }
    void next(std::size_t /*limit*/, const Wait& /*wait*/, task_host::SamplesAnswer answered) override {
      port_.ask(std::move(answered));
    }
    [[nodiscard]] std::string type_name() const override { return "/int32_t"; }

   private:
    AskedPort& port_;
  };
};

class AConditionOnSamples : public ::testing::Test {
 protected:
  [[nodiscard]] bool becomes(bool holds) const {
    return segue::testing::eventually([&] { return watch_.holds() == holds; });
  }

  testing::StandInRobot robot_;
  HostOfAskedPort host_{robot_.host};
  ConditionWatch watch_{
      host_, model::SampleShows{{"button", "pressed"}, model::parse_condition("value > 0").value()},
      ConditionWatch::From::Now, [] {}};
};

TEST_F(AConditionOnSamples, IsToldOfThem) {
  host_.port.answer(0, std::vector<Value>{Value(1)});
  EXPECT_TRUE(becomes(true));
  host_.port.answer(1, std::vector<Value>{Value(0)});
  EXPECT_TRUE(becomes(false));
}

TEST_F(AConditionOnSamples, HoldsUntilTheNextSample) {
  host_.port.answer(0, std::vector<Value>{Value(1)});
  EXPECT_TRUE(becomes(true));
  host_.port.answer(1, std::vector<Value>{});
  host_.port.answer(2, std::vector<Value>{});  // the second one has been taken in
  EXPECT_TRUE(watch_.holds());
}

TEST_F(AConditionOnSamples, DoesNotHoldWhereThePortIsGoneUntilItIsThereAgain) {
  host_.port.answer(0, std::vector<Value>{Value(1)});
  EXPECT_TRUE(becomes(true));
  host_.port.answer(1, fail(ErrorCode::NotFound, "its task is gone"));
  EXPECT_TRUE(becomes(false));
  host_.port.answer(2, std::vector<Value>{Value(1)});
  EXPECT_TRUE(becomes(true));
}

}  // namespace
}  // namespace segue::runtime
