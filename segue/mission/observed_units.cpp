// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/observed_units.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/model/condition_parts.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace segue::mission {

using type::Value;

std::uint32_t units_in(const SampleCounts& counts, const Value& sample) {
  const Value* number = model::find_field(sample, counts.field);
  if (number == nullptr || !number->is_number()) return 0;
  const double units = std::floor(number->as_double());
  if (!(units > 0)) return 0;
  return units < kAllUnits ? static_cast<std::uint32_t>(units) : kAllUnits;
}

const std::string& task_of(const ObservedUnits& observed) {
  if (const auto* counts = std::get_if<SampleCounts>(&observed)) return counts->port.task;
  return model::task_of(std::get<model::RobotCondition>(observed));
}

std::string unshown_text(std::string_view resource, const ObservedUnits& observed, std::uint32_t needed,
                         std::uint32_t shown) {
  const std::string text = "waits for " + counted(needed, "unit") + " of the resource " + quote(resource);
  if (const auto* counts = std::get_if<SampleCounts>(&observed)) {
    return text + ", of which the robot shows " + std::to_string(shown) + ": " +
           model::field_text(counts->field) + " of " + to_string(counts->port);
  }
  return text + ", which the robot does not show: " + denial(std::get<model::RobotCondition>(observed));
}

namespace detail {

std::optional<model::RobotCondition> read_one_condition(Fields& fields, std::string_view forms,
                                                        const Source& source) {
  auto found = model::detail::read_conditions(fields, source);
  if (found.size() == 1) return std::move(found.front());
  source.error("bad-observe", fields.what() + ": expected exactly one of " + std::string(forms),
               fields.value());
  return std::nullopt;
}

namespace {

std::optional<SampleCounts> read_counts(Fields& fields, const Source& source) {
  const Value* port = fields.require("port", "the port whose samples say how many units there are");
  const std::string field = fields.text("units");
  auto parts = model::parse_field(field);
  if (!parts) {
    source.error("bad-observe",
                 fields.what() +
                     ": 'units' must be a field of the sample such as 'cores.free', or 'value', " +
                     "the sample itself, not " + quote(field),
                 fields.value());
  }
  if (port == nullptr || !parts) return std::nullopt;
  const std::string text = model::detail::scalar_text(*port).value_or("");
  return SampleCounts{model::detail::read_member(text, "computer.load", fields.what(), *port, source),
                      std::move(*parts)};
}

}  // namespace

std::optional<ObservedUnits> read_observed_units(Fields& resource, const Source& source) {
  const Value* value = resource.find("observe", Value::Kind::Map);
  if (value == nullptr) return std::nullopt;
  Fields fields(*value, "'observe' of " + resource.what(), source);
  std::optional<ObservedUnits> observed;
  if (fields.find("units") != nullptr) {
    observed = read_counts(fields, source);
  } else {
    observed =
        read_one_condition(fields, "{task, state}, {port, where}, {port, units} and {call, is}", source);
  }
  fields.finish();
  return observed;
}

Value write_observed_units(const ObservedUnits& observed) {
  if (const auto* counts = std::get_if<SampleCounts>(&observed))
    return Value::map({{"port", to_string(counts->port)}, {"units", model::field_text(counts->field)}});
  return model::detail::write_condition(std::get<model::RobotCondition>(observed));
}

}  // namespace detail
}  // namespace segue::mission
