// SPDX-License-Identifier: Apache-2.0
// The host allocates nothing in the updates of its tasks.
#include <segue/task_host/test_support.hpp>
#include <support/allocation_trap.hpp>

#include <atomic>
#include <thread>

namespace realtime_test {

/// Fails and recovers in turns, in trapped updates.
class Wavering : public segue::task::Component {
 public:
  static inline std::atomic<int> updates{0};

  Wavering() : Component({.activity = segue::periodic(std::chrono::microseconds(200))}) {}

 private:
  static constexpr int kWarmUp = 20;
  void on_update() override {
    segue::testing::trapped = updates.fetch_add(1) > kWarmUp;
    error(lost_, "for one update");
  }
  void on_error() override { recovered(); }
  void on_stop() override { segue::testing::trapped = false; }

  segue::task::ErrorState lost_{*this, "LOST"};
};

}  // namespace realtime_test

SEGUE_COMPONENT(realtime_test::Wavering)

namespace segue::task_host {
namespace {

using model::ActionKind;
using realtime_test::Wavering;
using testing::apply;
using testing::on_task;
using testing::soon;
using testing::task_of;

TEST(HostRealtime, ChangesOfStateAreToldWithoutAllocationInTheUpdate) {
  const model::ComponentCatalog catalog;
  const LibrarySet libraries;
  LocalTaskHost host(libraries, catalog);
  std::atomic<int> failed{0};
  std::atomic<int> recovered{0};
  host.set_listener([&](const HostEvent& event) {
    const auto& change = std::get<TaskEvent>(event);
    EXPECT_EQ(change.task, model::TaskId("w"));
    ++(change.state == TaskState::RunTimeError ? failed : recovered);
  });
  for (const auto& action : {apply(task_of("w", "realtime_test::Wavering")),
                             on_task(ActionKind::Configure, "w"), on_task(ActionKind::Start, "w")}) {
    const auto done = host.perform(action, soon());
    ASSERT_TRUE(done) << to_string(done.error());
  }
  const TimePoint limit = soon();
  while (Wavering::updates < 200 && RealClock::instance().now() < limit)
    std::this_thread::yield();
  EXPECT_EQ(segue::testing::caught, 0);
  while ((failed == 0 || recovered == 0) && RealClock::instance().now() < limit)
    std::this_thread::yield();
  EXPECT_GT(failed, 0);
  EXPECT_GT(recovered, 0);
  ASSERT_TRUE(host.perform(on_task(ActionKind::Stop, "w"), soon()));
  host.set_listener({});
}

}  // namespace
}  // namespace segue::task_host
