// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/world_view.hpp>
#include <segue/mission_script/scripted_data.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <memory>
#include <string>

namespace segue::mission::detail {

/// The data that one execution of a script finds attached to the world, and that its process is to compute
/// (ScriptedData). One thread at a time.
class ScriptData {
 public:
  explicit ScriptData(const WorldView& world);
  [[nodiscard]] type::Value names() const;
  /// The next changes to compute of the data "name": "value" has "base", "changes" as lists of sign and fact,
  /// function and arguments, "script", and "is_last". A request with "value" says what those of the answer
  /// before have come to; the answer is null where they were the last. Or else "error" and "code".
  type::ValueMap answer(const type::Value& request);

 private:
  struct Reading {
    std::shared_ptr<const ScriptedData> data;
    ScriptedData::Task task{};
  };
  std::map<std::string, Reading, std::less<>> readings_;
};

}  // namespace segue::mission::detail
