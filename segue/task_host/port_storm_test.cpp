// SPDX-License-Identifier: Apache-2.0
// Tasks that break unmake their dynamic ports in their own thread, whatever others do with them.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_host/test_support.hpp>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace storm {

using segue::task::InputPort;
using segue::task::OutputPort;
using segue::task::PortOptions;

/// Writes a few samples, then breaks.
class Fragile : public segue::task::Component {
 public:
  Fragile() : Component({.activity = segue::periodic(std::chrono::microseconds(100))}) {
    dynamic_outputs<double>("out_[0-9]+");
    dynamic_inputs<double>("in_[0-9]+");
  }

 protected:
  segue::Result<void> on_configure() override {
    for (int i = 0; i < 4; ++i) {
      const std::string number = std::to_string(i);
      outputs_.push_back(
          std::make_unique<OutputPort<double>>(*this, "out_" + number, PortOptions{.dynamic = true}));
      inputs_.push_back(
          std::make_unique<InputPort<double>>(*this, "in_" + number, PortOptions{.dynamic = true}));
    }
    updates_ = 0;
    return {};
  }
  void on_update() override {
    double value = 0;
    for (const auto& input : inputs_)
      input->read(value);
    for (const auto& output : outputs_)
      output->write(1.0);
    if (++updates_ == 10) throw std::runtime_error("broke as it should");
  }
  void on_cleanup() override {
    outputs_.clear();
    inputs_.clear();
  }

 private:
  std::vector<std::unique_ptr<OutputPort<double>>> outputs_;
  std::vector<std::unique_ptr<InputPort<double>>> inputs_;
  int updates_ = 0;
};

}  // namespace storm

SEGUE_COMPONENT(storm::Fragile)

namespace segue::task_host {
namespace {

using model::ActionKind;
using testing::on_connection;
using testing::on_task;
using testing::soon;
using testing::wire;

constexpr int kRounds = 100;
const model::TaskId kFragile("fragile");

class PortStorm : public ::testing::Test {
 protected:
  PortStorm() {
    host_.set_listener([this](const HostEvent& happened) {
      const auto& event = std::get<TaskEvent>(happened);
      const Lock lock(mutex_);
      if (event.task == kFragile && event.state == TaskState::Exception) ++broken_;
      changed_.notify_all();
    });
    EXPECT_TRUE(host_.perform(testing::apply(testing::task_of("fragile", "storm::Fragile")), soon()));
    EXPECT_TRUE(host_.perform(testing::apply(testing::task_of("other", "storm::Fragile")), soon()));
    EXPECT_TRUE(host_.perform(on_task(ActionKind::Configure, "other"), soon()));
  }
  ~PortStorm() override { host_.set_listener({}); }

  bool wait_until_broken(int times) {
    Lock lock(mutex_);
    return changed_.wait_for(mutex_, std::chrono::seconds(60), [&] { return broken_ >= times; });
  }
  /// Expects success, or the failures that occur only because the ports are not there just now.
  void expect_done_or_gone(const Result<void>& done) {
    if (done) {
      ++connected_;
      return;
    }
    const ErrorCode code = done.error().code;
    EXPECT_TRUE(code == ErrorCode::NotFound || code == ErrorCode::DeadlineExceeded)
        << to_string(done.error());
  }
  void break_again_and_again() {
    for (int round = 1; round <= kRounds; ++round) {
      for (const auto verb : {ActionKind::Configure, ActionKind::Start}) {
        const auto done = host_.perform(on_task(verb, "fragile"), soon());
        ASSERT_TRUE(done) << to_string(done.error());
      }
      ASSERT_TRUE(wait_until_broken(round));
      const auto recovered = host_.perform(on_task(ActionKind::Recover, "fragile"), soon());
      ASSERT_TRUE(recovered) << to_string(recovered.error());
    }
  }
  void check() {
    const auto described = host_.describe(kFragile);
    if (described) most_ports_ = std::max(most_ports_, described->ports.size());
    if (auto reader = host_.open_reader({kFragile, "out_2"}, 4)) static_cast<void>((*reader)->read(10));
    const TimePoint presently = RealClock::instance().now() + std::chrono::milliseconds(2);
    static_cast<void>(host_.write({kFragile, "in_2"}, type::Value(1.0), presently));
    static_cast<void>(host_.connections());
    static_cast<void>(host_.observe());
  }
  void rewire() {
    for (const auto& connection :
         {wire("fragile", "out_0", "other", "in_0"), wire("other", "out_1", "fragile", "in_1"),
          wire("fragile", "out_3", "fragile", "in_3")}) {
      expect_done_or_gone(host_.perform(on_connection(ActionKind::Connect, connection), soon()));
      static_cast<void>(host_.perform(on_connection(ActionKind::Disconnect, connection), soon()));
    }
  }

  Mutex mutex_;
  ConditionVariable changed_;
  int broken_ = 0;
  std::atomic<bool> over_{false};
  std::size_t most_ports_ = 0;  ///< of the looking thread
  int connected_ = 0;           ///< of the connecting thread
  model::ComponentCatalog catalog_;
  LibrarySet libraries_;
  LocalTaskHost host_{libraries_, catalog_};
};

TEST_F(PortStorm, BreakingTasksMayBeDescribedReadAndConnectedMeanwhile) {
  std::thread looker([&] {
    while (!over_)
      check();
  });
  std::thread wirer([&] {
    while (!over_)
      rewire();
  });
  break_again_and_again();
  over_ = true;
  looker.join();
  wirer.join();
  EXPECT_EQ(most_ports_, 11U) << "eight dynamic ports, state and two families, at least once";
  EXPECT_GT(connected_, 0);
}

}  // namespace
}  // namespace segue::task_host
