// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <cstddef>
#include <memory>
#include <set>
#include <utility>
#include <vector>

namespace segue::mission {

/// A port whose samples the test says. Must outlive its readers.
class FakePort {
 public:
  void show(type::Value sample) {
    const Lock lock(mutex_);
    samples_.push_back(std::move(sample));
    for (Reader* reader : readers_)
      reader->answer();
  }
  /// Reads the samples from the first one on.
  std::unique_ptr<PortSamples> open() { return std::make_unique<Reader>(*this); }

 private:
  class Reader final : public PortSamples {
   public:
    explicit Reader(FakePort& port) : port_(port) {
      const Lock lock(port_.mutex_);
      port_.readers_.insert(this);
    }
    ~Reader() override {
      const Lock lock(port_.mutex_);
      port_.readers_.erase(this);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    Result<std::vector<type::Value>> take(const Wait& /*wait*/) override {
      const Lock lock(port_.mutex_);
      return unread();
    }
    void next(const Wait& /*wait*/, SamplesAnswer answered) override {
      const Lock lock(port_.mutex_);
      answered_ = std::move(answered);
      answer();
    }
    /// Requires the port's lock, as unread() does.
    void answer() {
      if (answered_ && taken_ < port_.samples_.size()) std::exchange(answered_, {})(unread());
    }

   private:
    std::vector<type::Value> unread() {
      const auto first = port_.samples_.begin() + static_cast<std::ptrdiff_t>(taken_);
      taken_ = port_.samples_.size();
      return {first, port_.samples_.end()};
    }

    FakePort& port_;
    std::size_t taken_ = 0;
    SamplesAnswer answered_;
  };

  Mutex mutex_;  ///< protects all below
  std::vector<type::Value> samples_;
  std::set<Reader*> readers_;
};

}  // namespace segue::mission
