// SPDX-License-Identifier: Apache-2.0
// A message of ROS 2 from one process to another, through ros2::Publisher or ros2::Subscription, beside Fast
// DDS alone at the same place. The time is that from before the writing to the reader's turn.
//
//   ros2_hop_bench [ROUNDS]      default: 3; of each, the ratio to the floor of the same round is printed
#include "ros2/raw_dds.hpp"
#include "support/floor.hpp"
#include "support/scratch.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/policy.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component_registry.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/type/describe.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace bench_msgs {
struct Stamped {
  std::uint64_t stamp = 0;
  std::vector<std::uint8_t> payload;
};
SEGUE_TYPE(Stamped, stamp, payload)
}  // namespace bench_msgs

namespace {

using namespace bench;
using namespace std::chrono_literals;
using bench_msgs::Stamped;
using segue::type::ValueMap;

constexpr std::size_t kWarmUp = 100;
constexpr std::chrono::seconds kPatience{60};

std::uint64_t stamp_now() {
  return static_cast<std::uint64_t>(segue::monotonic_now().time_since_epoch().count());
}

/// How many messages of a size are sent, and how often.
struct Load {
  std::size_t bytes;
  std::size_t count;
  Duration period;
};
constexpr std::array kLoads = {Load{16, 2000, 1ms}, Load{1'000, 2000, 1ms}, Load{60'000, 1000, 2ms},
                               Load{1'000'000, 200, 20ms}};

/// The other program and this one, on one processor or each on its own.
struct Case {
  std::string writer;  ///< raw, segue, segue-group
  std::string reader;  ///< listener, thread, segue
};

template <class T>
T required(segue::Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", to_string(result.error()).c_str());
  std::exit(1);
}
void required(const segue::Result<void>& result) {
  if (result) return;
  std::fprintf(stderr, "%s\n", to_string(result.error()).c_str());
  std::exit(1);
}

/// A task of components/ros2.
std::unique_ptr<segue::task::Task> ros2_task(const std::string& component, std::uint32_t domain,
                                             const std::string& interfaces,
                                             const segue::Activity* activity = nullptr) {
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 1);
  static segue::task_host::LibrarySet libraries;
  required(libraries.load("segue_components_ros2"));
  auto task = required(segue::task::Task::create(
      component, required(segue::task::find_component(component)->create()), activity));
  ValueMap values;
  values.append("topic", "/stamped");
  values.append("type", "bench_msgs/msg/Stamped");
  values.append("interfaces", segue::type::Value::list({segue::type::Value(interfaces)}));
  values.append("domain", std::int64_t{domain});
  values.append("discovery", "localhost");
  required(task->set_properties(values, kPatience));
  required(task->configure(kPatience));
  return task;
}

const segue::Policy kBuffer{segue::BufferKind::Buffer, 10, segue::Transport::Automatic, false};

class Sink final : public segue::task::Component {
 public:
  explicit Sink(std::function<void(std::uint64_t)> arrived)
      : Component({.doc = "Notes when messages arrive"}), arrived_(std::move(arrived)) {}
  segue::task::InputPort<Stamped> in{*this, "in"};

 protected:
  void on_update() override {
    while (const auto message = in.take())
      arrived_(message->stamp);
  }

 private:
  const std::function<void(std::uint64_t)> arrived_;
};

/// Writes a message at each of its updates, so many.
class Source final : public segue::task::Component {
 public:
  explicit Source(const Load& load) : load_(load) {
    Stamped message;
    message.payload.resize(load.bytes);
    out.prime(message);
  }
  segue::task::OutputPort<Stamped> out{*this, "out"};
  [[nodiscard]] bool is_done() const {
    return sent_.load(std::memory_order_relaxed) >= kWarmUp + load_.count;
  }

 protected:
  void on_update() override {
    if (is_done()) return;
    sent_.fetch_add(1, std::memory_order_relaxed);
    auto loan = out.loan();
    if (!loan) return;
    loan->payload.resize(load_.bytes);
    loan->stamp = stamp_now();
    loan.publish();
  }

 private:
  const Load load_;
  std::atomic<std::size_t> sent_{0};  ///< relaxed: a count
};

void wait_for(const std::function<bool()>& has_reader) {
  while (!has_reader())
    std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(500ms);  // the reader's side, too
}

void write_raw(std::uint32_t domain, const Load& load) {
  constexpr std::size_t kHeader = 4;  // of CDR; then a stamp, the number of bytes, the bytes
  RawWriter writer(domain);
  Payload message(kHeader + 8 + 4 + load.bytes);
  message[1] = std::byte{1};
  const auto bytes = static_cast<std::uint32_t>(load.bytes);
  std::memcpy(&message[kHeader + 8], &bytes, sizeof bytes);
  wait_for([&] { return writer.readers() > 0; });
  for (std::size_t i = 0; i < kWarmUp + load.count; ++i) {
    const std::uint64_t stamp = stamp_now();
    std::memcpy(&message[kHeader], &stamp, sizeof stamp);
    writer.write(message);
    std::this_thread::sleep_for(load.period);
  }
  std::this_thread::sleep_for(200ms);
}

/// With a thread for each task, or both in a thread group.
void write_by_segue(std::uint32_t domain, const Load& load, const std::string& interfaces, bool in_group) {
  segue::Activity paced = segue::periodic(load.period);
  segue::Activity driven;
  if (in_group) paced.thread = driven.thread = "writers";
  auto made = std::make_unique<Source>(load);
  Source& source = *made;
  const auto writer = required(segue::task::Task::create("source", std::move(made), &paced));
  const auto publisher = ros2_task("ros2::Publisher", domain, interfaces, &driven);
  required(segue::sample_link::connect(source.out, *publisher->component().find_input("in"), kBuffer));
  required(writer->configure(kPatience));
  required(publisher->start(kPatience));
  wait_for([&] {
    const auto counts = required(publisher->call("statistics", {}, kPatience));
    return counts.find("matched")->as_int() > 0;
  });
  required(writer->start(kPatience));
  while (!source.is_done())
    std::this_thread::sleep_for(20ms);
  std::this_thread::sleep_for(200ms);
}

/// Prints the durations in nanoseconds, one a line.
class Arrivals {
 public:
  explicit Arrivals(std::size_t count) : wanted_(count) { durations_.reserve(2 * (count + kWarmUp)); }
  void note(std::uint64_t stamp) {
    durations_.push_back(stamp_now() - stamp);
    count_.store(durations_.size(), std::memory_order_release);
  }
  /// Until all have come, or none has come for a while.
  void wait_and_print() {
    std::size_t before = 0;
    for (auto quiet_since = std::chrono::steady_clock::now();;) {
      const std::size_t now = count_.load(std::memory_order_acquire);
      if (now >= wanted_ + kWarmUp) break;
      if (now != before) quiet_since = std::chrono::steady_clock::now();
      before = now;
      if (std::chrono::steady_clock::now() - quiet_since > (now > 0 ? 2s : std::chrono::seconds(kPatience)))
        break;
      std::this_thread::sleep_for(20ms);
    }
    const std::size_t count = count_.load(std::memory_order_acquire);
    for (std::size_t i = kWarmUp; i < count; ++i)
      std::printf("%llu\n", static_cast<unsigned long long>(durations_[i]));
    std::fflush(stdout);
  }

 private:
  const std::size_t wanted_;
  std::vector<std::uint64_t> durations_;
  std::atomic<std::size_t> count_{0};
};

void read_raw(std::uint32_t domain, const Load& load, bool by_thread) {
  Arrivals arrivals(load.count);
  const RawReader reader(domain, by_thread, [&](const Payload& message) {
    std::uint64_t stamp = 0;
    std::memcpy(&stamp, &message[4], sizeof stamp);
    arrivals.note(stamp);
  });
  arrivals.wait_and_print();
}

void read_by_segue(std::uint32_t domain, const Load& load, const std::string& interfaces) {
  Arrivals arrivals(load.count);
  auto made = std::make_unique<Sink>([&](std::uint64_t stamp) { arrivals.note(stamp); });
  auto& in = made->in;
  const auto sink = required(segue::task::Task::create("sink", std::move(made)));
  const auto subscription = ros2_task("ros2::Subscription", domain, interfaces);
  required(segue::sample_link::connect(*subscription->component().find_output("out"), in, kBuffer));
  required(sink->configure(kPatience));
  required(sink->start(kPatience));
  required(subscription->start(kPatience));
  arrivals.wait_and_print();
  required(subscription->stop(kPatience));
  required(sink->stop(kPatience));
}

/// A process of this program.
int be(const std::vector<std::string>& words) {
  const Load& load = kLoads.at(std::stoul(words.at(2)));
  const auto domain = static_cast<std::uint32_t>(std::stoul(words.at(3)));
  if (const int cpu = std::stoi(words.at(5)); cpu >= 0 && !pin_to(cpu)) return 1;
  if (words.at(0) == "write") {
    if (words.at(1) == "raw")
      write_raw(domain, load);
    else
      write_by_segue(domain, load, words.at(4), words.at(1) == "segue-group");
  } else if (words.at(1) == "segue") {
    read_by_segue(domain, load, words.at(4));
  } else {
    read_raw(domain, load, words.at(1) == "thread");
  }
  std::_Exit(0);
}

/// Both processes; the durations.
std::vector<Duration> measure(const Case& one, std::size_t load, const std::string& interfaces,
                              int cpu_of_writer, int cpu_of_reader) {
  static std::uint32_t domain = static_cast<std::uint32_t>(::getpid()) % 200;
  domain = domain % 200 + 1;
  const auto start = [&](const std::string& what, const std::string& how, int cpu) {
    const std::string command = "exec /proc/" + std::to_string(::getpid()) + "/exe " + what + " " + how +
                                " " + std::to_string(load) + " " + std::to_string(domain) + " " + interfaces +
                                " " + std::to_string(cpu);
    return ::popen(command.c_str(), "r");
  };
  FILE* reader = start("read", one.reader, cpu_of_reader);
  FILE* writer = start("write", one.writer, cpu_of_writer);
  std::vector<Duration> durations;
  for (unsigned long long ns = 0; std::fscanf(reader, "%llu", &ns) == 1;)
    durations.emplace_back(static_cast<Duration::rep>(ns));
  ::pclose(reader);
  ::pclose(writer);
  return durations;
}

struct Place {
  const char* name;
  int cpu_of_writer;
  int cpu_of_reader;
};
constexpr std::array kPlaces = {Place{"free to move", -1, -1}, Place{"both on one processor", 0, 0},
                                Place{"each on its own processor", 0, 1}};

/// Of medians in the same round, since those of different rounds are of different hours.
std::string ratios(std::vector<double> each) {
  std::ranges::sort(each);
  std::array<char, 100> text{};
  std::snprintf(text.data(), text.size(), "%.2f (%.2f to %.2f)", each[each.size() / 2], each.front(),
                each.back());
  return text.data();
}

void compare(std::size_t rounds, const std::string& interfaces, const Place& place, std::size_t load) {
  const std::array<std::pair<const char*, Case>, 5> cases{
      {{"Fast DDS alone, read by a thread (floor)", {"raw", "thread"}},
       {"Fast DDS alone, read by a listener", {"raw", "listener"}},
       {"ros2::Subscription -> task", {"raw", "segue"}},
       {"task -> ros2::Publisher", {"segue", "thread"}},
       {"task -> ros2::Publisher, of one thread group", {"segue-group", "thread"}}}};
  std::array<std::vector<Duration>, cases.size()> all;
  std::array<std::vector<double>, cases.size()> to_floor;
  for (std::size_t round = 0; round < rounds; ++round) {
    std::array<double, cases.size()> medians{};
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const auto durations =
          measure(cases[i].second, load, interfaces, place.cpu_of_writer, place.cpu_of_reader);
      all[i].insert(all[i].end(), durations.begin(), durations.end());
      medians[i] = static_cast<double>(summarise(durations).median.count());
      if (medians[0] > 0 && medians[i] > 0) to_floor[i].push_back(medians[i] / medians[0]);
    }
  }
  Table table("A message of ROS 2 of " + std::to_string(kLoads[load].bytes) +
              " bytes between two processes, " + place.name);
  const Duration floor = summarise(all[0]).median;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    table.add(cases[i].first, summarise(all[i]), 1, i == 0 ? Duration{0} : floor);
    if (i > 0 && !to_floor[i].empty()) table.note("  of the floor, by round", ratios(to_floor[i]));
  }
  table.print();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() > 1) return be(words);
  const std::size_t rounds = words.empty() ? 3 : std::stoul(words[0]);
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path() / "bench_msgs/msg");
  static_cast<void>(scratch.write("bench_msgs/msg/Stamped.msg", "uint64 stamp\nuint8[] payload\n"));
  for (const Place& place : kPlaces) {
    for (std::size_t load = 0; load < kLoads.size(); ++load)
      compare(rounds, scratch.path().string(), place, load);
  }
  return 0;
}
