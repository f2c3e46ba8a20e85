// SPDX-License-Identifier: Apache-2.0
// Properties: one that may be set while the task runs, and one that decides which ports there are.
#include <segue/task/component.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace properties {

using namespace segue::task;

/// Writes the number of each channel, times the gain, to a port of the channel.
class Mixer final : public Component {
 public:
  Mixer()
      : Component({.doc = "Writes one level for each channel",
                   .activity = segue::periodic(std::chrono::milliseconds(10))}) {
    dynamic_outputs<double>("level_\\d+", "one for each channel");  // lets `segue check` know their names
  }

 private:
  /// The configuration does not change until on_cleanup(), so this is the place to make what depends on it.
  segue::Result<void> on_configure() override {
    for (int i = 1; i <= *channels_; ++i)
      levels_.push_back(std::make_unique<OutputPort<double>>(*this, "level_" + std::to_string(i),
                                                             PortOptions{.dynamic = true}));
    return {};
  }
  /// A live property may have another value in each update, never within one.
  void on_update() override {
    for (std::size_t i = 0; i < levels_.size(); ++i)
      levels_[i]->write(*gain_ * static_cast<double>(i + 1));
  }
  void on_cleanup() override { levels_.clear(); }

  Property<int> channels_{*this, "channels", 2, {.doc = "how many ports there are"}};
  Property<double> gain_{*this, "gain", 1.0, {.live = true, .doc = "factor of all levels"}};
  std::vector<std::unique_ptr<OutputPort<double>>> levels_;
};

}  // namespace properties

SEGUE_COMPONENT(properties::Mixer)
