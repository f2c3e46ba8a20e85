// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/type_info.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace segue::task {

class Component;

/// The thread that runs an operation. CallerThread: at once and concurrently with the update, so the
/// component must guard shared data. TaskThread: on the task's executor, never concurrently with an update or
/// a hook.
enum class RunsIn : std::uint8_t { TaskThread, CallerThread };

/// An argument of an operation.
struct OperationArgument {
  std::string name;
  const type::TypeInfo* type = nullptr;  ///< nullptr: any
  std::string type_name;
};

/// The signature of an operation.
struct OperationInfo {
  std::string name;
  std::vector<OperationArgument> arguments;
  std::string result;  ///< type name; empty: nothing
  RunsIn runs_in = RunsIn::TaskThread;
  std::string doc;
};

/// A call with converted and checked arguments. Independent of who waits for it.
class OperationCall {
 public:
  virtual ~OperationCall() = default;
  virtual void run() = 0;  ///< may throw whatever the component's function throws
  /// Requires that run() has returned.
  virtual Result<type::Value> result() = 0;
};

/// A function that a component offers to callers by name.
class OperationBase {
 public:
  OperationBase(const OperationBase&) = delete;
  OperationBase& operator=(const OperationBase&) = delete;
  virtual ~OperationBase();

  [[nodiscard]] const OperationInfo& info() const { return info_; }
  [[nodiscard]] const std::string& name() const { return info_.name; }
  /// Checks and converts arguments: a map by name, a list in order, null for none. All are required.
  [[nodiscard]] virtual Result<std::unique_ptr<OperationCall>> prepare(
      const type::Value& arguments) const = 0;

 protected:
  OperationBase(Component& component, OperationInfo info);
  /// The arguments in order, whether they were given by name or in order.
  [[nodiscard]] Result<std::vector<const type::Value*>> ordered(const type::Value& arguments) const;

 private:
  Component& component_;
  OperationInfo info_;
};

/// An operation on dynamic values, for components defined at run time.
class DynamicOperation final : public OperationBase {
 public:
  using Function = std::function<Result<type::Value>(const std::vector<type::Value>& arguments)>;
  DynamicOperation(Component& component, OperationInfo info, Function function);
  [[nodiscard]] Result<std::unique_ptr<OperationCall>> prepare(const type::Value& arguments) const override;

 private:
  Function function_;
};

template <std::size_t kGiven, std::size_t kArguments>
concept OneNamePerArgument = kGiven == kArguments;

/// The names of an operation's arguments, `{"x", "y"}`: another number of them does not compile.
template <std::size_t N>
class ArgumentNames {
 public:
  template <std::convertible_to<std::string_view>... Names>
  requires OneNamePerArgument<sizeof...(Names), N>
  constexpr ArgumentNames(const Names&... names) : names_{names...} {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] std::string_view operator[](std::size_t argument) const { return names_[argument]; }

 private:
  std::array<std::string_view, N> names_;
};

template <class Signature>
class Operation;

/// `Operation<double(double)> twice_{*this, "twice", {"x"}, [](double x) { return 2 * x; }};` The braces name
/// each argument. The function may also return a Result.
template <class R, class... A>
class Operation<R(A...)> final : public OperationBase {
 public:
  using Function = std::function<R(A...)>;
  using Names = ArgumentNames<sizeof...(A)>;
  Operation(Component& component, std::string name, const Names& argument_names, Function function,
            RunsIn runs_in = RunsIn::TaskThread, std::string doc = {})
      : OperationBase(component, describe(std::move(name), argument_names, runs_in, std::move(doc))),
        function_(std::move(function)) {}

  [[nodiscard]] Result<std::unique_ptr<OperationCall>> prepare(const type::Value& arguments) const override {
    auto values = ordered(arguments);
    if (!values) return std::move(values.error());
    auto call = std::make_unique<Call>(function_);
    auto read = call->read(*values, info(), std::index_sequence_for<A...>{});
    if (!read) return std::move(read.error());
    return std::unique_ptr<OperationCall>(std::move(call));
  }

 private:
  template <class T>
  struct Unwrapped {
    using type = T;
  };
  template <class T>
  struct Unwrapped<Result<T>> {
    using type = T;
  };
  using Plain = typename Unwrapped<R>::type;
  static constexpr bool kReturnsResult = !std::is_same_v<Plain, R>;

  static OperationInfo describe(std::string name, const Names& argument_names, RunsIn runs_in,
                                std::string doc) {
    OperationInfo info{std::move(name), {}, {}, runs_in, std::move(doc)};
    const std::vector<const type::TypeInfo*> types = {&type::type_info<std::decay_t<A>>()...};
    for (std::size_t i = 0; i < types.size(); ++i)
      info.arguments.push_back({std::string(argument_names[i]), types[i], std::string(types[i]->name())});
    if constexpr (!std::is_void_v<Plain>) info.result = type::type_info<std::decay_t<Plain>>().name();
    return info;
  }

  class Call final : public OperationCall {
   public:
    explicit Call(Function function) : function_(std::move(function)) {}

    template <std::size_t... I>
    Result<void> read(const std::vector<const type::Value*>& values, const OperationInfo& info,
                      std::index_sequence<I...> /*all*/) {
      Result<void> read_so_far;
      [[maybe_unused]] const auto read_one = [&](void* argument, std::size_t index) {
        const OperationArgument& wanted = info.arguments[index];
        read_so_far = wanted.type->from_value(argument, *values[index], info.name + "." + wanted.name);
        return read_so_far.has_value();
      };
      static_cast<void>((read_one(&std::get<I>(arguments_), I) && ...));
      return read_so_far;
    }
    void run() override {
      if constexpr (std::is_void_v<R>) {
        std::apply(function_, arguments_);
      } else {
        returned_.emplace(std::apply(function_, arguments_));
      }
    }
    Result<type::Value> result() override {
      if constexpr (kReturnsResult) {
        if (!*returned_) return returned_->error();
      }
      if constexpr (std::is_void_v<Plain>) {
        return type::Value{};
      } else if constexpr (kReturnsResult) {
        return type::type_info<std::decay_t<Plain>>().to_value(&**returned_);
      } else {
        return type::type_info<std::decay_t<Plain>>().to_value(&*returned_);
      }
    }

   private:
    Function function_;
    std::tuple<std::decay_t<A>...> arguments_;
    std::conditional_t<std::is_void_v<R>, std::monostate, std::optional<R>> returned_;
  };

  Function function_;
};

}  // namespace segue::task
