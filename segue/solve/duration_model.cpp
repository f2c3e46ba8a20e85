// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/duration_model.hpp>

#include <algorithm>

namespace segue::solve::detail {

namespace {

/// Lower bound in nanoseconds: the overhead of the clock and of reporting.
constexpr double kShortest = 1000;
/// Prior without any measurement: about 10 ms, within a factor of five.
constexpr double kGuess = 1e7;
constexpr double kGuessScatter = 1.6;
/// Prior of the scatter within a source, as a logarithm.
constexpr double kUsualScatter = 0.3;
/// Weight of the scatter of other sources, as a number of values.
constexpr double kTrustInOthers = 8;
/// The scatter of a kind needs at least this many values.
constexpr std::size_t kEnough = 20;

double logarithm(Duration duration) {
  return std::log(std::max(static_cast<double>(duration.count()), kShortest));
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

std::vector<double> logarithms(const model::DurationRecord& record) {
  std::vector<double> values;
  values.reserve(record.recent.size());
  for (const Duration duration : record.recent)
    values.push_back(logarithm(duration));
  return values;
}

/// Distances from the location, widened because the location is estimated from few values.
std::vector<double> scatter_about(double place, std::vector<double> values) {
  const auto count = static_cast<double>(values.size());
  const double widening = count > 1 ? std::sqrt(count / (count - 1)) : 0;
  for (double& value : values)
    value = (value - place) * widening;
  return values;
}

}  // namespace

DurationModel::DurationModel(const model::ActionTimes& times) : times_(times) {
  learn_scatter();
  if (!times.waits.recent.empty()) {
    std::vector<double> waits;
    for (const Duration wait : times.waits.recent)
      waits.push_back(static_cast<double>(wait.count()));
    typical_wait_ = median_of(std::move(waits));
  }
}

void DurationModel::learn_scatter() {
  for (const auto& [key, record] : times_.actions) {
    if (record.recent.size() < 2) continue;
    auto values = logarithms(record);
    const double place = median_of(values);
    const auto scatter = scatter_about(place, std::move(values));
    auto& of_kind = scatter_of_kind_[key.kind];
    of_kind.insert(of_kind.end(), scatter.begin(), scatter.end());
    scatter_of_all_.insert(scatter_of_all_.end(), scatter.begin(), scatter.end());
  }
}

/// Empty if there are too few values.
const std::vector<double>& DurationModel::common_scatter(model::ActionKind kind) const {
  const auto of_kind = scatter_of_kind_.find(kind);
  if (of_kind != scatter_of_kind_.end() && of_kind->second.size() >= kEnough) return of_kind->second;
  static const std::vector<double> none;
  return scatter_of_all_.size() >= kEnough ? scatter_of_all_ : none;
}

std::size_t DurationModel::source_of(const model::ActionKey& key) {
  const auto [known, is_new] = numbers_.try_emplace(key, sources_.size());
  if (!is_new) return known->second;
  Source& source = sources_.emplace_back();
  source.kind = key.kind;
  const auto record = times_.actions.find(key);
  if (record != times_.actions.end() && !record->second.recent.empty()) {
    auto values = logarithms(record->second);
    source.place = median_of(values);
    source.scatter = scatter_about(source.place, std::move(values));
  } else {
    look_at_others(source, key);
  }
  return known->second;
}

void DurationModel::look_at_others(Source& source, const model::ActionKey& key) const {
  std::vector<double> elsewhere;
  std::vector<double> of_any_kind;
  for (const auto& [other, record] : times_.actions) {
    if (record.recent.empty()) continue;
    const double place = median_of(logarithms(record));
    of_any_kind.push_back(place);
    if (other.kind == key.kind) (other.host == key.host ? source.others : elsewhere).push_back(place);
  }
  if (source.others.empty()) source.others = std::move(elsewhere);
  if (source.others.empty()) source.others = std::move(of_any_kind);
  source.place = source.others.empty() ? std::log(kGuess) : median_of(source.others);
}

double DurationModel::typical(std::size_t source) const {
  return std::exp(sources_[source].place);
}

void DurationModel::begin_trial(Dice& dice) {
  for (Source& source : sources_) {
    const auto& common = common_scatter(source.kind);
    const double scatter = common.empty() ? kUsualScatter * dice.normal() : common[dice.below(common.size())];
    if (is_measured(static_cast<std::size_t>(&source - sources_.data()))) {
      source.place_now = source.place + scatter / std::sqrt(static_cast<double>(source.scatter.size()));
    } else if (source.others.empty()) {
      source.place_now = source.place + kGuessScatter * dice.normal();
    } else {
      source.place_now = source.others[dice.below(source.others.size())] + scatter;
    }
  }
}

double DurationModel::draw(std::size_t number, Dice& dice) const {
  const Source& source = sources_[number];
  const auto& common = common_scatter(source.kind);
  const auto own = static_cast<double>(source.scatter.size());
  double scatter = 0;
  if (own > 1 && dice.uniform() < own / (own + kTrustInOthers)) {
    scatter = source.scatter[dice.below(source.scatter.size())];
  } else {
    scatter = common.empty() ? kUsualScatter * dice.normal() : common[dice.below(common.size())];
  }
  return std::exp(source.place_now + scatter);
}

double DurationModel::draw_wait(Dice& dice) const {
  const auto& waits = times_.waits.recent;
  return waits.empty() ? 0 : static_cast<double>(waits[dice.below(waits.size())].count());
}

}  // namespace segue::solve::detail
