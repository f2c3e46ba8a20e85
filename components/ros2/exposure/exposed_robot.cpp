// SPDX-License-Identifier: Apache-2.0
#include "exposed_robot.hpp"
#include "../participant/node_task.hpp"

#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/control/server.hpp>

#include <algorithm>
#include <chrono>
#include <utility>

namespace ros2 {

using segue::Result;
using segue::control::RobotLevel;
using segue::type::Value;

namespace {

constexpr std::chrono::seconds kRobotAnswers{10};
constexpr std::chrono::seconds kConnectsWithin{5};
/// Between two tries to connect.
constexpr std::chrono::milliseconds kTryAgain{300};
/// A robot that begins is connected with a little later than its first tasks are started.
constexpr std::chrono::seconds kRobotPatience{5};
/// How often the robot is asked for its tasks though it says of no change, and how often at the most.
constexpr std::chrono::seconds kRarely{1};
constexpr std::chrono::milliseconds kAtMost{50};
constexpr std::chrono::minutes kLongWatch{1};
/// Each has one question open at the robot, which has 256 of a client.
constexpr std::size_t kMostNodes = 200;

segue::TaskState state_in(const Value& task) {
  const Value* state = task.find("state");
  const auto found = state == nullptr ? std::nullopt : segue::task_state_from(state->as_string());
  return found.value_or(segue::TaskState::PreOperational);
}

}  // namespace

/// The robot's answers, which come in threads of the connection.
class ExposedRobot::Inbox {
 public:
  struct Level {
    std::string task;
    std::uint64_t number;
    Result<RobotLevel> level;
  };
  struct News {
    bool has_changed = false;
    std::vector<Level> levels;
  };

  void add(Level level) {
    const segue::Lock lock(mutex_);
    news_.levels.push_back(std::move(level));
    changed_.notify_all();
  }
  void add(const Result<std::uint64_t>& count) {
    const segue::Lock lock(mutex_);
    if (count) count_ = *count;
    news_.has_changed = true;
    is_asked_ = false;
    changed_.notify_all();
  }
  /// The count of changes to ask from, unless the robot is being asked already.
  std::optional<std::uint64_t> to_ask() {
    const segue::Lock lock(mutex_);
    if (std::exchange(is_asked_, true)) return {};
    return count_;
  }
  News wait(const std::stop_token& stop, segue::TimePoint until) {
    segue::Lock lock(mutex_);
    changed_.wait_until(mutex_, stop, until, [this]() SEGUE_REQUIRES(mutex_) {
      return news_.has_changed || !news_.levels.empty();
    });
    return std::exchange(news_, {});
  }

 private:
  segue::Mutex mutex_;
  segue::StoppableConditionVariable changed_;
  News news_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t count_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool is_asked_ SEGUE_GUARDED_BY(mutex_) = false;
};

ExposedRobot::ExposedRobot(std::shared_ptr<Participant> participant, ExposedRobotSettings settings,
                           ExposureRules rules, std::function<void()> changed)
    : participant_(std::move(participant)),
      settings_(std::move(settings)),
      rules_(std::move(rules)),
      changed_(std::move(changed)),
      executor_(participant_),
      thread_(segue::concurrent::start_stoppable_thread(
          "segue-exposure", [this](const std::stop_token& stop) { run(stop); })) {}

ExposedRobot::~ExposedRobot() = default;

void ExposedRobot::run(const std::stop_token& stop) {
  const segue::TimePoint begin = segue::monotonic_now();
  bool was_connected = false;
  while (!stop.stop_requested()) {
    Result<void> ended = {};
    auto robot = segue::control::connect(settings_.socket, kConnectsWithin, stop);
    if (robot) {
      was_connected = true;
      ended = follow(std::move(*robot), stop);
    } else {
      ended = robot.error();
    }
    if (!ended && (was_connected || segue::monotonic_now() > begin + kRobotPatience))
      set_trouble(segue::to_string(ended.error()));
    Inbox().wait(stop, segue::monotonic_now() + kTryAgain);
  }
}

Result<void> ExposedRobot::follow(std::shared_ptr<segue::control::RobotService> robot,
                                  const std::stop_token& stop) {
  Connection connection{std::move(robot), std::stop_source(), std::make_shared<Inbox>()};
  const std::stop_callback ended(stop, [&] { connection.ends.request_stop(); });
  const auto nodes = [this] {
    const segue::Lock lock(mutex_);
    return nodes_;
  };
  if (settings_.rosout != nullptr) {
    connection.log =
        std::make_unique<RobotLog>(connection.robot, settings_.rosout, settings_.own_node, nodes);
  }
  connection.parameters =
      std::make_unique<RobotParameters>(connection.robot, settings_.parameter_events, nodes);
  Result<void> result;
  while (result && !stop.stop_requested()) {
    const auto status = connection.robot->status(segue::Wait(segue::Deadline(kRobotAnswers), stop));
    if (!status) {
      result = status.error();
      break;
    }
    set_trouble("");
    take_tasks(connection, *status);
    ask_for_changes(connection);
    wait_for_news(connection, stop);
  }
  connection.ends.request_stop();
  connection.log.reset();
  connection.parameters.reset();
  connection.nodes.clear();
  note_nodes(connection);
  return result;
}

void ExposedRobot::ask_for_changes(Connection& connection) {
  const auto count = connection.inbox->to_ask();
  if (!count) return;
  connection.robot->changes(
      *count, segue::Wait(segue::Deadline(kLongWatch), connection.ends.get_token()),
      [inbox = connection.inbox](const Result<std::uint64_t>& now) { inbox->add(now); });
}

void ExposedRobot::wait_for_news(Connection& connection, const std::stop_token& stop) {
  segue::TimePoint until = segue::monotonic_now() + kRarely;
  while (!stop.stop_requested() && segue::monotonic_now() < until) {
    const auto news = connection.inbox->wait(stop, until);
    for (const auto& one : news.levels)
      take_level(connection, one.task, one.number, one.level);
    if (news.has_changed) until = std::min(until, segue::monotonic_now() + kAtMost);
  }
}

bool ExposedRobot::is_exposed(const Value& task) const {
  const std::string& id = task.find("id")->as_string();
  // These are nodes themselves, or stand for one.
  if (id == settings_.own_task || task.find("component")->as_string().starts_with("ros2::")) return false;
  return settings_.tasks.empty() || std::ranges::any_of(settings_.tasks, [&](const std::string& pattern) {
           return segue::matches_glob(pattern, id);
         });
}

void ExposedRobot::take_tasks(Connection& connection, const Value& status) {
  std::map<std::string, const Value*> wanted;
  for (const Value& task : status.find("tasks")->as_list()) {
    if (is_exposed(task)) wanted.emplace(task.find("id")->as_string(), &task);
  }
  std::erase_if(connection.nodes, [&](const auto& one) {
    const auto found = wanted.find(one.first);
    return found == wanted.end() || found->second->find("component")->as_string() != one.second.component;
  });
  for (const auto& [id, task] : wanted) {
    if (!connection.nodes.contains(id)) add(connection, *task);
    watch(connection, id);
  }
  note_nodes(connection);
}

void ExposedRobot::add(Connection& connection, const Value& task) {
  const std::string& id = task.find("id")->as_string();
  const std::string name = settings_.name_space + "/" + node_name_of(id);
  if (connection.nodes.size() >= kMostNodes)
    return log_once("task " + segue::quote(id) + " has no node: " + std::to_string(kMostNodes) +
                    " have one; name fewer in the property 'tasks'");
  const auto& nodes = connection.nodes;
  if (std::ranges::any_of(nodes, [&](const auto& one) { return one.second.node->name() == name; }) ||
      name == settings_.own_node) {
    return log_once("task " + segue::quote(id) + " has no node, since another task has the node " + name);
  }
  auto exposed = std::make_shared<ExposedTask>(connection.robot, id, rules_, connection.ends.get_token());
  exposed->set_state(state_in(task));
  auto made =
      ExposedNode::make(participant_, executor_, name, std::move(exposed), settings_.parameter_events->gid());
  if (!made) return log_once("task " + segue::quote(id) + " has no node: " + segue::to_string(made.error()));
  Node node;
  node.node = std::move(*made);
  node.component = task.find("component")->as_string();
  node.number = ++connection.last_number;
  connection.nodes.emplace(id, std::move(node));
}

void ExposedRobot::watch(Connection& connection, const std::string& task) {
  const auto found = connection.nodes.find(task);
  if (found == connection.nodes.end() || std::exchange(found->second.is_watched, true)) return;
  connection.robot->watch(
      {segue::model::TaskId(task), found->second.seen, false},
      segue::Wait(segue::Deadline(kLongWatch), connection.ends.get_token()),
      [inbox = connection.inbox, task, number = found->second.number](Result<RobotLevel> level) {
        inbox->add({task, number, std::move(level)});
      });
}

void ExposedRobot::take_level(Connection& connection, const std::string& task, std::uint64_t number,
                              const Result<RobotLevel>& level) {
  const auto found = connection.nodes.find(task);
  if (found == connection.nodes.end() || found->second.number != number) return;
  Node& node = found->second;
  node.is_watched = false;
  if (level) {
    node.seen = level->level;
    node.node->set_state(level->level.state);
  } else if (level.error().code != segue::ErrorCode::DeadlineExceeded) {
    return;  // it is asked again when the robot says that it has the task still
  }
  watch(connection, task);
}

void ExposedRobot::note_nodes(const Connection& connection) {
  ShownNodes nodes;
  for (const auto& [task, node] : connection.nodes)
    nodes.emplace(task, ShownNode{node.node->name(), node.number});
  {
    const segue::Lock lock(mutex_);
    if (nodes_ == nodes) return;
    nodes_ = std::move(nodes);
  }
  if (connection.parameters != nullptr) connection.parameters->look();
}

void ExposedRobot::log_once(const std::string& message) {
  if (said_.insert(message).second) rules_.log(segue::LogLevel::Warning, message);
}

void ExposedRobot::set_trouble(std::string trouble) {
  {
    const segue::Lock lock(mutex_);
    if (trouble_ == trouble) return;
    trouble_ = std::move(trouble);
  }
  changed_();
}

std::string ExposedRobot::trouble() const {
  const segue::Lock lock(mutex_);
  return trouble_;
}

ExposureStatistics ExposedRobot::statistics() const {
  ExposureStatistics now = executor_.statistics();
  const segue::Lock lock(mutex_);
  now.nodes = static_cast<std::uint32_t>(nodes_.size());
  return now;
}

}  // namespace ros2
