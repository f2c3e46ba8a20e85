// SPDX-License-Identifier: Apache-2.0
//
// The three components of the paper's experiments: a producer, a relay and a consumer. Chains of them measure
// the cost of a hop and the samples lost by a switch between chains.
#include "gap_counter.hpp"
#include "samples.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace bench {

using segue::Result;
using segue::task::Component;
using segue::task::InputPort;
using segue::task::Operation;
using segue::task::OutputPort;
using segue::task::Property;

namespace {

std::int64_t nanoseconds(segue::TimePoint time) {
  return time.time_since_epoch().count();
}

}  // namespace

/// Writes a numbered, stamped sample at every update.
class Producer final : public Component {
 public:
  Producer()
      : Component({.doc = "Writes a numbered, stamped sample of a given size at every update",
                   .activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 protected:
  Result<void> on_configure() override {
    if (*size_ > kLargest) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "size must be at most 1 GiB");
    }
    Sample largest;
    largest.payload.resize(*size_);
    out_.prime(largest);
    return {};
  }

  Result<void> on_start() override {
    sequence_ = 0;
    return {};
  }

  void on_update() override {
    ++sequence_;
    write_sample();
    FixedSample fixed;
    fixed.sequence = sequence_;
    fixed.stamp = nanoseconds(now());
    fixed_.write(fixed);
  }

 private:
  static constexpr std::uint64_t kLargest = std::uint64_t{1} << 30;

  void write_sample() {
    auto loan = out_.loan();
    if (!loan) {
      return;
    }
    loan->sequence = sequence_;
    loan->payload.resize(*size_);
    loan->stamp = nanoseconds(now());
    loan.publish();
  }

  OutputPort<Sample> out_{*this, "out", {.doc = "samples of the given size"}};
  OutputPort<FixedSample> fixed_{*this, "fixed_out", {.doc = "the same numbers with 48 bytes"}};
  Property<std::uint64_t> size_{*this, "size", 0, {.doc = "bytes of payload in each sample"}};
  std::uint64_t sequence_ = 0;
};

/// Passes every sample on. Can be made to fail, to measure how long its recovery takes.
class Relay final : public Component {
 public:
  Relay() : Component({.doc = "Passes every sample on"}) {}

 protected:
  void on_update() override {
    while (auto sample = in_.take()) {
      out_.write(*sample);
    }
    while (auto sample = fixed_in_.take()) {
      fixed_out_.write(*sample);
    }
    if (std::exchange(to_fail_, false)) {
      error("asked to fail");
    }
  }

 private:
  InputPort<Sample> in_{*this, "in"};
  OutputPort<Sample> out_{*this, "out"};
  InputPort<FixedSample> fixed_in_{*this, "fixed_in"};
  OutputPort<FixedSample> fixed_out_{*this, "fixed_out"};
  Operation<void()> fail_{*this,
                          "fail",
                          {},
                          [this] { to_fail_ = true; },
                          segue::task::RunsIn::TaskThread,
                          "the next update ends in the error state"};
  bool to_fail_ = false;
};

/// Counts samples and gaps, and measures latency.
class Consumer final : public Component {
 public:
  Consumer() : Component({.doc = "Counts samples, their latency, and the gaps in their numbers"}) {}

 protected:
  Result<void> on_configure() override {
    if (*record_ > kMostLatencies) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "record must be at most 1,000,000");
    }
    latencies_.reserve(*record_);
    return {};
  }

  Result<void> on_start() override {
    reset();
    return {};
  }

  void on_update() override {
    while (auto sample = in_.take()) {
      count(sample->sequence, sample->stamp, gaps_);
    }
    while (auto sample = fixed_in_.take()) {
      count(sample->sequence, sample->stamp, fixed_gaps_);
    }
    statistics_out_.write(statistics_);
  }

 private:
  static constexpr std::uint64_t kMostLatencies = 1'000'000;

  void reset() {
    statistics_ = {};
    latencies_.clear();
    latency_sum_ = 0;
    gaps_ = {};
    fixed_gaps_ = {};
  }

  void count(std::uint64_t sequence, std::int64_t stamp, GapCounter& gaps) {
    const std::int64_t arrival = nanoseconds(now());
    const double latency = 1e-9 * static_cast<double>(arrival - stamp);
    if (statistics_.last_arrival > 0) {
      const double pause = 1e-9 * static_cast<double>(arrival - statistics_.last_arrival);
      statistics_.pause_max = std::max(statistics_.pause_max, pause);
    }
    statistics_.last_arrival = arrival;
    ++statistics_.count;
    gaps.note(sequence);
    statistics_.lost = gaps_.lost() + fixed_gaps_.lost();
    statistics_.late = gaps_.late() + fixed_gaps_.late();
    latency_sum_ += latency;
    if (latencies_.size() < *record_) latencies_.push_back(latency);
    statistics_.latency_min = statistics_.count == 1 ? latency : std::min(statistics_.latency_min, latency);
    statistics_.latency_max = std::max(statistics_.latency_max, latency);
    statistics_.latency_mean = latency_sum_ / static_cast<double>(statistics_.count);
  }

  InputPort<Sample> in_{*this, "in"};
  InputPort<FixedSample> fixed_in_{*this, "fixed_in"};
  OutputPort<Statistics> statistics_out_{*this, "statistics", {.doc = "after every update"}};
  Operation<Statistics()> read_{*this, "statistics", {}, [this] { return statistics_; }};
  Operation<std::vector<double>()> read_latencies_{*this,
                                                   "latencies",
                                                   {},
                                                   [this] { return latencies_; },
                                                   segue::task::RunsIn::TaskThread,
                                                   "of the first samples since the last reset, in seconds"};
  Operation<void()> reset_{*this, "reset", {}, [this] { reset(); }};
  Property<std::uint64_t> record_{*this, "record", 0, {.doc = "how many latencies to keep after a reset"}};
  Statistics statistics_;
  std::vector<double> latencies_;
  double latency_sum_ = 0;
  GapCounter gaps_;
  GapCounter fixed_gaps_;
};

/// Drives to a goal and says so by its state; measures how long it stands there until it gets the next one.
class Driver final : public Component {
 public:
  Driver()
      : Component(
            {.doc = "Drives for a while after each goal; measures the time from its arrival to the next goal",
             .activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 protected:
  Result<void> on_configure() override {
    reactions_.reserve(kMostReactions);
    return {};
  }

  void on_update() override {
    if (left_ == 0 || --left_ > 0) return;
    arrived_ = now();
    arrived_state_.enter();
  }

 private:
  static constexpr std::size_t kMostReactions = 10'000;
  static constexpr std::uint64_t kShortest = 20;

  /// The ways differ, so that arrivals fall on all moments of whatever looks for them now and then.
  void go() {
    if (arrived_ != segue::TimePoint() && reactions_.size() < kMostReactions)
      reactions_.push_back(std::chrono::duration<double>(now() - arrived_).count());
    arrived_ = {};
    left_ = *updates_ > 0 ? *updates_ : kShortest + (goals_ * 7) % 23;
    ++goals_;
    driving_.enter();
  }

  segue::task::State driving_{*this, "driving"};
  segue::task::State arrived_state_{*this, "arrived"};
  Property<std::uint64_t> updates_{
      *this, "updates", 0, {.live = true, .doc = "that each way takes; 0: 20 to 42"}};
  Operation<void()> go_{*this, "go", {}, [this] { go(); }};
  Operation<std::vector<double>()> read_{*this,
                                         "reactions",
                                         {},
                                         [this] { return reactions_; },
                                         segue::task::RunsIn::TaskThread,
                                         "from each arrival to the next goal, in seconds"};
  std::vector<double> reactions_;
  segue::TimePoint arrived_{};
  std::uint64_t left_ = 0;
  std::uint64_t goals_ = 0;
};

}  // namespace bench

SEGUE_COMPONENT(bench::Producer)
SEGUE_COMPONENT(bench::Relay)
SEGUE_COMPONENT(bench::Consumer)
SEGUE_COMPONENT(bench::Driver)
