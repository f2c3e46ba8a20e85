// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/task/connection_list.hpp>
#include <segue/task/port_options.hpp>
#include <segue/task/sample.hpp>
#include <segue/task/sample_stamps.hpp>
#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace segue::task {

class Component;
class ReaderEnd;
class SampleListener;
class WriterEnd;

enum class Direction : std::uint8_t { Input, Output };

enum class WriteResult : std::uint8_t {
  Written,       ///< every connection took it
  NotConnected,  ///< there is no connection
  Refused,       ///< at least one buffer was full; other connections took it
  NoSlot         ///< readers hold all slots; no connection got it
};

enum class ReadStatus : std::uint8_t {
  NoData,   ///< nothing has arrived yet
  OldData,  ///< the sample that was read last
  NewData   ///< a sample that has not been read before
};

/// Base of all ports. A port belongs to a component, and only its task writes or reads it, from one thread at
/// a time; everything here may be called from any thread. Destroying a port disconnects it.
class PortBase {
 public:
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Direction direction() const { return direction_; }
  /// nullptr: any type; type_name() is then the declared name, or empty.
  [[nodiscard]] const type::TypeInfo* type() const { return type_; }
  [[nodiscard]] const std::string& type_name() const { return type_name_; }
  [[nodiscard]] bool dynamic() const { return options_.dynamic; }
  [[nodiscard]] const std::string& doc() const { return options_.doc; }
  [[nodiscard]] const PortOptions& options() const { return options_; }
  /// Whether samples are in the flat layout: PortOptions::flat, and a type for which that is of use.
  [[nodiscard]] bool is_flat() const { return options_.flat; }
  [[nodiscard]] Component& component() const { return component_; }
  /// Unique within the process: no port ever has the number of another one, whatever their addresses.
  [[nodiscard]] std::uint64_t number() const { return number_; }
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
  const std::uint64_t number_;
  Direction direction_;
};

/// An output port whose type is known by its TypeInfo only, or of any type (its samples carry no value then).
class OutputPortBase : public PortBase {
 public:
  OutputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                 std::string type_name = {}, PortOptions options = {});
  ~OutputPortBase();

  /// Whether there is a connection; samples written; samples lost because no slot was free. Real-time safe.
  [[nodiscard]] bool connected() const { return !ends_.empty(); }
  [[nodiscard]] std::uint64_t written() const { return written_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t exhausted() const { return exhausted_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t connection_count() const;
  /// Whether samples would reach nobody yet: all connections wait for the commit of the transition that
  /// starts this task. For who writes what comes once. The writer's thread only; real-time safe.
  [[nodiscard]] bool dormant() noexcept;
  /// Removes all connections, and waits for a write in progress; not for update paths. A robot makes those of
  /// its controller again.
  void disconnect_all();

  /// Writes a default value (none for any type). Real-time safe once every slot was written.
  WriteResult write_default();
  /// Writes a dynamic value. Allocates; not for update paths.
  Result<WriteResult> write_value(const type::Value& value);
  /// Writes a copy of an object of the port's type. Real-time safe as far as the type's assignment is.
  WriteResult write_object(const void* object);

 protected:
  /// For the writer: a slot to write to, which publish() or SampleSlot::release() must follow; nullptr,
  /// counted, if none is free. Not for flat ports.
  SampleSlot* acquire() noexcept;
  /// For the writer of a flat port: a slot with room for `size` bytes, which publish() or
  /// SampleSlot::release() must follow. Allocates, so a slot is always free; may throw std::bad_alloc.
  SampleSlot* acquire_flat(std::size_t size);
  WriteResult publish(SampleSlot* slot) noexcept;
  /// For the writer: fills every free slot, and all slots that later connections add, with a copy of
  /// `example`, an object of the port's type. Allocates. Not for flat ports, nor for those of any type.
  void prime_slots(const void* example);

 private:
  friend class OutputPortAccess;

  /// The slot being written and that of the last sample.
  static constexpr std::size_t kWriterSlots = 2;
  WriteResult write_flat(const void* object);

  std::unique_ptr<SamplePool, detail::RetirePool> pool_;
  ConnectionList<WriterEnd> ends_;
  std::atomic<std::uint64_t> written_{0};    ///< relaxed: one thread counts; others may read an older value
  std::atomic<std::uint64_t> exhausted_{0};  ///< relaxed for the same reason, as is read_
  detail::SampleStamps stamps_;
  /// Owns a reference. Whoever takes a slot out by an exchange owns that reference. K1: exchanges are
  /// acquire-release, so whoever takes a slot out sees its content.
  std::atomic<SampleSlot*> last_{nullptr};
  Mutex attach_mutex_;  ///< serializes attach() and show_last() of OutputPortAccess
  void* default_value_ = nullptr;
};

/// An input port whose type is known by its TypeInfo only, or of any type.
class InputPortBase : public PortBase {
 public:
  InputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                std::string type_name = {}, PortOptions options = {});
  ~InputPortBase();

  [[nodiscard]] bool connected() const { return !ends_.empty(); }
  [[nodiscard]] std::uint64_t samples_read() const { return read_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t connection_count() const;
  void disconnect_all();  ///< as that of OutputPortBase, but waits for a read in progress

  /// Reads as a dynamic value; untyped samples are null. Allocates; not for update paths.
  ReadStatus read_value(type::Value& value);
  /// Drops all waiting samples and returns their number. Real-time safe.
  std::size_t drain() noexcept;
  /// Whether a sample waits. The reader's thread only; real-time safe.
  [[nodiscard]] bool pending() noexcept;

 protected:
  /// The next sample, taking turns among connections; empty if none waits.
  SampleRef pull() noexcept;
  /// Fetches the next sample like pull(), but keeps the last one if there is no new one and its connection
  /// still exists.
  ReadStatus fetch() noexcept;
  [[nodiscard]] const SampleRef& last() const { return last_; }

 private:
  friend class InputPortAccess;

  ConnectionList<ReaderEnd> ends_;
  Mutex listener_mutex_;  ///< serializes changes of listener_, so that all ends get the same one
  std::atomic<SampleListener*> listener_{nullptr};
  std::atomic<std::uint64_t> read_{0};
  SampleRef last_;
  std::uint64_t last_connection_ = 0;
  std::size_t turn_ = 0;
};

}  // namespace segue::task
