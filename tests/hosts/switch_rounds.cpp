// SPDX-License-Identifier: Apache-2.0
#include "switch_rounds.hpp"

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>

#include <support/random_networks.hpp>

#include <algorithm>
#include <thread>
#include <utility>

namespace segue::distributed::testing {

namespace {

using namespace std::chrono_literals;
using runtime::Outcome;
using runtime::RuntimeState;
using runtime::SwitchResult;

/// How long to wait for what must come. What cannot come, because of a planted defect, is not waited for
/// long.
constexpr Duration kLooking = 30s;
constexpr Duration kShortLook = 1s;
/// Of each action while there is trouble. Nothing has to be done in that time.
constexpr Duration kActionDeadline = 1s;

using Place = std::optional<std::size_t>;

std::string why(const SwitchResult& result) {
  return std::string(to_string(result.outcome)) + (result.ok() ? "" : ": " + result.why()) +
         (result.leftover ? "; left over: " + to_string(*result.leftover) : "");
}

/// Plays one scenario.
class Player {
 public:
  Player(const Scenario& scenario, Planted planted, Ends& ends)
      : scenario_(scenario),
        patience_(planted == Planted::Nothing ? kLooking : kShortLook),
        ends_(ends),
        controllers_(random_controllers(scenario.networks, scenario.hosts)),
        robot_(scenario.hosts, scenario.optional, planted) {}

  std::string play() {
    for (std::size_t i = 0; i < scenario_.rounds.size(); ++i) {
      const Round& round = scenario_.rounds[i];
      if (auto wrong = play(round); !wrong.empty()) {
        return "round " + std::to_string(i + 1) + ": " + wrong + "\nevents:\n" + events();
      }
    }
    const auto wrong = heal(0);
    return wrong.empty() ? wrong : "at the end: " + wrong + "\nevents:\n" + events();
  }

 private:
  std::string play(const Round& round) {
    if (round.restart) {
      restart();
    }
    if (round.cut >= 0) {
      robot_.cut(static_cast<std::size_t>(round.cut));
    }
    if (auto busy = robot_.settle(); !busy.empty()) {
      return busy;
    }
    before_ = all_truths();
    reachable_before_ = reachable_places();
    const auto& controller = controllers_.at(static_cast<std::size_t>(round.controller));
    const model::Network target = robot_.host().expanded(controller);
    const bool was_lost = robot_.has_lost_robot();
    const bool refusal = was_lost || must_be_refused(target);
    robot_.arm(round.troubles);
    const auto result = robot_.runtime().switch_to(
        controller, {.order = round.paper ? model::Order::Paper : model::Order::Seamless,
                     .action_deadline = kActionDeadline,
                     .force = false,
                     .who = {}});
    robot_.disarm();
    if (auto busy = robot_.must_be_lost() ? robot_.settle() : std::string(); !busy.empty()) {
      return busy;
    }
    struck_ = robot_.struck();
    for (const auto& trouble : struck_) {
      ends_.note(std::string(to_string(trouble.kind)));
    }
    std::string wrong = robot_.has_lost_robot() && !refusal ? judge_lost(result, target)
                                                            : judge(result, target, refusal, was_lost);
    if (!wrong.empty()) {
      return wrong + "\nthe request ended: " + why(result);
    }
    return round.heal || is_unsure_ ? heal(round.controller) : std::string();
  }

  void restart() {
    robot_.restart_runtime();
    expected_.reset();
  }

  /// The robot was lost meanwhile: what the request has done stands, and nothing is undone elsewhere.
  std::string judge_lost(const SwitchResult& result, const model::Network& target) {
    ends_.note("lost");
    if (const auto broken = robot_.violations(); !broken.empty()) {
      return listed(broken);
    }
    const auto was = std::exchange(expected_, std::nullopt);
    if (result.outcome == Outcome::Done) {
      return judge_lost_hosts(target);
    }
    return result.undo && result.undo->restored ? judge_claim_to_be_undone(was) : std::string();
  }

  /// It was lost afterwards. Hosts that had other trouble were left out.
  std::string judge_claim_to_be_undone(const std::optional<model::Network>& was) {
    const bool is_alone = std::all_of(struck_.begin(), struck_.end(), [](const Trouble& trouble) {
      return trouble.kind == TroubleKind::Rival;
    });
    if (!was || !is_alone) {
      return {};
    }
    for (const auto& place : reachable_before_) {
      if (const auto wrong = differences(robot_.part(*was, place), robot_.truth(place)); !wrong.empty()) {
        return "a switch whose robot was lost claims to be undone, but " + called(place) + ": " +
               listed(wrong);
      }
    }
    return {};
  }

  std::string judge(const SwitchResult& result, const model::Network& target, bool refusal, bool was_lost) {
    if (const auto broken = robot_.violations(); !broken.empty()) {
      return listed(broken);
    }
    if (refusal != (result.outcome == Outcome::Refused)) {
      return refusal ? "a request that needs a lost host was not refused" : "the request was refused";
    }
    if (refusal) {
      ends_.note(was_lost ? "refused since lost" : "refused");
      return judge_refused(result, was_lost ? ErrorCode::Superseded : ErrorCode::Unavailable);
    }
    if (result.outcome == Outcome::Done) {
      ends_.note("done");
      expected_ = target;
      if (auto wrong = judge_lost_hosts(target); !wrong.empty()) {
        return wrong;
      }
      return judge_running(target, "after a switch that is done");
    }
    if (result.outcome == Outcome::Failed && result.undo && result.undo->restored) {
      ends_.note("restored");
      return expected_ ? judge_running(*expected_, "after a switch that was undone") : std::string();
    }
    ends_.note("reported");
    is_unsure_ = true;
    return judge_reported(result);
  }

  /// A host that cannot be reached is not optional, and is needed by what runs or by what is requested.
  bool must_be_refused(const model::Network& target) const {
    for (std::size_t i = 0; i < robot_.hosts(); ++i) {
      const bool needed = uses(target, i) || (expected_ && uses(*expected_, i));
      if (needed && !robot_.optional(i) && !robot_.can_be_reached(i)) {
        return true;
      }
    }
    return false;
  }
  bool uses(const model::Network& network, std::size_t host) const {
    return std::any_of(network.deployments.begin(), network.deployments.end(),
                       [&](const model::Deployment& one) { return one.host == robot_.name(host); });
  }

  [[nodiscard]] std::vector<Place> all_places() const {
    std::vector<Place> places{std::nullopt};
    for (std::size_t i = 0; i < robot_.hosts(); ++i) {
      places.emplace_back(i);
    }
    return places;
  }
  [[nodiscard]] std::vector<Place> reachable_places() const {
    auto places = all_places();
    std::erase_if(places, [&](const Place& place) { return place && !robot_.can_be_reached(*place); });
    return places;
  }
  [[nodiscard]] std::map<Place, model::Network> all_truths() const {
    std::map<Place, model::Network> truths;
    for (const auto& place : all_places()) {
      truths.emplace(place, robot_.truth(place));
    }
    return truths;
  }
  [[nodiscard]] std::string called(const Place& place) const {
    return place ? "host " + robot_.name(*place).str() : "the runtime's computer";
  }

  std::string judge_refused(const SwitchResult& result, ErrorCode reason) {
    if (result.error->code != reason) {
      return "the refusal has another reason than what was lost";
    }
    if (processes_may_have_ended()) {
      is_unsure_ = true;
      return {};
    }
    for (const auto& [place, before] : before_) {
      if (const auto changes = changes_between(before, robot_.truth(place)); !changes.empty()) {
        return "a request was refused, but " + called(place) + " has changed: " + listed(changes);
      }
    }
    return {};
  }

  /// What a host runs that lacks nothing and has nothing more.
  std::string wrong_with(const model::Network& shall) const {
    for (const auto& place : reachable_places()) {
      const auto part = robot_.part(model::without_hosts(shall, lost_hosts()), place);
      if (const auto wrong = differences(part, robot_.truth(place)); !wrong.empty()) {
        return called(place) + ": " + listed(wrong);
      }
    }
    return {};
  }
  [[nodiscard]] std::set<model::HostName> lost_hosts() const {
    std::set<model::HostName> lost;
    for (std::size_t i = 0; i < robot_.hosts(); ++i) {
      if (!robot_.can_be_reached(i)) {
        lost.insert(robot_.name(i));
      }
    }
    return lost;
  }

  /// Every host that can be reached runs exactly its part, once the runtime has looked after what was left.
  std::string judge_running(const model::Network& shall, const std::string& when) {
    std::string wrong;
    const bool right = soon([&] {
      wrong = wrong_with(shall);
      return wrong.empty() ||
             (processes_may_have_ended() && !robot_.runtime().observed_differences().empty());
    });
    if (!right) {
      return when + ", " + wrong;
    }
    if (!wrong.empty()) {
      ends_.note("differs");
      is_unsure_ = true;
    }
    return {};
  }

  /// Processes that end, as on a host that starts again, take a part of the robot along.
  [[nodiscard]] bool processes_may_have_ended() const {
    return std::any_of(struck_.begin(), struck_.end(), [](const Trouble& trouble) {
      return is_of_process(trouble.kind) || trouble.kind == TroubleKind::HostRestarts ||
             trouble.kind == TroubleKind::RivalEndsAll;
    });
  }

  /// A host that took part and is lost now has committed, if the switch is reported as done.
  std::string judge_lost_hosts(const model::Network& shall) {
    if (processes_may_have_ended()) {
      return {};
    }
    for (const auto& place : reachable_before_) {
      if (!place || robot_.can_be_reached(*place)) {
        continue;
      }
      const auto part = robot_.part(shall, place);
      const auto truth = robot_.truth(place);
      for (const auto& connection : part.connections) {
        const auto& there = truth.connections;
        if (std::find(there.begin(), there.end(), connection) == there.end()) {
          return "the switch is reported as done, but lost " + called(place) +
                 " has not committed: " + to_string(connection) + " is missing";
        }
      }
    }
    return {};
  }

  /// What is reported is what runs.
  std::string judge_reported(const SwitchResult& result) {
    if (result.outcome != Outcome::Failed || robot_.runtime().state() != RuntimeState::Failed) {
      return "a switch that could not be undone leaves the runtime in state '" +
             std::string(to_string(robot_.runtime().state())) + "'";
    }
    if (to_string(*result.error).find("the robot now runs") == std::string::npos) {
      return "it is not said what runs";
    }
    std::string wrong;
    const bool right = soon([&] {
      std::vector<std::string> truth;
      for (const auto& place : reachable_places()) {
        const auto here = inventory(robot_.truth(place));
        truth.insert(truth.end(), here.begin(), here.end());
      }
      std::sort(truth.begin(), truth.end());
      const auto seen = inventory(robot_.host().observe());
      wrong = listed(changes_between(truth, seen));
      return wrong.empty();
    });
    return right ? std::string() : "what is seen is not what runs: " + wrong;
  }

  /// All is well again: one request leads to what it says, and leaves nothing else.
  std::string heal(int number) {
    robot_.heal();
    is_unsure_ = false;
    struck_.clear();
    if (auto busy = robot_.settle(); !busy.empty()) {
      return "when all was well again, " + busy;
    }
    if (robot_.has_lost_robot()) {  // for good, although the rival has left
      restart();
    }
    if (auto busy = robot_.settle(); !busy.empty()) {
      return "when another runtime had taken the robot over, " + busy;
    }
    const auto& controller = controllers_.at(static_cast<std::size_t>(number));
    const auto result = robot_.runtime().switch_to(controller);
    if (result.outcome != Outcome::Done) {
      return "when all was well again, the request ended: " + why(result);
    }
    expected_ = robot_.host().expanded(controller);
    std::string wrong;
    const bool right = soon([&] {
      wrong = wrong_with(*expected_);
      if (const auto orphans = robot_.orphans(); !orphans.empty()) {
        wrong += (wrong.empty() ? "" : "; ") + ("endpoints without another end: " + listed(orphans));
      }
      return wrong.empty();
    });
    if (!right) {
      return "when all was well again, " + wrong + "\nthe request ended: " + why(result);
    }
    const auto broken = robot_.violations();
    return broken.empty() ? std::string() : listed(broken);
  }

  template <class Condition>
  bool soon(Condition condition) {
    const TimePoint limit = RealClock::instance().now() + patience_;
    while (!condition()) {
      if (RealClock::instance().now() > limit) {
        return false;
      }
      (void)robot_.settle();
    }
    return true;
  }

  std::string events() {
    std::string text;
    for (const auto& event : robot_.runtime().events()) {
      text += "  " + std::string(to_string(event.kind)) + " " + event.subject + ": " + event.message + "\n";
    }
    return text;
  }

  const Scenario& scenario_;
  const Duration patience_;
  Ends& ends_;
  const std::vector<model::Network> controllers_;
  TroubledRobot robot_;
  std::optional<model::Network> expected_ = model::Network{};  ///< nothing: it is not known what should run
  std::map<Place, model::Network> before_;                     ///< what ran before the request
  std::vector<Place> reachable_before_;
  std::vector<Trouble> struck_;
  bool is_unsure_ = false;
};

}  // namespace

std::vector<model::Network> random_controllers(std::uint64_t seed, int hosts) {
  segue::testing::Random random(seed);
  const segue::testing::NetworkShape shape{
      .tasks = 6, .processes = 4, .properties = false, .attributes = false};
  const auto place = [&](model::Network network, int number) {
    network.name = model::NetworkName("controller" + std::to_string(number));
    for (auto& deployment : network.deployments) {
      const int host = segue::testing::up_to(random, hosts);
      deployment.host = host == hosts ? model::kLocalHost : model::HostName("h" + std::to_string(host));
      for (auto& placement : deployment.tasks) {
        placement.name = placement.task.str();  // simulated processes know no other names
      }
    }
    for (auto& connection : network.connections) {
      connection.policy.transport = Transport::Automatic;
    }
    for (auto& task : network.tasks) {
      if (segue::testing::one_in(random, 3)) {
        task.takes_over = task.id;
      }
    }
    return network;
  };
  std::vector<model::Network> all;
  all.push_back(place(segue::testing::random_network(random, shape), 0));
  while (all.size() < kControllers) {
    const int number = static_cast<int>(all.size());
    all.push_back(place(segue::testing::random_variation(random, all.front(), shape), number));
  }
  return all;
}

std::string run(const Scenario& scenario, Planted planted, Ends& ends) {
  return Player(scenario, planted, ends).play();
}

}  // namespace segue::distributed::testing
