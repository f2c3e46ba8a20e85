// SPDX-License-Identifier: Apache-2.0
// Tasks and connections without a runtime, as in a test: two components, one connection, and a life cycle
// driven by hand.
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/task.hpp>

#include <atomic>
#include <chrono>
#include <cstdio>

namespace {

using namespace segue;
using namespace std::chrono_literals;

class Source final : public task::Component {
 public:
  Source() : Component({.activity = periodic(1ms)}) {}
  task::OutputPort<int> out{*this, "out"};

 private:
  void on_update() override { out.write(++count_); }
  int count_ = 0;
};

class Sink final : public task::Component {
 public:
  explicit Sink(int wanted) : wanted_(wanted) {}
  task::InputPort<int> in{*this, "in"};
  std::atomic<int> result{0};

 private:
  void on_update() override {
    for (int number = 0; in.read(number) == task::ReadStatus::NewData;) {
      sum_ += number;
      if (number == wanted_) {
        result = sum_;
        result.notify_one();
      }
    }
  }
  int wanted_;
  int sum_ = 0;
};

Result<int> sum_up_to(int wanted) {
  auto source_component = std::make_unique<Source>();
  auto sink_component = std::make_unique<Sink>(wanted);
  Source& source = *source_component;
  Sink& sink = *sink_component;
  const auto from = task::Task::create("source", std::move(source_component));
  const auto to = task::Task::create("sink", std::move(sink_component));
  if (!from) return from.error();
  if (!to) return to.error();

  // Room for all samples, since a full buffer refuses them and the sink may be scheduled late.
  const auto connection = sample_link::connect(
      source.out, sink.in, {.kind = BufferKind::Buffer, .size = static_cast<std::size_t>(wanted)});
  if (!connection) return connection.error();
  for (const auto& one : {to->get(), from->get()}) {  // the consumer first
    if (auto configured = one->configure(10s); !configured) return configured.error();
    if (auto started = one->start(10s); !started) return started.error();
  }
  sink.result.wait(0);
  return sink.result.load();
}  // the destructors stop and clean up the tasks and disconnect their ports

}  // namespace

int main() {
  const auto sum = sum_up_to(100);
  if (!sum) {
    std::fprintf(stderr, "%s\n", to_string(sum.error()).c_str());
    return 1;
  }
  std::printf("1 + 2 + ... + 100 = %d\n", *sum);
}
