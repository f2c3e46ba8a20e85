// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace segue::mission {
class Engine;
}  // namespace segue::mission

namespace segue::mission_run {

/// Steers a run: pauses it and, where it runs sequentially, steps it, sets breakpoints, goes on elsewhere and
/// looks at values (see mission::Engine). All functions may be called from any thread, before, during and
/// after the run.
class RunControl {
 public:
  /// While it is paused no state or action begins; those that run continue. A run that a breakpoint or a step
  /// has stopped is paused, too.
  void pause();
  void resume();
  [[nodiscard]] bool paused() const;

  enum class Step : std::uint8_t { Into, Over, Out, Back };
  /// Called once, from any thread: when it was carried out, or why it was not. InvalidState where nothing
  /// runs, or the run ends before; Unsupported for a concurrent run; else as of mission::Engine.
  using Done = std::function<void(Result<void>)>;
  /// Of all that is held; what runs beside that, such as a watch, goes on. InvalidState where nothing is
  /// held, and for a step back also where something of the run is under way.
  void step(Step step, Done done);
  /// In place of those set before.
  void set_breakpoints(std::vector<std::string> paths, Done done);
  void go_on_at(std::string path, Done done);
  /// Tells `done` the values of the ports of a state, as JSON; an error where no run has them.
  void values_of(std::string path, std::function<void(Result<type::Value>)> done);

  /// Where a run is, and which steps it can take.
  struct Position {
    bool steps = false;                            ///< it can be stepped: it runs sequentially
    bool back = false;                             ///< and be stepped back
    std::optional<std::vector<std::string>> at{};  ///< it is held before these states
    std::vector<std::string> breakpoints{};
    friend bool operator==(const Position&, const Position&) = default;
  };
  [[nodiscard]] Position position() const;

  /// The means to steer a run.
  struct Run {
    std::function<void(bool paused)> set_paused{};  ///< of a concurrent run; from any thread
    mission::Engine* engine = nullptr;              ///< of a sequential one
    bool back = false;                              ///< it can be stepped back
    std::vector<std::string> breakpoints{};         ///< with which it begins
  };
  /// For runs, one at a time: what was asked for before is heeded from now on. Nothing of `run` is used any
  /// more when this has been destroyed.
  class Attachment {
   public:
    Attachment(RunControl* control, Run run);
    ~Attachment();
    Attachment(const Attachment&) = delete;
    Attachment& operator=(const Attachment&) = delete;
    /// On the engine's thread: it is held there. False: as it was already, with nothing but questions in
    /// between.
    bool held_at(std::vector<std::string> paths);

   private:
    RunControl* const control_;
  };

 private:
  using Task = std::function<Result<type::Value>(mission::Engine&)>;
  using Answer = std::function<void(Result<type::Value>)>;

  void set_paused(bool paused);
  void follow_request() SEGUE_REQUIRES(mutex_);
  void ask(Task task, Answer answer, bool moves);
  void carry_out(std::uint64_t number, mission::Engine& engine, const Task& task, bool moves);
  [[nodiscard]] std::optional<Error> refusal() const SEGUE_REQUIRES(mutex_);

  mutable Mutex mutex_;  ///< protects all below; held while `set_paused` of a run is called
  bool pause_requested_ SEGUE_GUARDED_BY(mutex_) = false;  ///< to be paused
  std::optional<Run> run_ SEGUE_GUARDED_BY(mutex_);
  Position position_ SEGUE_GUARDED_BY(mutex_);
  /// How often the engine has been told to resume and has not done so yet.
  int resuming_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t asked_ SEGUE_GUARDED_BY(mutex_) = 0;                  ///< questions so far
  std::map<std::uint64_t, Answer> waiting_ SEGUE_GUARDED_BY(mutex_);  ///< for their answers
};

}  // namespace segue::mission_run
