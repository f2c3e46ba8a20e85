// SPDX-License-Identifier: Apache-2.0
#include "proc_files.hpp"
#include "types.hpp"

#include <segue/base/descriptor.hpp>
#include <segue/task/component.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>

namespace computer {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Tells how busy the computer is that it runs on.
class Monitor final : public Component {
 public:
  Monitor()
      : Component({.doc = "Tells how many processors were idle lately, and how much memory is free",
                   .activity = segue::periodic(std::chrono::milliseconds(500))}) {}

 protected:
  segue::Result<void> on_configure() override {
    for (auto* file : {&stat_, &meminfo_}) {
      const std::string path = *folder_ + "/" + file->name;
      file->descriptor = segue::Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
      if (!file->descriptor.valid()) return segue::fail(segue::ErrorCode::IoError, "cannot read " + path);
    }
    return {};
  }

  segue::Result<void> on_start() override {
    const auto ticks = processor_ticks(stat_.read());
    if (!ticks) return segue::fail(segue::ErrorCode::ParseError, *folder_ + "/stat is not what Linux writes");
    before_ = *ticks;
    return {};
  }

  void on_update() override {
    const auto ticks = processor_ticks(stat_.read());
    const auto memory = memory_bytes(meminfo_.read());
    if (!ticks || !memory) return error("the files in /proc are not what Linux writes");
    // Fewer than before: processors were switched off or on.
    if (ticks->all > before_.all && ticks->idle >= before_.idle) {
      const double idle = static_cast<double>(ticks->idle - before_.idle);
      load_.free_processors = ticks->processors * idle / static_cast<double>(ticks->all - before_.all);
    }
    before_ = *ticks;
    load_.processors = ticks->processors;
    load_.memory = static_cast<double>(memory->total);
    load_.free_memory = static_cast<double>(memory->available);
    load_out_.write(load_);
  }

  void on_cleanup() override {
    stat_.descriptor = segue::Descriptor();
    meminfo_.descriptor = segue::Descriptor();
  }

 private:
  /// A file of /proc, which is read anew each time, into memory that is there.
  struct File {
    const char* name;
    segue::Descriptor descriptor{};
    std::array<char, 65536> text{};

    /// As much as there is room for; empty where it cannot be read.
    std::string_view read() {
      std::size_t size = 0;
      while (size < text.size()) {
        const auto got =
            ::pread(descriptor.get(), text.data() + size, text.size() - size, static_cast<off_t>(size));
        if (got <= 0) break;
        size += static_cast<std::size_t>(got);
      }
      return {text.data(), size};
    }
  };

  OutputPort<Load> load_out_{*this, "load"};
  Property<std::string> folder_{*this, "folder", "/proc", {.doc = "where the files stat and meminfo are"}};
  File stat_{"stat"};
  File meminfo_{"meminfo"};
  ProcessorTicks before_;
  Load load_;
};

}  // namespace computer

SEGUE_COMPONENT(computer::Monitor)
