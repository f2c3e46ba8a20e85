// SPDX-License-Identifier: Apache-2.0
//
// Two computers take a robot over at the same moment. In whichever order their calls reach the robot's hosts,
// one of them commands the robot on all hosts afterwards, and the other one knows that it does not.
#include <segue/base/condition_variable.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>

#include <support/eventually.hpp>
#include <support/number_from.hpp>

#include "commanding_computer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <future>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace segue::distributed {
namespace {

using segue::testing::eventually;
using segue::testing::number_from;
using testing::CommandingComputer;
using testing::Computer;
using testing::Daemons;
using testing::kDaemons;
using testing::Line;

constexpr std::size_t kCommanders = 2;

/// A call that one of the commanders makes to one of the daemons.
struct Step {
  std::string call{};
  std::size_t commander = 0;
  std::size_t daemon = 0;
  friend bool operator==(const Step&, const Step&) = default;
  friend std::string to_string(const Step& step) {
    return (step.commander == 0 ? "a" : "b") + std::string(" ") + step.call + " h" +
           std::to_string(step.daemon);
  }
};

/// Lets steps happen one after the other, in a given order; others whenever they like. Thread safe.
class Turns {
 public:
  explicit Turns(std::vector<Step> order) : order_(std::move(order)) {}

  void wait_for(const Step& step) {
    Lock lock(mutex_);
    changed_.wait(mutex_, [&] {
      return order_.empty() || order_.front() == step ||
             std::find(order_.begin(), order_.end(), step) == order_.end();
    });
  }
  void done(const Step& step) {
    erase([&](const Step& other) { return other == step; });
  }
  /// What it has not done, it does not do any more.
  void gives_up(std::size_t commander) {
    erase([&](const Step& step) { return step.commander == commander; });
  }

 private:
  template <class Which>
  void erase(Which which) {
    {
      const Lock lock(mutex_);
      std::erase_if(order_, which);
    }
    changed_.notify_all();
  }

  Mutex mutex_;  ///< protects the last member
  ConditionVariable changed_;
  std::vector<Step> order_;
};

class TakeOvers : public ::testing::Test {
 protected:
  TakeOvers() {
    set_log_level(LogLevel::Warning);
    for (std::size_t i = 0; i < kDaemons; ++i)
      daemons_.at(i) = std::make_unique<Computer>("h" + std::to_string(i));
  }

  std::string holder_at(std::size_t daemon) {
    const auto robots = daemons_.at(daemon)->local->robots();
    return robots && !robots->empty() ? robots->front().holder : "";
  }
  bool commands_all(const CommandingComputer& who) {
    return !who.host->loss() && holder_at(0) == who.holder && holder_at(1) == who.holder;
  }

  /// Both take it over, from somebody else, in this order.
  void take_over(std::vector<Step> order) {
    const std::string name = std::to_string(++rounds_);
    CommandingComputer before("before" + name, daemons_, kDaemons, lines_.at(2).data(), true);
    ASSERT_TRUE(commands_all(before));
    turns_.emplace(std::move(order));
    std::array<std::future<std::unique_ptr<CommandingComputer>>, kCommanders> starts;
    for (std::size_t i = 0; i < kCommanders; ++i) {
      for (std::size_t daemon = 0; daemon < kDaemons; ++daemon) {
        auto& line = lines_.at(i).at(daemon);
        line.spoil_calls([this, i, daemon](const std::string& call) -> std::optional<Error> {
          turns_->wait_for({call, i, daemon});
          return std::nullopt;
        });
        line.watch([this, i, daemon](const std::string& call, bool) { turns_->done({call, i, daemon}); });
      }
      starts.at(i) = std::async(std::launch::async, [this, i, name] {
        auto made = std::make_unique<CommandingComputer>((i == 0 ? "a" : "b") + name, daemons_, kDaemons,
                                                         lines_.at(i).data(), true);
        turns_->gives_up(i);
        return made;
      });
    }
    const auto a = starts[0].get();
    const auto b = starts[1].get();
    EXPECT_TRUE(eventually([&] {
      return (commands_all(*a) && b->host->loss()) || (commands_all(*b) && a->host->loss());
    })) << "h0: "
        << holder_at(0) << ", h1: " << holder_at(1);
    EXPECT_TRUE(eventually([&] { return before.host->loss().has_value(); }));
  }

  Daemons daemons_;
  std::array<std::array<Line, kDaemons>, kCommanders + 1> lines_;
  std::optional<Turns> turns_;  ///< outlives whoever calls over the lines
  int rounds_ = 0;
};

TEST_F(TakeOvers, AtTheSameMomentHaveOneWinner) {
  const std::vector<Step> asking = {
      {"highest_term", 0, 0}, {"highest_term", 0, 1}, {"highest_term", 1, 0}, {"highest_term", 1, 1}};
  std::vector<std::size_t> numbers{0, 1, 2, 3};
  do {
    std::vector<Step> order = asking;
    std::string said;
    for (const std::size_t number : numbers) {
      order.push_back({"acquire", number / 2, number % 2});
      said += to_string(order.back()) + "; ";
    }
    SCOPED_TRACE(said);
    take_over(std::move(order));
  } while (std::next_permutation(numbers.begin(), numbers.end()) && !HasFailure());
}

/// One may have got a host, or all, before the other one asks.
TEST_F(TakeOvers, AtAboutTheSameMomentHaveOneWinner) {
  std::mt19937_64 random(static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1)));
  const int rounds = number_from("SEGUE_TAKE_OVERS", 60);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    std::array<std::vector<Step>, kCommanders> left;
    for (std::size_t i = 0; i < kCommanders; ++i) {
      for (const char* call : {"highest_term", "acquire"}) {
        const std::size_t first = random() % kDaemons;
        left.at(i).push_back({call, i, first});
        left.at(i).push_back({call, i, 1 - first});
      }
    }
    std::vector<Step> order;
    std::string said;
    while (!left[0].empty() || !left[1].empty()) {
      auto& of = left[0].empty() || (!left[1].empty() && random() % 2 == 0) ? left[1] : left[0];
      order.push_back(of.front());
      of.erase(of.begin());
      said += to_string(order.back()) + "; ";
    }
    SCOPED_TRACE(said);
    take_over(std::move(order));
  }
}

}  // namespace
}  // namespace segue::distributed
