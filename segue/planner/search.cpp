// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/search.hpp>

#include <segue/planner/heuristic.hpp>

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_set>
#include <utility>

namespace segue::planner::detail {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// All states that were reached, each once, with the way there.
class States {
 public:
  explicit States(std::uint32_t facts) : words_((facts + 63) / 64), known_(64, Hash{this}, Equal{this}) {}

  [[nodiscard]] std::span<const std::uint64_t> operator[](std::uint32_t state) const {
    return {bits_.data() + std::size_t{state} * words_, words_};
  }
  /// The number of the state; nothing where it is known already.
  std::optional<std::uint32_t> add(const StateBits& bits, std::uint32_t from, std::uint32_t by) {
    const auto number = static_cast<std::uint32_t>(ways_.size());
    bits_.insert(bits_.end(), bits.begin(), bits.end());
    ways_.emplace_back(from, by);
    if (known_.insert(number).second) return number;
    bits_.resize(bits_.size() - words_);
    ways_.pop_back();
    return std::nullopt;
  }
  [[nodiscard]] std::vector<std::uint32_t> way_to(std::uint32_t state) const {
    std::vector<std::uint32_t> operators;
    for (; ways_[state].first != kNone; state = ways_[state].first)
      operators.push_back(ways_[state].second);
    std::ranges::reverse(operators);
    return operators;
  }
  [[nodiscard]] std::size_t size() const { return ways_.size(); }
  /// In bytes, roughly.
  [[nodiscard]] std::size_t memory() const { return size() * (words_ * sizeof(std::uint64_t) + 64); }

 private:
  struct Hash {
    const States* states;
    std::size_t operator()(std::uint32_t state) const {
      std::uint64_t hash = 1469598103934665603ULL;
      for (const std::uint64_t word : (*states)[state])
        hash = (hash ^ word ^ (word >> 29U)) * 1099511628211ULL;
      return hash;
    }
  };
  struct Equal {
    const States* states;
    bool operator()(std::uint32_t a, std::uint32_t b) const {
      return std::ranges::equal((*states)[a], (*states)[b]);
    }
  };

  std::size_t words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ways_;  ///< from which state, by which operator
  std::unordered_set<std::uint32_t, Hash, Equal> known_;
};

/// Operators to be tried, by the estimate for the state in which they begin; of equal ones the oldest first.
class OpenList {
 public:
  void push(double estimate, std::uint32_t state, std::uint32_t by) {
    entries_.push({estimate, pushed_++, state, by});
  }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  std::pair<std::uint32_t, std::uint32_t> pop() {
    const Entry entry = entries_.top();
    entries_.pop();
    return {entry.state, entry.by};
  }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  static constexpr std::size_t kEntryBytes = 24;

 private:
  struct Entry {
    double estimate;
    std::uint64_t number;
    std::uint32_t state;
    std::uint32_t by;
    bool operator>(const Entry& other) const {
      return std::pair(estimate, number) > std::pair(other.estimate, other.number);
    }
  };
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> entries_;
  std::uint64_t pushed_ = 0;
};

class Search {
 public:
  Search(const GroundTask& task, const Limits& limits)
      : task_(task), limits_(limits), states_(task.facts), heuristic_(task) {}

  Result<Found> run() {
    StateBits initial((task_.facts + 63) / 64);
    for (const FactNumber fact : task_.initial)
      initial[fact / 64] |= std::uint64_t{1} << (fact % 64);
    if (!task_.goal_can_be_reached) return none();
    std::optional<std::uint32_t> state = states_.add(initial, kNone, kNone);
    while (true) {
      if (state) {
        if (is_goal(*state)) return Found{states_.way_to(*state), states_.size()};
        open(*state);
      }
      if (all_.empty() && preferred_.empty()) return none();
      if (limits_.are_reached()) return fail(ErrorCode::DeadlineExceeded, "no plan was found in time");
      if (memory() > limits_.memory)
        return fail(ErrorCode::ResourceExhausted, "no plan was found in the memory that the planner may use");
      state = next();
    }
  }

 private:
  static Error none() { return fail(ErrorCode::NotFound, "the problem has no plan"); }

  [[nodiscard]] std::size_t memory() const {
    return states_.memory() + (all_.size() + preferred_.size()) * OpenList::kEntryBytes;
  }

  [[nodiscard]] bool is_goal(std::uint32_t state) const {
    return std::ranges::all_of(task_.goal, [&](FactNumber fact) { return has_fact(states_[state], fact); });
  }

  void open(std::uint32_t state) {
    const double estimate = heuristic_.estimate(states_[state]);
    if (!std::isfinite(estimate)) return;
    if (estimate < best_) {
      best_ = estimate;
      boost_ += kBoost;
    }
    for (const std::uint32_t each : heuristic_.applicable())
      all_.push(estimate, state, each);
    for (const std::uint32_t each : heuristic_.preferred())
      preferred_.push(estimate, state, each);
  }

  /// Preferred operators get a thousand turns more for each progress.
  std::optional<std::uint32_t> next() {
    const bool prefers = all_.empty() || (!preferred_.empty() && (boost_ > 0 || turn_));
    if (boost_ > 0) --boost_;
    turn_ = !turn_;
    const auto [from, by] = (prefers ? preferred_ : all_).pop();
    const Operator& each = task_.operators[by];
    StateBits bits(states_[from].begin(), states_[from].end());
    for (const FactNumber fact : each.deletes)
      bits[fact / 64] &= ~(std::uint64_t{1} << (fact % 64));
    for (const FactNumber fact : each.adds)
      bits[fact / 64] |= std::uint64_t{1} << (fact % 64);
    return states_.add(bits, from, by);
  }

  static constexpr int kBoost = 1000;

  const GroundTask& task_;
  const Limits& limits_;
  States states_;
  Heuristic heuristic_;
  OpenList all_;
  OpenList preferred_;
  double best_ = std::numeric_limits<double>::infinity();
  int boost_ = 0;
  bool turn_ = false;
};

}  // namespace

Result<Found> search(const GroundTask& task, const Limits& limits) {
  return Search(task, limits).run();
}

}  // namespace segue::planner::detail
