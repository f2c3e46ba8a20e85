// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace segue::task {

class Component;
class Executor;

struct PortOptions {
  bool dynamic = false;  ///< made in on_configure, gone after on_cleanup
  std::string doc{};
  /// Outputs: hold the last sample, so that a connection with Policy::init begins with it. Costs one slot.
  bool keep_last = true;
};

enum class Direction : std::uint8_t { Input, Output };

enum class WriteResult : std::uint8_t {
  Written,       ///< every connection took it
  NotConnected,  ///< nobody listens
  Refused,       ///< at least one buffer was full; the others took it
  NoSlot         ///< every slot is held by readers; nobody got it
};

enum class ReadStatus : std::uint8_t {
  NoData,   ///< nothing has come yet
  OldData,  ///< the sample that was read last
  NewData   ///< one that was not read before
};

/// Who is told that a new sample waits at an input port.
class SampleListener {
 public:
  virtual void sample_arrived() noexcept = 0;
  /// Where sample_arrived() leads to.
  [[nodiscard]] virtual Executor& runner() noexcept = 0;

 protected:
  ~SampleListener() = default;
};

/// What all ports have in common. A port belongs to a component, whose task alone writes or reads it, from
/// one thread at a time; everything here may be called from any thread. Destroying a port takes its
/// connections off.
class PortBase {
 public:
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Direction direction() const { return direction_; }
  /// nullptr: any type; type_name() is then what was declared, or empty.
  [[nodiscard]] const type::TypeInfo* type() const { return type_; }
  [[nodiscard]] const std::string& type_name() const { return type_name_; }
  [[nodiscard]] bool dynamic() const { return options_.dynamic; }
  [[nodiscard]] const std::string& doc() const { return options_.doc; }
  [[nodiscard]] const PortOptions& options() const { return options_; }
  [[nodiscard]] Component& component() const { return component_; }
  /// "task.port" once the component belongs to a task.
  [[nodiscard]] std::string full_name() const;

 protected:
  PortBase(Component& component, Direction direction, std::string name, const type::TypeInfo* type,
           std::string type_name, PortOptions options);
  ~PortBase();
  Component& component_;

 private:
  std::string name_;
  std::string type_name_;
  PortOptions options_;
  const type::TypeInfo* type_;
  Direction direction_;
};

/// An output port of a type known by its TypeInfo only, or of any type (samples are then blank).
class OutputPortBase : public PortBase {
 public:
  OutputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                 std::string type_name = {}, PortOptions options = {});
  ~OutputPortBase();

  /// Real-time safe: whether anybody listens, samples written, samples lost for want of a slot.
  [[nodiscard]] bool connected() const { return !ends_.empty(); }
  [[nodiscard]] std::uint64_t written() const { return written_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t exhausted() const { return exhausted_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t connection_count() const { return ends_.snapshot().size(); }
  void disconnect_all();

  /// Writes a default value (blank for any type). Real-time safe once every slot was written.
  WriteResult write_default();
  /// Writes what `value` says. Allocates; not for update paths.
  Result<WriteResult> write_value(const type::Value& value);
  /// Writes a copy of an object of the port's type. Real-time safe as far as the type's assignment is.
  WriteResult write_object(const void* object);

  /// For links: puts an end in (AlreadyExists if one leads to the same `reader`, "task.port", with the same
  /// policy), takes it out and waits for the write in progress.
  Result<void> attach(std::shared_ptr<WriterEnd> end, const std::string& reader);
  void detach(const WriterEnd& end);
  /// For links: from now on samples lie in `memory`, where there was none before. ResourceExhausted.
  Result<void> share(const std::shared_ptr<SampleMemory>& memory);
  /// For links: shows the last sample to `accept` while later ones cannot be mistaken for older ones.
  template <class Accept>
  void show_last(Accept accept) {
    const std::lock_guard lock(attach_mutex_);
    SampleSlot* last = last_.exchange(nullptr, std::memory_order_acq_rel);
    if (last == nullptr) return;
    accept(*last);
    SampleSlot* expected = nullptr;
    if (!last_.compare_exchange_strong(expected, last, std::memory_order_acq_rel)) last->release();
  }

 protected:
  /// The writer's side: a slot to write to, nullptr (counted) if none is free; then exactly one of the
  /// others.
  SampleSlot* acquire() noexcept;
  WriteResult publish(SampleSlot* slot) noexcept;
  SamplePool& pool() { return *pool_; }

 private:
  [[nodiscard]] Error out_of_memory() const;

  SamplePool::Handle pool_;
  ConnectionList<WriterEnd> ends_;
  std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint64_t> exhausted_{0};
  std::atomic<SampleSlot*> last_{nullptr};
  std::mutex attach_mutex_;
  void* default_value_ = nullptr;
};

/// An input port of a type known by its TypeInfo only, or of any type.
class InputPortBase : public PortBase {
 public:
  InputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                std::string type_name = {}, PortOptions options = {});
  ~InputPortBase();

  [[nodiscard]] bool connected() const { return !ends_.empty(); }
  [[nodiscard]] std::uint64_t samples_read() const { return read_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t connection_count() const { return ends_.snapshot().size(); }
  void disconnect_all();

  /// Reads as a dynamic value. Allocates; not for update paths. Blank samples are null.
  ReadStatus read_value(type::Value& value);
  /// Drops everything that waits and tells how much it was. Real-time safe.
  std::size_t drain() noexcept;
  /// Whether a sample waits. The reader's thread only; real-time safe.
  [[nodiscard]] bool pending() noexcept;

  /// For links.
  void attach(std::shared_ptr<ReaderEnd> end);
  void detach(const ReaderEnd& end);
  /// For links: wakes the task if this port triggers it. Real-time safe.
  void notify() noexcept {
    if (SampleListener* listener = listener_.load(std::memory_order_seq_cst)) listener->sample_arrived();
  }
  /// For the task: whom notify() tells; nullptr for nobody.
  void set_listener(SampleListener* listener);

 protected:
  /// The next sample, connections taking turns; empty if none waits.
  SampleRef pull() noexcept;
  /// pull(), and what came last if there is nothing new and its connection still stands.
  ReadStatus fetch() noexcept;
  [[nodiscard]] const SampleRef& last() const { return last_; }

 private:
  ConnectionList<ReaderEnd> ends_;
  std::mutex listener_mutex_;  ///< held while ends are told of a listener
  std::atomic<SampleListener*> listener_{nullptr};
  std::atomic<std::uint64_t> read_{0};
  SampleRef last_;
  std::uint64_t last_connection_ = 0;
  std::size_t turn_ = 0;
};

}  // namespace segue::task
