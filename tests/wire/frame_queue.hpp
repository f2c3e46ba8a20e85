// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

namespace segue::wire {

using Time = std::chrono::nanoseconds;  ///< on a clock that never jumps
using Frame = std::vector<std::byte>;

/// What happens to frames in one direction between two stations. Shares are probabilities, 0 to 1.
struct Impairment {
  Time delay{};
  Time jitter{};  ///< a frame takes up to this much longer; frames that are sent in between overtake it
  double loss = 0;
  double duplication = 0;
  double reordering = 0;  ///< this share of frames takes `held_back` longer than the others
  Time held_back{};
  bool cut = false;

  bool operator==(const Impairment&) const = default;
};

/// What happened in one direction. sent + duplicated = delivered + lost + overflowed + what is under way.
struct Count {
  std::uint64_t sent = 0, delivered = 0, lost = 0, duplicated = 0, held_back = 0, overflowed = 0;

  bool operator==(const Count&) const = default;
};

/// The frames that are under way between stations, in the order in which they arrive. It knows no clock:
/// callers say what time it is. The same seed and the same calls give the same arrivals. For one thread.
class FrameQueue {
 public:
  struct Arrival {
    std::size_t to = 0;
    Frame frame;
  };

  /// A direction holds this many frames, like the queue of a network interface; what is sent beyond that is
  /// lost, and counted.
  static constexpr std::size_t kCapacity = 20000;

  FrameQueue(std::size_t stations, std::uint64_t seed);

  std::size_t stations() const { return stations_; }
  Impairment& impairment(std::size_t from, std::size_t to) { return line(from, to).impairment; }
  const Count& count(std::size_t from, std::size_t to) const { return lines_[from * stations_ + to].count; }

  /// A station sends a frame to another one: it is delivered later, once, twice or never.
  void send(std::size_t from, std::size_t to, std::span<const std::byte> frame, Time now);

  /// When the next frame arrives.
  std::optional<Time> next() const;

  /// The next frame that has arrived by now, and is under way no longer.
  std::optional<Arrival> receive(Time now);

  /// Gives back the memory of a frame that is not needed any more.
  void recycle(Frame frame) { spare_.push_back(std::move(frame)); }

 private:
  struct Line {
    Impairment impairment;
    Count count;
    std::size_t under_way = 0;
    std::mt19937_64 random;
  };
  struct Due {
    Time time;
    std::uint64_t order = 0;  ///< frames that are due at one time arrive as they were sent
    std::size_t line = 0;
    Frame frame;
  };

  Line& line(std::size_t from, std::size_t to) { return lines_[from * stations_ + to]; }
  void enqueue(std::size_t line, std::span<const std::byte> frame, Time now);
  static bool later(const Due& left, const Due& right);

  std::size_t stations_;
  std::vector<Line> lines_;
  std::vector<Due> due_;  ///< a heap
  std::vector<Frame> spare_;
  std::uint64_t sent_ = 0;
};

}  // namespace segue::wire
