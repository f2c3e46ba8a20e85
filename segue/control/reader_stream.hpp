// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/sample_stream.hpp>

#include <memory>
#include <utility>

namespace segue::control {

/// Offers the samples that a reader of a port gets as a stream.
class ReaderStream final : public SampleStream {
 public:
  explicit ReaderStream(std::unique_ptr<task_host::PortReader> reader) : reader_(std::move(reader)) {}
  Result<std::vector<type::Value>> read(std::size_t limit, const Wait& /*wait*/) override {
    return reader_->read(limit);
  }
  void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) override {
    reader_->next(limit, wait, std::move(answered));
  }
  [[nodiscard]] std::string type_name() const override { return reader_->type_name(); }

 private:
  const std::unique_ptr<task_host::PortReader> reader_;
};

}  // namespace segue::control
