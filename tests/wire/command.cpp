// SPDX-License-Identifier: Apache-2.0
#include "wire/command.hpp"

#include <charconv>
#include <functional>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace segue::wire {
namespace {

/// What is wrong with a line.
struct Wrong : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A number that is not negative, and its unit.
std::pair<double, std::string_view> quantity(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || !(value >= 0 && value < 1e9)) {
    throw Wrong("'" + std::string(word) + "' is not a quantity");
  }
  return {value, word.substr(static_cast<std::size_t>(end - word.data()))};
}

double share(std::string_view word) {
  const auto [value, unit] = quantity(word);
  if (unit != "%" || value > 100) throw Wrong("'" + std::string(word) + "' is not a share such as 5%");
  return value / 100;
}

Time time(std::string_view word) {
  const auto [value, unit] = quantity(word);
  const double factor = unit == "us" ? 1e3 : unit == "ms" ? 1e6 : unit == "s" ? 1e9 : 0;
  if (factor == 0 && !(value == 0 && unit.empty())) {
    throw Wrong("'" + std::string(word) + "' is not a time such as 20ms");
  }
  return Time(static_cast<Time::rep>(value * factor));
}

class Words {
 public:
  explicit Words(std::string_view line) : words_(std::string(line)) {}

  std::optional<std::string> next() {
    std::string word;
    if (!(words_ >> word)) return std::nullopt;
    return word;
  }
  std::string value(const std::string& setting) {
    auto word = next();
    if (!word) throw Wrong("'" + setting + "' has no value");
    return *word;
  }

 private:
  std::istringstream words_;
};

using Change = std::function<void(Impairment&)>;

Change setting(const std::string& name, Words& words) {
  if (name == "cut") return [](Impairment& i) { i.cut = true; };
  if (name == "heal") return [](Impairment& i) { i.cut = false; };
  if (name == "clear") return [](Impairment& i) { i = {}; };
  if (name == "delay") return [t = time(words.value(name))](Impairment& i) { i.delay = t; };
  if (name == "jitter") return [t = time(words.value(name))](Impairment& i) { i.jitter = t; };
  if (name == "loss") return [s = share(words.value(name))](Impairment& i) { i.loss = s; };
  if (name == "duplicate") return [s = share(words.value(name))](Impairment& i) { i.duplication = s; };
  if (name != "reorder") throw Wrong("there is no setting '" + name + "'");
  const double reordering = share(words.value(name));
  return [reordering, t = time(words.value(name))](Impairment& i) {
    i.reordering = reordering;
    i.held_back = t;
  };
}

/// The stations from which and to which a direction leads: `a>b`, `a<>b`, with `*` for all stations.
class Directions {
 public:
  Directions(const std::vector<std::string>& stations, const std::string& word) : stations_(stations) {
    const std::size_t arrow = word.find('>');
    both_ways_ = arrow > 0 && word[arrow - 1] == '<';
    from_ = word.substr(0, both_ways_ ? arrow - 1 : arrow);
    to_ = word.substr(arrow + 1);
    check(from_);
    check(to_);
  }

  bool contain(std::size_t from, std::size_t to) const {
    return (is(from, from_) && is(to, to_)) || (both_ways_ && is(to, from_) && is(from, to_));
  }

 private:
  bool is(std::size_t station, const std::string& name) const {
    return name == "*" || stations_[station] == name;
  }
  void check(const std::string& name) const {
    for (std::size_t i = 0; i < stations_.size(); ++i)
      if (is(i, name)) return;
    throw Wrong("there is no station '" + name + "'");
  }

  const std::vector<std::string>& stations_;
  std::string from_, to_;
  bool both_ways_ = false;
};

template <class Function>
void for_directions(std::size_t stations, Function function) {
  for (std::size_t from = 0; from < stations; ++from) {
    for (std::size_t to = 0; to < stations; ++to) {
      if (from != to) function(from, to);
    }
  }
}

std::string counts(const FrameQueue& queue, const std::vector<std::string>& stations) {
  std::ostringstream text;
  for_directions(stations.size(), [&](std::size_t from, std::size_t to) {
    const Count& count = queue.count(from, to);
    text << stations[from] << ">" << stations[to] << ": sent " << count.sent << " delivered "
         << count.delivered << " lost " << count.lost << " duplicated " << count.duplicated << " held_back "
         << count.held_back << " overflowed " << count.overflowed << "\n";
  });
  return text.str() + "ok";
}

void apply(FrameQueue& queue, const std::vector<std::string>& stations, std::string_view line) {
  Words words(line);
  std::vector<Change> changes;
  std::string which = "*>*";
  while (const auto word = words.next()) {
    if (word->find('>') == std::string::npos) {
      changes.push_back(setting(*word, words));
      continue;
    }
    which = *word;
    if (const auto more = words.next())
      throw Wrong("'" + *more + "' follows the directions, which come last");
  }
  if (changes.empty()) throw Wrong("nothing is said");
  const Directions directions(stations, which);
  for_directions(stations.size(), [&](std::size_t from, std::size_t to) {
    if (!directions.contain(from, to)) return;
    for (const Change& change : changes)
      change(queue.impairment(from, to));
  });
}

}  // namespace

std::string obey(FrameQueue& queue, const std::vector<std::string>& stations, std::string_view line) {
  if (line == "count") return counts(queue, stations);
  try {
    apply(queue, stations, line);
  } catch (const Wrong& wrong) {
    return std::string("error: ") + wrong.what();
  }
  return "ok";
}

}  // namespace segue::wire
