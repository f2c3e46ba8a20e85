// SPDX-License-Identifier: Apache-2.0
//
// Components for fault tests: some that notice whether they are disturbed, and one that does what it should
// not.
#include "faults.hpp"

#include <segue/task/component.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace fault {

using segue::Result;
using segue::task::Component;
using segue::task::InputPort;
using segue::task::Operation;
using segue::task::OutputPort;
using segue::task::Property;
using segue::task::ReadStatus;

/// Writes numbers, without a gap as long as its object lives.
class Beater final : public Component {
 public:
  Beater()
      : Component({.doc = "Writes numbers, without a gap as long as its object lives",
                   .activity = segue::periodic(std::chrono::milliseconds(5))}) {}

 protected:
  void on_update() override {
    ++beat_.number;
    beat_.echo.fill(beat_.number);
    out_.write(beat_);
    words_.write(std::string(static_cast<std::size_t>(*size_), static_cast<char>('a' + beat_.number % 26)));
  }

 private:
  OutputPort<Beat> out_{*this, "out"};
  OutputPort<std::string> words_{*this, "words"};
  Property<int> size_{*this, "size", 100};
  Beat beat_ = [this] {
    Beat beat;
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    beat.incarnation = static_cast<std::uint64_t>(now) ^ reinterpret_cast<std::uintptr_t>(this);
    return beat;
  }();
};

/// Hands on what it gets.
class Relay final : public Component {
 public:
  Relay() : Component({.doc = "Hands on what it gets"}) {}

 protected:
  void on_update() override {
    Beat beat;
    while (in_.read(beat) == ReadStatus::NewData)
      out_.write(beat);
  }

 private:
  InputPort<Beat> in_{*this, "in"};
  OutputPort<Beat> out_{*this, "out"};
  Property<double> gain_{*this, "gain", 1.0};
};

/// Notices whatever is wrong with what it gets.
class Watcher final : public Component {
 public:
  Watcher() : Component({.doc = "Notices whatever is wrong with what it gets"}) {}

 protected:
  Result<void> on_start() override {
    ++report_.starts;
    return {};
  }
  void on_update() override {
    while (in_.read(beat_) == ReadStatus::NewData)
      look_at(beat_);
    while (words_.read(text_) == ReadStatus::NewData) {
      ++report_.words;
      if (text_.find_first_not_of(text_.front()) != std::string::npos) ++report_.torn;
    }
  }

 private:
  void look_at(const Beat& beat) {
    ++report_.beats;
    for (const std::uint64_t echo : beat.echo) {
      if (echo != beat.number) {
        ++report_.torn;
        break;
      }
    }
    if (beat.incarnation != incarnation_) {
      report_.restarts += incarnation_ == 0 ? 0 : 1;
      incarnation_ = beat.incarnation;
    } else if (beat.number != report_.last + 1) {
      report_.gaps += 1;
    }
    report_.last = beat.number;
  }

  InputPort<Beat> in_{*this, "in"};
  InputPort<std::string> words_{*this, "words"};
  Report report_;
  std::uint64_t incarnation_ = 0;
  Beat beat_;
  std::string text_;
  Operation<Report()> ask_{*this, "report", {}, [this] { return report_; }};
};

/// Does in one of its hooks what it should not.
class Faulty final : public Component {
 public:
  Faulty()
      : Component({.doc = "Does in one of its hooks what it should not",
                   .activity = segue::periodic(std::chrono::milliseconds(5))}) {}

 protected:
  Result<void> on_configure() override { return at("configure"); }
  Result<void> on_start() override { return at("start"); }
  void on_update() override {
    out_.write(1);
    static_cast<void>(at("update"));
  }
  void on_stop() override { static_cast<void>(at("stop")); }
  void on_cleanup() override { static_cast<void>(at("cleanup")); }

 private:
  Result<void> at(const std::string& hook) {
    if (hook != *hook_) return {};
    if (!reached_->empty()) ::close(::creat(reached_->c_str(), 0600));
    if (*how_ == "error") return segue::fail(segue::ErrorCode::HookFailed, "refused, as requested");
    if (*how_ == "throw") throw std::runtime_error("thrown, as requested");
    if (*how_ == "exhaust") exhaust();
    if (*how_ == "abort") std::abort();
    if (*how_ == "exit") std::_Exit(3);
    if (*how_ == "crash") crash();
    if (*how_ == "freeze") std::raise(SIGSTOP);
    if (*how_ == "hang") hang();
    return {};
  }
  /// Until the process is killed.
  [[noreturn]] static void hang() {
    while (true)
      ::pause();
  }
  static void crash() {
    std::signal(SIGSEGV, SIG_DFL);  // sanitizers have a handler of their own
    std::raise(SIGSEGV);
  }
  /// Until the process gets no more. Ends by std::bad_alloc where its memory is limited.
  void exhaust() {
    while (true) {
      hoard_.emplace_back(std::size_t{1} << 24, 'x');
    }
  }

  OutputPort<int> out_{*this, "out"};
  Property<std::string> hook_{*this, "hook", ""};
  Property<std::string> how_{*this, "how", "", segue::task::PropertyOptions{.live = true, .doc = {}}};
  Property<std::string> reached_{
      *this, "reached", "",
      segue::task::PropertyOptions{.live = false, .doc = "A file that is made when the hook begins"}};
  std::vector<std::string> hoard_;
};

}  // namespace fault

SEGUE_COMPONENT(fault::Beater)
SEGUE_COMPONENT(fault::Relay)
SEGUE_COMPONENT(fault::Watcher)
SEGUE_COMPONENT(fault::Faulty)
