// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "conversions.hpp"
#include "room.hpp"

#include <segue/task/component.hpp>
#include <segue/task/sub_state.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ros2_messages {

/// Samples of `in` as another type, at `out`. One that cannot be converted is left out, which is an error
/// until the next one that can.
template <class From, class To>
class Converter : public segue::task::Component {
 protected:
  /// `most`: the default of the property, for messages with elements.
  Converter(std::string doc, std::uint32_t most)
      : Component(segue::task::ComponentOptions{.doc = std::move(doc), .trigger_on = {"in"}}),
        most_(*this, "most", most,
              {.doc =
                   "elements that a sample has at most, for which memory is kept; larger ones are refused"}) {
  }

  segue::Result<void> on_configure() override {
    names_ = names();
    out_.prime(largest<To>(*most_, names_));
    return {};
  }
  void on_update() override {
    if (const Problem problem = convert_all(); problem != nullptr) error(refused_, problem);
  }
  void on_error() override {
    if (convert_all() == nullptr) recovered();
  }
  /// As the properties say.
  virtual Names names() const { return {}; }

 private:
  /// The problem of the last sample; also of one that has come before.
  Problem convert_all() {
    constexpr int kMost = 64;  // the executor gives another turn where there are more
    for (int i = 0; i < kMost; ++i) {
      const auto sample = in_.take();
      if (!sample) break;
      problem_ = convert_one(*sample);
    }
    return problem_;
  }

  Problem convert_one(const From& from) {
    if (elements(from) > *most_) return "the sample has more elements than the property 'most' allows";
    auto to = out_.loan();
    if (!to) return nullptr;  // readers hold all of them
    const Problem problem = convert(from, *to, names_);
    if (problem == nullptr) to.publish();
    return problem;
  }

  segue::task::Property<std::uint32_t> most_;
  segue::task::InputPort<From> in_{*this, "in"};
  segue::task::OutputPort<To> out_{*this, "out"};
  segue::task::ErrorState refused_{*this, "refused"};
  Names names_;
  Problem problem_ = nullptr;
};

/// With a property for the frame of the header.
template <class From, class To>
class FramedConverter : public Converter<From, To> {
 protected:
  FramedConverter(std::string doc, std::uint32_t most, std::string frame)
      : Converter<From, To>(std::move(doc), most),
        frame_(*this, "frame", std::move(frame), {.doc = "frame of the header"}) {}
  Names names() const override { return {*frame_, {}, {}}; }

 private:
  segue::task::Property<std::string> frame_;
};

/// With properties for the frame of the header, and for that which moves in it.
template <class From, class To>
class MovingConverter : public Converter<From, To> {
 protected:
  explicit MovingConverter(std::string doc) : Converter<From, To>(std::move(doc), 0) {}
  Names names() const override { return {*frame_, *child_, {}}; }

 private:
  segue::task::Property<std::string> frame_{*this, "frame", "odom", {.doc = "frame of the header"}};
  segue::task::Property<std::string> child_{*this, "child", "base_link", {.doc = "frame that moves in it"}};
};

/// With a property for the names of joints.
template <class From, class To>
class JointConverter : public Converter<From, To> {
 protected:
  explicit JointConverter(std::string doc) : Converter<From, To>(std::move(doc), 64) {}
  Names names() const override { return {{}, {}, *joints_}; }

 private:
  segue::task::Property<std::vector<std::string>> joints_{
      *this, "joints", {}, {.doc = "their names, in the order of their driver"}};
};

}  // namespace ros2_messages
