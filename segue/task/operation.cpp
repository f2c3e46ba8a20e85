// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/component.hpp>
#include <segue/task/operation.hpp>

#include <algorithm>

namespace segue::task {

namespace {

std::vector<std::string> argument_names(const OperationInfo& info) {
  std::vector<std::string> names;
  for (const OperationArgument& argument : info.arguments)
    names.push_back(argument.name);
  return names;
}

std::string signature(const OperationInfo& info) {
  std::string text = info.name + "(";
  for (const OperationArgument& argument : info.arguments) {
    if (text.back() != '(') text += ", ";
    text += argument.name + ": " + (argument.type_name.empty() ? "any" : argument.type_name);
  }
  return text + ")";
}

Error wrong_arguments(const OperationInfo& info, const std::string& what) {
  return fail(ErrorCode::InvalidArgument, "operation " + signature(info) + ": " + what);
}

}  // namespace

OperationBase::OperationBase(Component& component, OperationInfo info)
    : component_(component), info_(std::move(info)) {
  component_.operations_.push_back(this);
}

OperationBase::~OperationBase() {
  std::erase(component_.operations_, this);
}

Result<std::vector<const type::Value*>> OperationBase::ordered(const type::Value& arguments) const {
  std::vector<const type::Value*> values;
  const std::size_t wanted = info_.arguments.size();
  const bool listed_in_order = arguments.is_list();
  const std::size_t given = listed_in_order      ? arguments.as_list().size()
                            : arguments.is_map() ? arguments.as_map().size()
                                                 : 0;
  if (!listed_in_order && !arguments.is_map() && !arguments.is_null()) {
    return wrong_arguments(info_, "give arguments as a map or a list, not as " + type::describe(arguments));
  }
  if (arguments.is_map()) {
    for (const auto& [name, value] : arguments.as_map()) {
      const auto is_named = [&name = name](const OperationArgument& argument) {
        return argument.name == name;
      };
      if (std::ranges::any_of(info_.arguments, is_named)) continue;
      return wrong_arguments(info_, "no argument " + quote(name) + did_you_mean(name, argument_names(info_)));
    }
    for (const OperationArgument& argument : info_.arguments) {
      const type::Value* value = arguments.find(argument.name);
      if (value == nullptr) return wrong_arguments(info_, "argument " + quote(argument.name) + " is missing");
      values.push_back(value);
    }
    return values;
  }
  if (given != wanted) {
    return wrong_arguments(info_,
                           "expected " + counted(wanted, "argument") + ", got " + std::to_string(given));
  }
  for (std::size_t i = 0; i < given; ++i)
    values.push_back(&arguments.as_list()[i]);
  return values;
}

DynamicOperation::DynamicOperation(Component& component, OperationInfo info, Function function)
    : OperationBase(component, std::move(info)), function_(std::move(function)) {}

Result<std::unique_ptr<OperationCall>> DynamicOperation::prepare(const type::Value& arguments) const {
  class Call final : public OperationCall {
   public:
    Call(Function function, std::vector<type::Value> values)
        : function_(std::move(function)), values_(std::move(values)) {}
    void run() override { result_ = function_(values_); }
    Result<type::Value> result() override { return std::move(result_); }

   private:
    Function function_;
    std::vector<type::Value> values_;
    Result<type::Value> result_;
  };
  auto values = ordered(arguments);
  if (!values) return std::move(values.error());
  std::vector<type::Value> copies;
  for (const type::Value* value : *values)
    copies.push_back(*value);
  return std::unique_ptr<OperationCall>(std::make_unique<Call>(function_, std::move(copies)));
}

}  // namespace segue::task
