// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/action_times.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

/// A statistical model of the durations of actions.
namespace segue::solve::detail {

/// Random numbers that are the same with every compiler (splitmix64).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  /// Below 1, at least 0.
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  /// Below `count`, which must not be 0.
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(next() % count); }
  /// The standard normal distribution (Box-Muller).
  double normal() {
    constexpr double kTurn = 6.283185307179586;
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(kTurn * uniform());
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }
  std::uint64_t state_;
};

/// Draws random durations. Computes with logarithms of nanoseconds, since durations scatter by factors. Each
/// source (durations measured under one key) has a location and a scatter about it. The fewer values a source
/// has, the less certain is its location, and the more its scatter is that of all sources of its kind. A
/// source without values takes the location of another one of its kind, if possible on the same host. Points
/// into the times, which must outlive it.
class DurationModel {
 public:
  explicit DurationModel(const model::ActionTimes& times);

  /// The index of the source of a key.
  std::size_t source_of(const model::ActionKey& key);
  [[nodiscard]] bool is_measured(std::size_t source) const { return !sources_[source].scatter.empty(); }
  /// The expected median in nanoseconds.
  [[nodiscard]] double typical(std::size_t source) const;

  /// Draws one possible location for each source, which all draws of the trial use.
  void begin_trial(Dice& dice);
  double draw(std::size_t source, Dice& dice) const;
  double draw_wait(Dice& dice) const;
  [[nodiscard]] double typical_wait() const { return typical_wait_; }

 private:
  struct Source {
    model::ActionKind kind;
    double place = 0;
    std::vector<double> scatter;  ///< of its values about the location; empty: never measured
    std::vector<double> others;   ///< locations of similar sources, if it was never measured
    double place_now = 0;         ///< in this trial
  };
  void learn_scatter();
  void look_at_others(Source& source, const model::ActionKey& key) const;
  [[nodiscard]] const std::vector<double>& common_scatter(model::ActionKind kind) const;

  const model::ActionTimes& times_;
  std::map<model::ActionKey, std::size_t> numbers_;
  std::vector<Source> sources_;
  std::map<model::ActionKind, std::vector<double>> scatter_of_kind_;
  std::vector<double> scatter_of_all_;
  double typical_wait_ = 0;
};

}  // namespace segue::solve::detail
