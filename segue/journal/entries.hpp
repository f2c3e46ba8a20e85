// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/action_times.hpp>
#include <segue/model/transition.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The journal of a robot: its requests and transitions, and what missions did, in a file that outlives the
/// robot.
namespace segue::journal {

/// The outcome of a successful action. Only such actions give duration samples.
inline constexpr const char* kDone = "done";

/// One action of an executed transition.
struct ActionEntry {
  int id = 0;  ///< in its transition
  model::ActionKind kind = model::ActionKind::Recover;
  model::Phase phase = model::Phase::Commit;
  std::string label;      ///< "stop area_explorer"
  std::string component;  ///< as in model::ActionKey
  model::HostName host;
  model::ProcessName process;  ///< empty: the runtime's own
  Duration started{0};         ///< since the begin of the execution
  Duration waited{0};          ///< after its predecessors had ended: for others of its batch, and in transit
  Duration duration{0};
  std::optional<Duration> ended{};  ///< reported, as `started`; nothing: not recorded
  std::string outcome;              ///< "done", "failed", "skipped"
  std::string error;

  friend bool operator==(const ActionEntry&, const ActionEntry&) = default;
};

/// The predicted durations of a transition before its execution.
struct Prediction {
  model::DurationRange total;
  model::DurationRange commit;
  friend bool operator==(const Prediction&, const Prediction&) = default;
};

/// The tasks that a transition found prepared ahead, and what its prepare phase would have taken without
/// them: with durations as they were measured when they were prepared, or else learned ones.
struct PreparedAhead {
  std::size_t tasks = 0;
  Duration unprepared{0};

  /// The time that preparing ahead saved a transition whose prepare phase took `prepare`; at least zero.
  [[nodiscard]] Duration saved(Duration prepare) const {
    return unprepared > prepare ? unprepared - prepare : Duration(0);
  }
  friend bool operator==(const PreparedAhead&, const PreparedAhead&) = default;
};

/// The result of a request. `total` is from the begin of the execution to the end of its last action, without
/// solving.
struct TransitionEntry {
  std::uint64_t request = 0;
  std::chrono::system_clock::time_point time;  ///< when it ended
  std::string cause;                           ///< "request", "repair", "fallback" ...
  std::string who;                             ///< sent the request; may be empty
  std::string from;
  std::string to;
  std::string runs;  ///< the controller that runs since then
  /// The versions of those three (model::Network::version); empty: none, or not known.
  std::string from_version{};
  std::string to_version{};
  std::string runs_version{};
  std::string order;
  std::string outcome;  ///< "done", "superseded", "refused", "failed", "cancelled" ...
  std::string undone;   ///< if it failed or was cancelled: "restored", "fell back to 'safe'" ...
  std::string error;
  Duration solve{0};
  Duration total{0};
  Duration prepare{0};
  Duration commit{0};
  Duration retire{0};
  std::optional<Prediction> predicted;
  std::optional<PreparedAhead> ahead{};  ///< nothing: it found no tasks prepared
  std::string cancelled_by{};            ///< outcome "cancelled"
  std::optional<Duration> lasted{};      ///< its execution, undoing included; nothing: not recorded
  /// The networks that ran before and afterwards, as written by network_text(); empty: not recorded.
  std::string before{};
  std::string after{};
  std::vector<ActionEntry> actions;
  std::vector<ActionEntry> undo_actions{};  ///< that undid it, in the order of their execution

  friend bool operator==(const TransitionEntry&, const TransitionEntry&) = default;
};

/// An accepted request. If there is no transition of the same number, the runtime ended before its result.
struct RequestEntry {
  std::uint64_t request = 0;
  std::chrono::system_clock::time_point time;
  std::string who;
  std::string what;  ///< the network's name
  friend bool operator==(const RequestEntry&, const RequestEntry&) = default;
};

/// An event of a mission that commanded the robot: the mission or one of its actions began or ended, or an
/// action asked for a controller.
struct MissionEntry {
  enum class Kind { Began, Asked, Ended };

  std::chrono::system_clock::time_point time;
  Kind kind = Kind::Began;
  std::string who;              ///< ran the mission
  std::string mission;          ///< its name
  std::string action{};         ///< "fetch/grasp"; empty: the mission itself
  std::uint64_t iteration = 0;  ///< how often that action had begun before
  std::string controller{};     ///< Asked
  /// Ended: of the mission or the action; "lost" where a mission did not say how it ended.
  std::string outcome{};
  std::string error{};   ///< Ended: why it aborted; else empty
  Duration duration{0};  ///< Ended: since it began
  /// Began, of the mission itself: how it runs, "sequential" or "concurrent"; empty: it did not say.
  std::string mode{};

  friend bool operator==(const MissionEntry&, const MissionEntry&) = default;
};
inline constexpr std::array<std::string_view, 3> kMissionKindNames = {"began", "asked", "ended"};
constexpr std::string_view to_string(MissionEntry::Kind kind) {
  return kMissionKindNames.at(static_cast<std::size_t>(kind));
}
/// The outcome of a mission that did not say how it ended.
inline constexpr const char* kLost = "lost";

/// Drift: a difference between the observed and the desired network, and how it was handled.
struct DifferenceEntry {
  std::chrono::system_clock::time_point time;
  std::string subject;   ///< task, process or connection
  std::string sentence;  ///< "task 'slam' is in exception"
  std::string done;      ///< "reported", "restarted" ...; may be empty
  friend bool operator==(const DifferenceEntry&, const DifferenceEntry&) = default;
};

/// A version of a controller that a robot loaded or was sent. Recorded once, however often it is loaded.
struct VersionEntry {
  std::chrono::system_clock::time_point time;  ///< when it was first loaded
  std::string controller;                      ///< its name
  std::string version;                         ///< model::Network::version
  std::string file;                            ///< where it was read from
  std::string text;                            ///< the network as a file; empty where it has more than 1 MiB
  friend bool operator==(const VersionEntry&, const VersionEntry&) = default;
};

/// The runtime of the robot began to observe it, or ended.
struct RunningEntry {
  enum class Kind { Began, Ended };
  std::chrono::system_clock::time_point time;
  Kind kind = Kind::Began;
  std::string controller{};  ///< that ran when it began
  std::string network{};     ///< what ran then, as TransitionEntry::before; empty: not recorded
  friend bool operator==(const RunningEntry&, const RunningEntry&) = default;
};

/// Entries were lost, because the disk was full or the file could not be written.
struct GapEntry {
  std::chrono::system_clock::time_point time;  ///< when writing resumed
  std::uint64_t lost = 0;
  std::string reason;
  friend bool operator==(const GapEntry&, const GapEntry&) = default;
};

/// The samples that a transition adds to the statistics: durations and waits of its successful actions.
struct DurationSamples {
  std::vector<std::pair<model::ActionKey, Duration>> actions;
  std::vector<Duration> waits;
};
DurationSamples duration_samples(const TransitionEntry& entry);

}  // namespace segue::journal
