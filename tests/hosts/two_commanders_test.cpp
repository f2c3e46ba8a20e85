// SPDX-License-Identifier: Apache-2.0
//
// Two computers with a runtime each for one robot. While one switches the robot, the other takes it over,
// connections break, and daemons and runtimes start again, at random moments. Only one of them is ever
// obeyed; whoever has lost the robot does nothing any more; and afterwards whoever has it can switch it.
// SEGUE_COMMANDERS_ROUNDS=200 runs as many rounds, SEGUE_SEED=n another sequence of them.
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/shared_mutex.hpp>
#include <segue/base/text.hpp>

#include <support/eventually.hpp>
#include <support/network_of.hpp>
#include <support/number_from.hpp>
#include <support/sanitizers.hpp>

#include "commanding_computer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <random>

namespace segue::distributed {
namespace {

using namespace std::chrono_literals;
using runtime::Outcome;
using segue::testing::eventually;
using segue::testing::number_from;
using testing::CommandingComputer;
using testing::Computer;
using testing::Daemons;
using testing::kDaemons;
using testing::Line;

constexpr int kDefaultRounds = kSanitized ? 15 : 60;
constexpr Duration kNoLonger = 30s;

/// Task t0 is in all of them; others begin, end and change hosts.
model::Network controller(int number, std::size_t daemons) {
  const std::string other = daemons == 1 ? "h0" : "h1";
  const std::string mine = "t" + std::to_string(number + 1);
  return segue::testing::network_of(
      "network: c" + std::to_string(number) + "\ntasks:\n  t0: {component: test::A}\n  " + mine +
      ": {component: test::B}\n  shared: {component: test::C}\n"
      "deployments:\n  p: {process: p, host: h0, tasks: [t0]}\n  q" +
      mine + ": {process: q" + mine + ", host: " + other + ", tasks: [" + mine +
      "]}\n  r: {process: r, host: " + (number % 2 == 0 ? "h0" : other) +
      ", tasks: [shared]}\nconnections:\n  - t0.out -> " + mine + ".in\n  - " + mine + ".out -> shared.in\n");
}

/// What a host has, whatever it is called among others.
std::string held(Computer& computer) {
  std::vector<std::string> all;
  const auto truth = computer.world.truth();
  for (const auto& task : truth.tasks)
    all.push_back(task.id.str() + " " + std::string(to_string(task.state)));
  for (const auto& one : truth.deployments)
    all.push_back(to_string(one.key()));
  for (const auto& one : truth.connections)
    all.push_back(to_string(one.from) + ">" + to_string(one.to));
  std::sort(all.begin(), all.end());
  return listed(all);
}

class TwoCommanders : public ::testing::Test {
 protected:
  enum class Kind { TakeOver, Cut, Restart };
  /// Happens when the present commander makes its call of that number to daemons.
  struct Happening {
    Kind kind;
    int at;
    std::size_t daemon;
    bool done = false;
  };

  TwoCommanders() {
    set_log_level(LogLevel::Warning);
    for (std::size_t i = 0; i < kDaemons; ++i)
      daemons_.at(i) = std::make_unique<Computer>("h" + std::to_string(i));
    for (auto& side : lines_) {
      for (auto& line : side)
        line.spoil_calls([this, &side](const std::string&) -> std::optional<Error> {
          count_call(&side == &lines_.at(side_));
          return std::nullopt;
        });
    }
  }
  ~TwoCommanders() override {
    armed_ = false;
    former_.reset();
    present_.reset();
    next_.reset();
  }

  std::size_t up_to(std::size_t count) { return random_() % count; }
  bool one_in(std::size_t chances) { return up_to(chances) == 0; }
  std::unique_ptr<CommandingComputer> commander(std::size_t side, bool take_over) {
    return std::make_unique<CommandingComputer>("runtime" + std::to_string(++runtimes_), daemons_, count_,
                                                lines_.at(side).data(), take_over);
  }

  void draw_happenings() {
    happenings_.clear();
    const auto at = [&] { return static_cast<int>(1 + up_to(up_to(2) == 0 ? 12 : 60)); };
    if (!one_in(4)) happenings_.push_back({Kind::TakeOver, at(), 0});
    for (std::size_t i = up_to(3); i > 0; --i)
      happenings_.push_back({one_in(2) ? Kind::Cut : Kind::Restart, at(), up_to(count_)});
    cut_for_next_ = one_in(4) ? static_cast<int>(up_to(count_)) : -1;
  }

  /// By threads of the runtimes, which must not wait for what happens.
  void count_call(bool is_present) {
    if (!armed_ || !is_present) return;
    const int number = ++calls_;
    const Lock lock(mutex_);
    for (auto& one : happenings_) {
      if (one.done || one.at != number) continue;
      one.done = true;
      later_.push_back(std::async(std::launch::async, [this, what = one] { happen(what); }));
    }
  }
  void happen(const Happening& what) {
    if (what.kind == Kind::Cut) return lines_.at(side_).at(what.daemon).cut();
    if (what.kind == Kind::Restart) {
      for (auto& side : lines_)
        side.at(what.daemon).cut();
      daemons_.at(what.daemon)->boot();
      for (auto& side : lines_)
        side.at(what.daemon).mend();
      return;
    }
    if (cut_for_next_ >= 0) lines_.at(1 - side_).at(static_cast<std::size_t>(cut_for_next_)).cut();
    former_.reset();  // there is one runtime on each computer
    next_ = commander(1 - side_, true);
    const Lock lock(mutex_);
    for (std::size_t i = 0; i < count_; ++i) {
      if (holder_at(i) == next_->holder) frozen_[i] = held(*daemons_.at(i));
    }
  }
  /// What has not happened yet happens now; all is over when this returns.
  void finish_happenings() {
    armed_ = false;
    std::vector<std::future<void>> under_way;
    std::vector<Happening> left;
    {
      const Lock lock(mutex_);
      under_way.swap(later_);
      for (auto& one : happenings_) {
        if (!std::exchange(one.done, true)) left.push_back(one);
      }
    }
    for (auto& one : under_way)
      one.wait();
    for (const auto& one : left)
      happen(one);
  }

  std::string holder_at(std::size_t daemon) {
    auto& computer = *daemons_.at(daemon);
    const ReadLock running(computer.booting);
    const auto robots = computer.local->robots();
    return robots && !robots->empty() ? robots->front().holder : "";
  }
  [[nodiscard]] bool all_obey(const CommandingComputer& who) {
    for (std::size_t i = 0; i < count_; ++i) {
      if (holder_at(i) != who.holder) return false;
    }
    const auto reports = who.host->computers();
    return std::all_of(reports.begin(), reports.end(), [](const auto& report) { return report.reachable; });
  }
  std::string all_held() {
    std::string all;
    for (std::size_t i = 0; i < count_; ++i)
      all += "h" + std::to_string(i) + ": " + held(*daemons_.at(i)) + "\n";
    return all;
  }

  /// One commander switches, and whatever was drawn happens meanwhile.
  void disturb() {
    draw_happenings();
    frozen_.clear();
    calls_ = 0;
    armed_ = true;
    auto result = present_->request(any());
    ASSERT_EQ(result.wait_for(kNoLonger), std::future_status::ready) << "a request never ends";
    finish_happenings();
    for (const auto& [daemon, before] : frozen_)
      EXPECT_EQ(held(*daemons_.at(daemon)), before) << "h" << daemon << " obeys who has lost it";
    for (auto& side : lines_) {
      for (auto& line : side)
        line.mend();
    }
  }

  /// One of both gets all hosts, and the other one knows that it has lost them.
  void settle() {
    bool is_taken = false;
    ASSERT_TRUE(eventually(
        [&] {
          is_taken = next_ != nullptr && all_obey(*next_);
          return is_taken || (all_obey(*present_) && !present_->host->loss());
        },
        kNoLonger))
        << "nobody gets all hosts: " << holder_at(0) << ", " << holder_at(count_ - 1);
    if (!is_taken) {
      next_.reset();
      ++kept_;
      return;
    }
    ++taken_;
    ASSERT_TRUE(eventually([&] { return present_->host->loss().has_value(); }, kNoLonger));
    next_->begin();
    former_ = std::move(present_);
    present_ = std::move(next_);
    side_ = 1 - side_;
  }

  void expect_that_present_commands() {
    const auto& network = any();
    const auto done = present_->request(network).get();
    ASSERT_EQ(done.outcome, Outcome::Done) << present_->holder << ": " << done.why();
    const auto shall = present_->host->expanded(network);
    EXPECT_TRUE(eventually(
        [&] {
          wrong_ = listed(model::differences(shall, present_->host->observe()));
          return wrong_.empty();
        },
        kNoLonger))
        << wrong_;
    EXPECT_FALSE(present_->host->loss());
  }

  /// Whoever has lost the robot may ask for what it wants, and end.
  void expect_that_former_does_nothing() {
    if (former_ == nullptr) return;
    const std::string before = all_held();
    const auto refused = former_->request(any()).get();
    EXPECT_EQ(refused.outcome, Outcome::Refused);
    EXPECT_EQ(refused.error ? refused.error->code : ErrorCode::Internal, ErrorCode::Superseded);
    if (one_in(2)) former_.reset();
    EXPECT_EQ(all_held(), before);
    EXPECT_TRUE(all_obey(*present_));
  }

  const model::Network& any() { return controllers_.at(up_to(controllers_.size())); }

  void begin_robot(std::size_t daemons) {
    former_.reset();
    if (present_ != nullptr) present_->request({}).wait();
    present_.reset();
    count_ = daemons;
    controllers_.clear();
    for (int i = 0; i < 4; ++i)
      controllers_.push_back(controller(i, count_));
    side_ = 0;
    present_ = commander(side_, true);
    present_->begin();
  }

  std::mt19937_64 random_{static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1))};
  Daemons daemons_;
  std::size_t count_ = 1;  ///< of the daemons that the robot uses
  std::array<std::array<Line, kDaemons>, 2> lines_;
  std::atomic<std::size_t> side_{0};  ///< which lines are those of the present commander
  std::vector<model::Network> controllers_;
  int runtimes_ = 0;
  int cut_for_next_ = -1;  ///< the daemon that whoever takes the robot over does not reach at first
  std::atomic<bool> armed_{false};
  std::atomic<int> calls_{0};
  Mutex mutex_;  ///< protects the next three
  std::vector<Happening> happenings_;
  std::vector<std::future<void>> later_;
  std::map<std::size_t, std::string> frozen_;  ///< what hosts had when they were given to the next commander
  std::unique_ptr<CommandingComputer> former_;
  std::unique_ptr<CommandingComputer> present_;
  std::unique_ptr<CommandingComputer> next_;
  std::string wrong_;
  int taken_ = 0;
  int kept_ = 0;
};

TEST_F(TwoCommanders, AreNeverObeyedBothAndTheLastOneCanGoOn) {
  const int rounds = number_from("SEGUE_COMMANDERS_ROUNDS", kDefaultRounds);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    if (round % 20 == 0) begin_robot(1 + static_cast<std::size_t>(round / 20) % kDaemons);
    if (one_in(8)) {
      present_.reset();
      present_ = commander(side_, false);
      present_->begin();
    }
    ASSERT_NO_FATAL_FAILURE(disturb());
    ASSERT_NO_FATAL_FAILURE(settle());
    ASSERT_NO_FATAL_FAILURE(expect_that_present_commands());
    expect_that_former_does_nothing();
  }
  EXPECT_GT(taken_, rounds / 4) << "the robot is hardly ever taken over";
  EXPECT_GT(kept_, 0);
  RecordProperty("taken_over", taken_);
  RecordProperty("kept", kept_);
}

}  // namespace
}  // namespace segue::distributed
