// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/call_check.hpp>

#include <segue/base/diagnostic.hpp>
#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/model/argument_names.hpp>
#include <segue/type/conform.hpp>

#include <string>

namespace segue::solve::detail {

namespace {

Error wrong_call(std::string message) {
  return fail(ErrorCode::InvalidArgument, std::move(message));
}

/// Checks what is given as arguments, but for their types.
Result<> check_names(const model::OperationModel& operation, const type::Value& given) {
  const std::string what = "operation " + quote(operation.name);
  const std::size_t size = operation.arguments.size();
  if (given.is_list() && given.as_list().size() != size) {
    return wrong_call(what + " has " + std::to_string(size) + " arguments, and gets " +
                      std::to_string(given.as_list().size()));
  }
  if (given.is_list()) return {};
  if (!given.is_map() && !given.is_null())
    return wrong_call(what + " gets its arguments as a map or a list, not as " + type::describe(given));
  const auto problems = model::check_argument_names(operation, given);
  return problems.empty() ? Result<>() : wrong_call(what + ' ' + problems.front().text);
}

}  // namespace

Result<> check_call(const model::CallAction& call, const model::ComponentModel& component,
                    const type::TypeRegistry& types) {
  const model::OperationModel* operation = component.find_operation(call.operation);
  if (operation == nullptr && component.incomplete) return {};
  if (operation == nullptr) {
    return wrong_call("component " + quote(component.name.str()) + " has no operation " +
                      quote(call.operation) + did_you_mean(call.operation, names_of(component.operations)));
  }
  if (auto named = check_names(*operation, call.arguments); !named) return named;
  Diagnostics found;
  for (std::size_t i = 0; i < operation->arguments.size(); ++i) {
    const auto& [name, type_name, doc] = operation->arguments[i];
    const type::Type* type = types.find(type_name);
    const type::Value* value =
        call.arguments.is_list() ? &call.arguments.as_list()[i] : call.arguments.find(name);
    if (type != nullptr && value != nullptr)
      type::check_value(*value, *type, call.operation + "(" + name + ")", {}, found);
  }
  if (found.has_errors()) return wrong_call(found.items().front().message);
  return {};
}

}  // namespace segue::solve::detail
